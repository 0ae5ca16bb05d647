"""Geometry nodes wave displacement driven by scene time, plus storing a named attribute for the shader."""
import bpy

grp = bpy.data.node_groups.new("WaveField", 'GeometryNodeTree')
grp.inputs.new('NodeSocketGeometry', "Geometry") if hasattr(grp, "inputs") else \
    grp.interface.new_socket("Geometry", in_out='INPUT', socket_type='NodeSocketGeometry')
grp.outputs.new('NodeSocketGeometry', "Geometry") if hasattr(grp, "outputs") else \
    grp.interface.new_socket("Geometry", in_out='OUTPUT', socket_type='NodeSocketGeometry')

N = grp.nodes.new
gin, gout = N('NodeGroupInput'), N('NodeGroupOutput')
pos = N('GeometryNodeInputPosition')
time = N('GeometryNodeInputSceneTime')
length = N('ShaderNodeVectorMath')
length.operation = 'LENGTH'
freq = N('ShaderNodeMath')
freq.operation = 'MULTIPLY'
freq.inputs[1].default_value = 3.0
sub = N('ShaderNodeMath')
sub.operation = 'SUBTRACT'
sine = N('ShaderNodeMath')
sine.operation = 'SINE'
amp = N('ShaderNodeMath')
amp.operation = 'MULTIPLY'
amp.inputs[1].default_value = 0.25
comb = N('ShaderNodeCombineXYZ')
setpos = N('GeometryNodeSetPosition')
store = N('GeometryNodeStoreNamedAttribute')
store.data_type = 'FLOAT'
store.domain = 'POINT'
store.inputs['Name'].default_value = "wave_height"

L = grp.links.new
L(pos.outputs[0], length.inputs[0])
L(length.outputs['Value'], freq.inputs[0])
L(freq.outputs[0], sub.inputs[0])
L(time.outputs['Seconds'], sub.inputs[1])
L(sub.outputs[0], sine.inputs[0])
L(sine.outputs[0], amp.inputs[0])
L(amp.outputs[0], comb.inputs['Z'])
L(gin.outputs[0], setpos.inputs['Geometry'])
L(comb.outputs[0], setpos.inputs['Offset'])
L(setpos.outputs[0], store.inputs['Geometry'])
L(sine.outputs[0], store.inputs['Value'])
L(store.outputs[0], gout.inputs[0])

bpy.ops.mesh.primitive_grid_add(x_subdivisions=100, y_subdivisions=100, size=10)
ob = bpy.context.object
mod = ob.modifiers.new("Wave", 'NODES')
mod.node_group = grp

mat = bpy.data.materials.new("WaveColor")
mat.use_nodes = True
nt = mat.node_tree
attr = nt.nodes.new('ShaderNodeAttribute')
attr.attribute_type = 'GEOMETRY'
attr.attribute_name = "wave_height"
ramp = nt.nodes.new('ShaderNodeValToRGB')
ramp.color_ramp.elements.new(0.5).color = (0.1, 0.6, 0.7, 1)
nt.links.new(attr.outputs['Fac'], ramp.inputs['Fac'])
nt.links.new(ramp.outputs['Color'], nt.nodes['Principled BSDF'].inputs['Base Color'])
ob.data.materials.append(mat)

bpy.context.scene.frame_set(24)
ev = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
a = ev.data.attributes["wave_height"]
print(a.domain, a.data_type, max(d.value for d in a.data))
