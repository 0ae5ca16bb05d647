"""Set up a smoke and fire simulation: an emitter sphere, a domain and a volume material."""
import bpy

bpy.ops.mesh.primitive_uv_sphere_add(radius=0.4, location=(0, 0, 0.5))
emitter = bpy.context.object
emitter.name = "FireEmitter"
flow_mod = emitter.modifiers.new("Fluid", 'FLUID')
flow_mod.fluid_type = 'FLOW'
flow = flow_mod.flow_settings
flow.flow_type = 'BOTH'
flow.flow_behavior = 'INFLOW'
flow.fuel_amount = 1.2
flow.temperature = 1.5
flow.density = 1.0
flow.subframes = 1
flow.use_initial_velocity = True
flow.velocity_coord = (0, 0, 0.5)

bpy.ops.mesh.primitive_cube_add(size=2, location=(0, 0, 2.8))
domain = bpy.context.object
domain.name = "SmokeDomain"
domain.scale = (1.5, 1.5, 3)
dom_mod = domain.modifiers.new("Fluid", 'FLUID')
dom_mod.fluid_type = 'DOMAIN'
ds = dom_mod.domain_settings
ds.domain_type = 'GAS'
ds.resolution_max = 64
ds.use_adaptive_domain = True
ds.use_noise = True
ds.noise_scale = 2
ds.vorticity = 0.15
ds.burning_rate = 0.7
ds.flame_smoke = 1.0
ds.cache_type = 'ALL'
ds.cache_frame_start = 1
ds.cache_frame_end = 60
ds.cache_directory = "//cache_fire"
ds.cache_data_format = 'OPENVDB'

mat = bpy.data.materials.new("FireSmoke")
mat.use_nodes = True
nodes = mat.node_tree.nodes
nodes.remove(nodes["Principled BSDF"])
vol = nodes.new("ShaderNodeVolumePrincipled")
vol.inputs["Density"].default_value = 5
vol.inputs["Color"].default_value = (0.1, 0.1, 0.1, 1)
vol.inputs["Blackbody Intensity"].default_value = 1.0
vol.inputs["Temperature Attribute"].default_value = "temperature"
attr = nodes.new("ShaderNodeAttribute")
attr.attribute_name = "flame"
math = nodes.new("ShaderNodeMath")
math.operation = 'MULTIPLY'
math.inputs[1].default_value = 8.0
mat.node_tree.links.new(attr.outputs["Fac"], math.inputs[0])
mat.node_tree.links.new(math.outputs[0], vol.inputs["Emission Strength"])
mat.node_tree.links.new(vol.outputs["Volume"], nodes["Material Output"].inputs["Volume"])
domain.data.materials.append(mat)

domain.display_type = 'WIRE'
bpy.context.scene.frame_end = 60
print("Smoke setup ready, bake with bpy.ops.fluid.bake_all()")
