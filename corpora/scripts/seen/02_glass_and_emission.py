"""Create a frosted glass material and a glowing emission material and assign them to two spheres."""
import bpy


def glass_material():
    mat = bpy.data.materials.new("FrostedGlass")
    mat.use_nodes = True
    bsdf = mat.node_tree.nodes.get("Principled BSDF")
    bsdf.inputs["Base Color"].default_value = (0.85, 0.95, 1.0, 1.0)
    bsdf.inputs["Roughness"].default_value = 0.25
    bsdf.inputs["IOR"].default_value = 1.45
    bsdf.inputs["Transmission Weight"].default_value = 1.0
    mat.blend_method = 'BLEND'
    mat.shadow_method = 'HASHED'
    mat.use_screen_refraction = True
    mat.refraction_depth = 0.05
    return mat


def emission_material(color=(1.0, 0.4, 0.1, 1.0), strength=12.0):
    mat = bpy.data.materials.new("Glow")
    mat.use_nodes = True
    tree = mat.node_tree
    tree.nodes.clear()
    out = tree.nodes.new("ShaderNodeOutputMaterial")
    emit = tree.nodes.new("ShaderNodeEmission")
    emit.inputs["Color"].default_value = color
    emit.inputs["Strength"].default_value = strength
    emit.location = (-250, 0)
    tree.links.new(emit.outputs["Emission"], out.inputs["Surface"])
    return mat


def main():
    scene = bpy.context.scene
    for i, mat in enumerate((glass_material(), emission_material())):
        bpy.ops.mesh.primitive_uv_sphere_add(radius=1, location=(i * 3 - 1.5, 0, 1))
        ob = bpy.context.object
        ob.name = mat.name + "Sphere"
        bpy.ops.object.shade_smooth()
        ob.data.materials.append(mat)

    scene.render.engine = 'BLENDER_EEVEE_NEXT'
    scene.eevee.use_raytracing = True
    scene.eevee.use_bloom = True
    scene.eevee.bloom_intensity = 0.05


main()
