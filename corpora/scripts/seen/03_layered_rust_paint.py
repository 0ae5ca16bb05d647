"""Procedural worn paint material: blue paint on top of rust, mixed with edge wear."""
import bpy


def new_node(tree, type_, loc, **props):
    n = tree.nodes.new(type_)
    n.location = loc
    for k, v in props.items():
        setattr(n, k, v)
    return n


mat = bpy.data.materials.new("WornPaint")
mat.use_nodes = True
nt = mat.node_tree
nt.nodes.clear()

out = new_node(nt, "ShaderNodeOutputMaterial", (900, 0))
mix_shader = new_node(nt, "ShaderNodeMixShader", (700, 0))

paint = new_node(nt, "ShaderNodeBsdfPrincipled", (350, 200), label="Paint")
paint.inputs["Base Color"].default_value = (0.02, 0.12, 0.5, 1)
paint.inputs["Roughness"].default_value = 0.3
paint.inputs["Coat Weight"].default_value = 0.6

rust = new_node(nt, "ShaderNodeBsdfPrincipled", (350, -300), label="Rust")
rust.inputs["Roughness"].default_value = 0.9

geo = new_node(nt, "ShaderNodeNewGeometry", (-700, 200))
edge_ramp = new_node(nt, "ShaderNodeValToRGB", (-450, 200))
edge_ramp.color_ramp.elements[0].position = 0.48
edge_ramp.color_ramp.elements[1].position = 0.55

musgrave = new_node(nt, "ShaderNodeTexMusgrave", (-700, -100))
musgrave.musgrave_dimensions = '3D'
musgrave.inputs["Scale"].default_value = 4.0
musgrave.inputs["Detail"].default_value = 8.0

add = new_node(nt, "ShaderNodeMath", (-100, 100), operation='ADD', use_clamp=True)

noise = new_node(nt, "ShaderNodeTexNoise", (-450, -400))
noise.inputs["Scale"].default_value = 25.0
mix = new_node(nt, "ShaderNodeMix", (0, -350), data_type='RGBA', blend_type='MIX')
mix.inputs[6].default_value = (0.2, 0.05, 0.01, 1)
mix.inputs[7].default_value = (0.5, 0.18, 0.05, 1)

L = nt.links.new
L(geo.outputs["Pointiness"], edge_ramp.inputs["Fac"])
L(edge_ramp.outputs["Color"], add.inputs[0])
L(musgrave.outputs["Fac"], add.inputs[1])
L(noise.outputs["Fac"], mix.inputs["Factor"])
L(mix.outputs[2], rust.inputs["Base Color"])
L(add.outputs["Value"], mix_shader.inputs["Fac"])
L(paint.outputs["BSDF"], mix_shader.inputs[1])
L(rust.outputs["BSDF"], mix_shader.inputs[2])
L(mix_shader.outputs["Shader"], out.inputs["Surface"])

bpy.ops.mesh.primitive_monkey_add(size=2)
ob = bpy.context.active_object
sub = ob.modifiers.new("Subsurf", 'SUBSURF')
sub.levels = 2
sub.render_levels = 3
ob.data.materials.clear()
ob.data.materials.append(mat)
bpy.context.scene.render.engine = 'CYCLES'
