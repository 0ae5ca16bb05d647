"""World with a Nishita sky texture, sun elevation animated from sunrise to noon."""
import bpy
import math

scene = bpy.context.scene
world = bpy.data.worlds.new("SkyWorld")
scene.world = world
world.use_nodes = True
nt = world.node_tree
nt.nodes.clear()

out = nt.nodes.new("ShaderNodeOutputWorld")
bg = nt.nodes.new("ShaderNodeBackground")
sky = nt.nodes.new("ShaderNodeTexSky")
out.location = (300, 0)
bg.location = (100, 0)
sky.location = (-200, 0)

sky.sky_type = 'NISHITA'
sky.sun_disc = True
sky.sun_size = math.radians(0.545)
sky.sun_intensity = 0.4
sky.sun_rotation = math.radians(45)
sky.altitude = 100
sky.air_density = 1.0
sky.dust_density = 2.0
sky.ozone_density = 1.0
bg.inputs["Strength"].default_value = 0.3

nt.links.new(sky.outputs["Color"], bg.inputs["Color"])
nt.links.new(bg.outputs["Background"], out.inputs["Surface"])

sky.sun_elevation = math.radians(1)
sky.keyframe_insert("sun_elevation", frame=1)
sky.sun_elevation = math.radians(60)
sky.keyframe_insert("sun_elevation", frame=250)

for fc in nt.animation_data.action.fcurves:
    for kp in fc.keyframe_points:
        kp.interpolation = 'SINE'
        kp.easing = 'EASE_IN_OUT'

scene.render.engine = 'CYCLES'
scene.cycles.use_denoising = True
scene.cycles.samples = 64
world.light_settings.use_ambient_occlusion = True
world.mist_settings.start = 10
world.mist_settings.depth = 100
scene.view_settings.exposure = -1.0

for f in (1, 125, 250):
    scene.frame_set(f)
    print(f, round(math.degrees(sky.sun_elevation), 1))
