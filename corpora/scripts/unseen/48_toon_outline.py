"""Toon shader with Shader to RGB, plus an inverted hull outline with the solidify modifier."""
import bpy


def toon_material(name, color):
    mat = bpy.data.materials.new(name)
    mat.use_nodes = True
    nt = mat.node_tree
    nt.nodes.clear()
    out = nt.nodes.new("ShaderNodeOutputMaterial")
    diff = nt.nodes.new("ShaderNodeBsdfDiffuse")
    s2r = nt.nodes.new("ShaderNodeShaderToRGB")
    ramp = nt.nodes.new("ShaderNodeValToRGB")
    mix = nt.nodes.new("ShaderNodeMix")
    emit = nt.nodes.new("ShaderNodeEmission")

    ramp.color_ramp.interpolation = 'CONSTANT'
    els = ramp.color_ramp.elements
    els[0].color = (0.2, 0.2, 0.25, 1)
    els[1].position = 0.5
    els[1].color = (1, 1, 1, 1)
    mid = els.new(0.2)
    mid.color = (0.6, 0.6, 0.65, 1)

    mix.data_type = 'RGBA'
    mix.blend_type = 'MULTIPLY'
    mix.inputs["Factor"].default_value = 1.0
    mix.inputs[6].default_value = color

    nt.links.new(diff.outputs[0], s2r.inputs[0])
    nt.links.new(s2r.outputs["Color"], ramp.inputs["Fac"])
    nt.links.new(ramp.outputs["Color"], mix.inputs[7])
    nt.links.new(mix.outputs[2], emit.inputs["Color"])
    nt.links.new(emit.outputs[0], out.inputs["Surface"])
    for i, n in enumerate((diff, s2r, ramp, mix, emit, out)):
        n.location = (i * 250 - 600, 0)
    return mat


outline = bpy.data.materials.new("Outline")
outline.use_nodes = True
outline.use_backface_culling = True
outline.shadow_method = 'NONE'
nt = outline.node_tree
nt.nodes.clear()
o = nt.nodes.new("ShaderNodeOutputMaterial")
e = nt.nodes.new("ShaderNodeEmission")
e.inputs["Color"].default_value = (0, 0, 0, 1)
nt.links.new(e.outputs["Emission"], o.inputs["Surface"])

bpy.ops.mesh.primitive_monkey_add(size=2)
ob = bpy.context.object
bpy.ops.object.shade_smooth()
ob.data.materials.append(toon_material("ToonBlue", (0.15, 0.4, 0.9, 1)))
ob.data.materials.append(outline)

sol = ob.modifiers.new("Outline", 'SOLIDIFY')
sol.thickness = -0.03
sol.offset = 1
sol.use_flip_normals = True
sol.use_rim = False
sol.material_offset = 1

scene = bpy.context.scene
scene.render.engine = 'BLENDER_EEVEE'
scene.eevee.use_soft_shadows = False
scene.eevee.shadow_cube_size = '1024'
scene.view_settings.view_transform = 'Standard'
print([m.name for m in ob.data.materials])
