"""Dam break liquid simulation with FLIP, foam particles and an obstacle."""
import bpy
import os
import tempfile

scene = bpy.context.scene
scene.frame_end = 100

for n in ("Cube",):
    if n in bpy.data.objects:
        bpy.data.objects.remove(bpy.data.objects[n])

bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 1))
domain = bpy.context.object
domain.name = "LiquidDomain"
domain.scale = (4, 2, 2)
bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
bpy.ops.object.modifier_add(type='FLUID')
domain.modifiers["Fluid"].fluid_type = 'DOMAIN'
d = domain.modifiers["Fluid"].domain_settings
d.domain_type = 'LIQUID'
d.resolution_max = 48
d.time_scale = 1.0
d.use_mesh = True
d.mesh_scale = 2
d.mesh_particle_radius = 2.0
d.use_foam_particles = True
d.use_spray_particles = True
d.use_bubble_particles = False
d.particle_number = 2
d.particle_radius = 1.5
d.use_fractions = True
d.use_viscosity = False
d.use_collision_border_top = False
d.cache_type = 'MODULAR'
d.cache_frame_end = 100
d.cache_directory = os.path.join(tempfile.gettempdir(), "liquid_cache")

bpy.ops.mesh.primitive_cube_add(size=1, location=(-1.4, 0, 0.7))
water = bpy.context.object
water.name = "WaterBlock"
water.scale = (1, 1.8, 1.2)
m = water.modifiers.new("Fluid", 'FLUID')
m.fluid_type = 'FLOW'
m.flow_settings.flow_type = 'LIQUID'
m.flow_settings.flow_behavior = 'GEOMETRY'
water.hide_render = True

bpy.ops.mesh.primitive_cylinder_add(radius=0.25, depth=2, location=(0.8, 0, 1))
pillar = bpy.context.object
pillar.name = "Pillar"
m = pillar.modifiers.new("Fluid", 'FLUID')
m.fluid_type = 'EFFECTOR'
m.effector_settings.effector_type = 'COLLISION'
m.effector_settings.surface_distance = 0.5

mat = bpy.data.materials.new("Water")
mat.use_nodes = True
n = mat.node_tree.nodes
n.clear()
out = n.new("ShaderNodeOutputMaterial")
glass = n.new("ShaderNodeBsdfGlass")
glass.inputs["IOR"].default_value = 1.333
glass.inputs["Color"].default_value = (0.8, 0.95, 1.0, 1)
mat.node_tree.links.new(glass.outputs["BSDF"], out.inputs["Surface"])
domain.data.materials.append(mat)
print("domain", d.domain_type, d.resolution_max)
