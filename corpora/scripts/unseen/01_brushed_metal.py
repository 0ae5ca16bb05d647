"""Create a brushed metal material with anisotropy and noise streaks and put it on a cylinder."""
import bpy


def make_brushed_metal(name="BrushedMetal", base=(0.6, 0.58, 0.55, 1.0)):
    mat = bpy.data.materials.new(name)
    mat.use_nodes = True
    nt = mat.node_tree
    nodes = nt.nodes
    links = nt.links
    nodes.clear()

    out = nodes.new("ShaderNodeOutputMaterial")
    out.location = (600, 0)
    bsdf = nodes.new("ShaderNodeBsdfPrincipled")
    bsdf.location = (300, 0)
    bsdf.inputs["Base Color"].default_value = base
    bsdf.inputs["Metallic"].default_value = 1.0
    bsdf.inputs["Roughness"].default_value = 0.35
    bsdf.inputs["Anisotropic"].default_value = 0.8
    bsdf.inputs["Specular"].default_value = 0.5

    coord = nodes.new("ShaderNodeTexCoord")
    coord.location = (-900, 0)
    mapping = nodes.new("ShaderNodeMapping")
    mapping.location = (-700, 0)
    mapping.inputs["Scale"].default_value = (1.0, 1.0, 200.0)

    noise = nodes.new("ShaderNodeTexNoise")
    noise.location = (-500, 0)
    noise.inputs["Scale"].default_value = 4.0
    noise.inputs["Detail"].default_value = 8.0

    ramp = nodes.new("ShaderNodeValToRGB")
    ramp.location = (-300, 0)
    ramp.color_ramp.elements[0].position = 0.35
    ramp.color_ramp.elements[0].color = (0.2, 0.2, 0.2, 1)
    ramp.color_ramp.elements[1].position = 0.7
    ramp.color_ramp.elements[1].color = (0.5, 0.5, 0.5, 1)

    bump = nodes.new("ShaderNodeBump")
    bump.location = (50, -250)
    bump.inputs["Strength"].default_value = 0.1

    links.new(coord.outputs["Object"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], noise.inputs["Vector"])
    links.new(noise.outputs["Fac"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], bsdf.inputs["Roughness"])
    links.new(noise.outputs["Fac"], bump.inputs["Height"])
    links.new(bump.outputs["Normal"], bsdf.inputs["Normal"])
    links.new(bsdf.outputs["BSDF"], out.inputs["Surface"])
    return mat


bpy.ops.mesh.primitive_cylinder_add(vertices=64, radius=1, depth=2, location=(0, 0, 1))
cyl = bpy.context.active_object
cyl.name = "MetalCylinder"
bpy.ops.object.shade_smooth()
cyl.data.use_auto_smooth = True
cyl.data.auto_smooth_angle = 0.785
cyl.data.materials.append(make_brushed_metal())
print("Material applied to", cyl.name)
