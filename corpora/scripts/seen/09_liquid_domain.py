"""Set up a small liquid simulation: domain, inflow and an obstacle with mantaflow."""
import bpy
import os
import tempfile


bpy.ops.object.select_all(action='SELECT')
bpy.ops.object.delete()

# domain
bpy.ops.mesh.primitive_cube_add(size=4, location=(0, 0, 2))
domain = bpy.context.object
domain.name = "LiquidDomain"
domain.display_type = 'WIRE'
mod = domain.modifiers.new("Fluid", 'FLUID')
mod.fluid_type = 'DOMAIN'
ds = mod.domain_settings
ds.domain_type = 'LIQUID'
ds.resolution_max = 48
ds.use_mesh = True
ds.mesh_particle_radius = 1.5
ds.use_adaptive_timesteps = True
ds.timesteps_max = 4
ds.cache_type = 'ALL'
ds.cache_frame_start = 1
ds.cache_frame_end = 40
ds.cache_directory = os.path.join(tempfile.gettempdir(), "liquid_cache")
ds.viscosity_base = 1.0
ds.viscosity_exponent = 6
ds.use_spray_particles = True
ds.use_foam_particles = True

# inflow
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, location=(-1.2, 0, 3.3))
flow = bpy.context.object
flow.name = "Inflow"
m = flow.modifiers.new("Fluid", 'FLUID')
m.fluid_type = 'FLOW'
m.flow_settings.flow_type = 'LIQUID'
m.flow_settings.flow_behavior = 'INFLOW'
m.flow_settings.use_initial_velocity = True
m.flow_settings.velocity_coord = (1.5, 0.0, 0.0)

# obstacle
bpy.ops.mesh.primitive_cube_add(size=1, location=(0.5, 0, 0.6))
obst = bpy.context.object
obst.name = "Obstacle"
m = obst.modifiers.new("Fluid", 'FLUID')
m.fluid_type = 'EFFECTOR'
m.effector_settings.effector_type = 'COLLISION'
m.effector_settings.surface_distance = 0.01

mat = bpy.data.materials.new("Water")
mat.use_nodes = True
bsdf = mat.node_tree.nodes["Principled BSDF"]
bsdf.inputs["Transmission"].default_value = 1.0
bsdf.inputs["Roughness"].default_value = 0.0
bsdf.inputs["IOR"].default_value = 1.333
domain.data.materials.append(mat)

bpy.context.view_layer.objects.active = domain
domain.select_set(True)
bpy.context.scene.frame_end = 40
bpy.ops.fluid.bake_all()
