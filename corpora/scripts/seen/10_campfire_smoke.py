"""Campfire with smoke and fire simulation plus a principled volume material."""
import bpy


def setup_domain():
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 2))
    dom = bpy.context.object
    dom.name = "SmokeDomain"
    dom.scale = (2, 2, 4)
    bpy.ops.object.transform_apply(scale=True)
    bpy.ops.object.modifier_add(type='FLUID')
    mod = dom.modifiers["Fluid"]
    mod.fluid_type = 'DOMAIN'
    s = mod.domain_settings
    s.domain_type = 'GAS'
    s.resolution_max = 64
    s.use_noise = True
    s.noise_scale = 2
    s.use_adaptive_domain = True
    s.alpha = 0.5
    s.beta = 2.0
    s.vorticity = 0.2
    s.use_dissolve_smoke = True
    s.dissolve_speed = 40
    s.burning_rate = 0.75
    s.flame_smoke = 0.8
    s.cache_data_format = 'OPENVDB'
    s.cache_type = 'REPLAY'
    return dom


def setup_flow():
    bpy.ops.mesh.primitive_ico_sphere_add(radius=0.35, location=(0, 0, 0.5))
    ob = bpy.context.object
    ob.name = "FireSource"
    bpy.ops.object.modifier_add(type='FLUID')
    mod = ob.modifiers["Fluid"]
    mod.fluid_type = 'FLOW'
    f = mod.flow_settings
    f.flow_type = 'BOTH'
    f.flow_behavior = 'INFLOW'
    f.fuel_amount = 1.2
    f.density = 1.0
    f.temperature = 1.5
    f.surface_distance = 1.0
    f.smoke_color = (0.2, 0.2, 0.2)
    ob.hide_render = True
    return ob


def fire_material(domain):
    mat = bpy.data.materials.new("Fire")
    mat.use_nodes = True
    nt = mat.node_tree
    nt.nodes.remove(nt.nodes["Principled BSDF"])
    vol = nt.nodes.new("ShaderNodeVolumePrincipled")
    vol.inputs["Density"].default_value = 6.0
    vol.inputs["Blackbody Intensity"].default_value = 1.0
    vol.inputs["Temperature Attribute"].default_value = "temperature"
    attr = nt.nodes.new("ShaderNodeAttribute")
    attr.attribute_name = "flame"
    mult = nt.nodes.new("ShaderNodeMath")
    mult.operation = 'MULTIPLY'
    mult.inputs[1].default_value = 10
    nt.links.new(attr.outputs["Fac"], mult.inputs[0])
    nt.links.new(mult.outputs[0], vol.inputs["Emission Strength"])
    nt.links.new(vol.outputs["Volume"], nt.nodes["Material Output"].inputs["Volume"])
    domain.data.materials.append(mat)


domain = setup_domain()
setup_flow()
fire_material(domain)
bpy.context.scene.eevee.volumetric_tile_size = '4'
bpy.context.scene.eevee.volumetric_end = 30
print("Smoke domain ready:", domain.modifiers["Fluid"].domain_settings.resolution_max)
