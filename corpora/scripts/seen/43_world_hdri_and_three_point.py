"""World lighting with a sky texture (and optional HDRI image), plus a three point light rig aimed at the origin."""
import bpy
import math
from mathutils import Vector

HDRI_PATH = ""

scene = bpy.context.scene
world = bpy.data.worlds.new("Studio")
scene.world = world
world.use_nodes = True
nt = world.node_tree
nt.nodes.clear()

out = nt.nodes.new('ShaderNodeOutputWorld')
bg = nt.nodes.new('ShaderNodeBackground')
bg.inputs['Strength'].default_value = 0.4
nt.links.new(bg.outputs['Background'], out.inputs['Surface'])

if HDRI_PATH:
    coord = nt.nodes.new('ShaderNodeTexCoord')
    mapping = nt.nodes.new('ShaderNodeMapping')
    mapping.inputs['Rotation'].default_value[2] = math.radians(45)
    env = nt.nodes.new('ShaderNodeTexEnvironment')
    env.image = bpy.data.images.load(HDRI_PATH, check_existing=True)
    nt.links.new(coord.outputs['Generated'], mapping.inputs['Vector'])
    nt.links.new(mapping.outputs['Vector'], env.inputs['Vector'])
    nt.links.new(env.outputs['Color'], bg.inputs['Color'])
else:
    sky = nt.nodes.new('ShaderNodeTexSky')
    sky.sky_type = 'NISHITA'
    sky.sun_elevation = math.radians(25)
    sky.sun_rotation = math.radians(120)
    sky.sun_intensity = 0.5
    sky.air_density = 1.2
    sky.dust_density = 0.8
    nt.links.new(sky.outputs['Color'], bg.inputs['Color'])


def area_light(name, location, energy, size, color=(1, 1, 1)):
    data = bpy.data.lights.new(name, type='AREA')
    data.energy = energy
    data.shape = 'RECTANGLE'
    data.size = size
    data.size_y = size * 0.6
    data.color = color
    data.use_shadow = True
    data.use_contact_shadow = True
    data.cycles.max_bounces = 4
    ob = bpy.data.objects.new(name, data)
    ob.location = location
    direction = Vector((0, 0, 0.5)) - Vector(location)
    ob.rotation_euler = direction.to_track_quat('-Z', 'Y').to_euler()
    scene.collection.objects.link(ob)
    return ob


area_light("Key", (4, -4, 5), 800, 2, (1.0, 0.95, 0.9))
area_light("Fill", (-5, -3, 3), 250, 3, (0.9, 0.95, 1.0))
area_light("Rim", (0, 5, 4), 500, 1.5)

sun = bpy.data.lights.new("Sun", 'SUN')
sun.energy = 2.0
sun.angle = math.radians(1.5)
sun.shadow_cascade_max_distance = 100
scene.collection.objects.link(bpy.data.objects.new("Sun", sun))
print([l.name for l in bpy.data.lights])
