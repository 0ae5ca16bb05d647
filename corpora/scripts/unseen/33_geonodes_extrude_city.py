"""Geometry nodes: turn a grid into a city by extruding every face with a random height."""
import bpy

ng = bpy.data.node_groups.new("City", 'GeometryNodeTree')
ng.is_modifier = True
ng.interface.new_socket(name="Geometry", in_out='OUTPUT', socket_type='NodeSocketGeometry')
s_size = ng.interface.new_socket(name="Size", in_out='INPUT', socket_type='NodeSocketFloat')
s_size.subtype = 'DISTANCE'
s_size.default_value = 20
s_max = ng.interface.new_socket(name="Max Height", in_out='INPUT', socket_type='NodeSocketFloat')
s_max.default_value = 5
s_mat = ng.interface.new_socket(name="Material", in_out='INPUT', socket_type='NodeSocketMaterial')

N = ng.nodes.new
gi = N("NodeGroupInput")
go = N("NodeGroupOutput")
grid = N("GeometryNodeMeshGrid")
grid.inputs["Vertices X"].default_value = 20
grid.inputs["Vertices Y"].default_value = 20

ext1 = N("GeometryNodeExtrudeMesh")
ext1.mode = 'FACES'
ext1.inputs["Individual"].default_value = True
ext1.inputs["Offset Scale"].default_value = 0.0
scale = N("GeometryNodeScaleElements")
scale.domain = 'FACE'
scale.inputs["Scale"].default_value = 0.7

ext2 = N("GeometryNodeExtrudeMesh")
ext2.mode = 'FACES'
rand = N("FunctionNodeRandomValue")
rand.data_type = 'FLOAT'
rand.inputs["Min"].default_value = 0.3

setmat = N("GeometryNodeSetMaterial")
store = N("GeometryNodeStoreNamedAttribute")
store.data_type = 'FLOAT'
store.domain = 'FACE'
store.inputs["Name"].default_value = "height"

L = ng.links.new
L(gi.outputs["Size"], grid.inputs["Size X"])
L(gi.outputs["Size"], grid.inputs["Size Y"])
L(grid.outputs["Mesh"], ext1.inputs["Mesh"])
L(ext1.outputs["Mesh"], scale.inputs["Geometry"])
L(ext1.outputs["Top"], scale.inputs["Selection"])
L(scale.outputs["Geometry"], ext2.inputs["Mesh"])
L(ext1.outputs["Top"], ext2.inputs["Selection"])
L(gi.outputs["Max Height"], rand.inputs["Max"])
L(rand.outputs["Value"], ext2.inputs["Offset Scale"])
L(ext2.outputs["Mesh"], store.inputs["Geometry"])
L(rand.outputs["Value"], store.inputs["Value"])
L(store.outputs["Geometry"], setmat.inputs["Geometry"])
L(gi.outputs["Material"], setmat.inputs["Material"])
L(setmat.outputs["Geometry"], go.inputs["Geometry"])

me = bpy.data.meshes.new("City")
ob = bpy.data.objects.new("City", me)
bpy.context.collection.objects.link(ob)
mod = ob.modifiers.new("City", 'NODES')
mod.node_group = ng
mat = bpy.data.materials.new("Concrete")
mod[s_mat.identifier] = mat
mod[s_max.identifier] = 8.0

dg = bpy.context.evaluated_depsgraph_get()
ev = ob.evaluated_get(dg)
print("verts", len(ev.data.vertices), "height", max(v.co.z for v in ev.data.vertices))
