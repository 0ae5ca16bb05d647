"""Geometry nodes: spiral curve turned into a tube, with exposed turns, radius and height inputs."""
import bpy


def build_group():
    group = bpy.data.node_groups.new(name="SpiralTube", type="GeometryNodeTree")
    group.is_modifier = True

    def sock(name, kind, default=None):
        s = group.interface.new_socket(name, in_out='INPUT', socket_type=kind)
        if default is not None:
            s.default_value = default
        return s

    sock("Turns", 'NodeSocketFloat', 4.0)
    sock("Height", 'NodeSocketFloat', 3.0)
    sock("Tube Radius", 'NodeSocketFloat', 0.1)
    sock("Material", 'NodeSocketMaterial')
    group.interface.new_socket("Geometry", in_out='OUTPUT', socket_type='NodeSocketGeometry')

    nodes, links = group.nodes, group.links
    gi = nodes.new("NodeGroupInput")
    gi.location = (-600, 0)
    go = nodes.new("NodeGroupOutput")
    go.location = (800, 0)

    spiral = nodes.new("GeometryNodeCurveSpiral")
    spiral.location = (-350, 100)
    spiral.inputs["Resolution"].default_value = 48
    spiral.inputs["Start Radius"].default_value = 1.0
    spiral.inputs["End Radius"].default_value = 0.4

    circle = nodes.new("GeometryNodeCurvePrimitiveCircle")
    circle.location = (-350, -250)
    circle.mode = 'RADIUS'
    circle.inputs["Resolution"].default_value = 12

    c2m = nodes.new("GeometryNodeCurveToMesh")
    c2m.location = (0, 0)
    c2m.inputs["Fill Caps"].default_value = True

    smooth = nodes.new("GeometryNodeSetShadeSmooth")
    smooth.location = (250, 0)
    setmat = nodes.new("GeometryNodeSetMaterial")
    setmat.location = (500, 0)

    links.new(gi.outputs["Turns"], spiral.inputs["Rotations"])
    links.new(gi.outputs["Height"], spiral.inputs["Height"])
    links.new(gi.outputs["Tube Radius"], circle.inputs["Radius"])
    links.new(spiral.outputs["Curve"], c2m.inputs["Curve"])
    links.new(circle.outputs["Curve"], c2m.inputs["Profile Curve"])
    links.new(c2m.outputs["Mesh"], smooth.inputs["Geometry"])
    links.new(smooth.outputs["Geometry"], setmat.inputs["Geometry"])
    links.new(gi.outputs["Material"], setmat.inputs["Material"])
    links.new(setmat.outputs["Geometry"], go.inputs["Geometry"])
    return group


mesh = bpy.data.meshes.new("Spiral")
ob = bpy.data.objects.new("Spiral", mesh)
bpy.context.scene.collection.objects.link(ob)
mod = ob.modifiers.new("GeometryNodes", 'NODES')
mod.node_group = build_group()

mat = bpy.data.materials.new("SpiralMat")
values = {"Turns": 6.0, "Height": 4.0, "Tube Radius": 0.15, "Material": mat}
for item in mod.node_group.interface.items_tree:
    if item.in_out == 'INPUT' and item.name in values:
        mod[item.identifier] = values[item.name]

dg = bpy.context.evaluated_depsgraph_get()
print("verts:", len(ob.evaluated_get(dg).to_mesh().vertices))
