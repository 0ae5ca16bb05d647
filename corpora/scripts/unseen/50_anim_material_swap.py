"""Dissolve effect: animated noise threshold mixing a transparent shader with a glowing edge, keyed from frame 1 to 80."""
import bpy

scene = bpy.context.scene
scene.frame_end = 80

bpy.ops.mesh.primitive_monkey_add(size=2, location=(0, 0, 1))
ob = bpy.context.object
ob.modifiers.new("Subdivision", 'SUBSURF').render_levels = 3

mat = bpy.data.materials.new("Dissolve")
mat.use_nodes = True
mat.blend_method = 'HASHED'
mat.shadow_method = 'HASHED'
nt = mat.node_tree
nodes, links = nt.nodes, nt.links
bsdf = nodes["Principled BSDF"]
out = nodes["Material Output"]

mus = nodes.new("ShaderNodeTexMusgrave")
mus.inputs["Scale"].default_value = 3
mus.inputs["Detail"].default_value = 6

value = nodes.new("ShaderNodeValue")
value.name = "Threshold"
value.label = "Dissolve"

gt = nodes.new("ShaderNodeMath")
gt.operation = 'GREATER_THAN'
add = nodes.new("ShaderNodeMath")
add.operation = 'ADD'
add.inputs[1].default_value = 0.06
edge = nodes.new("ShaderNodeMath")
edge.operation = 'LESS_THAN'

transp = nodes.new("ShaderNodeBsdfTransparent")
emit = nodes.new("ShaderNodeEmission")
emit.inputs["Color"].default_value = (1.0, 0.35, 0.05, 1)
emit.inputs["Strength"].default_value = 20
mix_edge = nodes.new("ShaderNodeMixShader")
mix_alpha = nodes.new("ShaderNodeMixShader")

links.new(mus.outputs["Fac"], gt.inputs[0])
links.new(value.outputs[0], gt.inputs[1])
links.new(value.outputs[0], add.inputs[0])
links.new(mus.outputs["Fac"], edge.inputs[0])
links.new(add.outputs[0], edge.inputs[1])
links.new(edge.outputs[0], mix_edge.inputs["Fac"])
links.new(bsdf.outputs[0], mix_edge.inputs[1])
links.new(emit.outputs[0], mix_edge.inputs[2])
links.new(gt.outputs[0], mix_alpha.inputs[0])
links.new(transp.outputs[0], mix_alpha.inputs[1])
links.new(mix_edge.outputs[0], mix_alpha.inputs[2])
links.new(mix_alpha.outputs[0], out.inputs["Surface"])

value.outputs[0].default_value = -1.0
value.outputs[0].keyframe_insert("default_value", frame=1)
value.outputs[0].default_value = 1.2
value.outputs[0].keyframe_insert("default_value", frame=80)

fc = nt.animation_data.action.fcurves[0]
fc.keyframe_points[0].interpolation = 'LINEAR'
m = fc.modifiers.new('NOISE')
m.strength = 0.05
m.scale = 4

ob.data.materials.append(mat)
scene.frame_set(40)
print(fc.data_path, value.outputs[0].default_value)
