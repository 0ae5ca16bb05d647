"""Three point lighting around the active object, with area lights tracked to it and a dark world."""
import bpy
from mathutils import Vector

scene = bpy.context.scene
target = bpy.context.active_object
if target is None or target.type != 'MESH':
    bpy.ops.mesh.primitive_monkey_add(size=2)
    target = bpy.context.active_object

for ob in [o for o in scene.objects if o.type == 'LIGHT']:
    bpy.data.objects.remove(ob)

center = target.matrix_world @ (sum((Vector(c) for c in target.bound_box), Vector()) / 8)
size = max(target.dimensions)

empty = bpy.data.objects.new("LightTarget", None)
empty.location = center
scene.collection.objects.link(empty)


def add_area(name, offset, energy, color, scale):
    data = bpy.data.lights.new(name, type='AREA')
    data.energy = energy
    data.color = color
    data.shape = 'RECTANGLE'
    data.size = scale
    data.size_y = scale * 0.6
    data.use_contact_shadow = True
    data.cycles.cast_shadow = True
    ob = bpy.data.objects.new(name, data)
    ob.location = center + Vector(offset) * size
    scene.collection.objects.link(ob)
    con = ob.constraints.new(type='TRACK_TO')
    con.target = empty
    con.track_axis = 'TRACK_NEGATIVE_Z'
    con.up_axis = 'UP_Y'
    return ob


key = add_area("Key", (2, -2, 2), 400, (1.0, 0.95, 0.85), size)
fill = add_area("Fill", (-2.5, -1.5, 0.8), 120, (0.8, 0.9, 1.0), size * 2)
rim = add_area("Rim", (0.5, 2.5, 2.2), 500, (1, 1, 1), size * 0.8)

world = scene.world or bpy.data.worlds.new("World")
scene.world = world
world.use_nodes = True
bg = world.node_tree.nodes.get("Background")
bg.inputs[0].default_value = (0.01, 0.012, 0.02, 1)
bg.inputs[1].default_value = 0.5

scene.view_settings.view_transform = 'Filmic'
scene.view_settings.look = 'Medium High Contrast'
scene.view_settings.exposure = 0.2
print([o.name for o in (key, fill, rim)])
