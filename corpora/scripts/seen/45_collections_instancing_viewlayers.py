"""Organise objects in nested collections, instance a collection on a grid, and make view layers that exclude some of them."""
import bpy
import random
from math import radians

scene = bpy.context.scene
random.seed(1)


def get_collection(name, parent=None, color='NONE'):
    coll = bpy.data.collections.get(name) or bpy.data.collections.new(name)
    parent = parent or scene.collection
    if coll.name not in parent.children:
        parent.children.link(coll)
    coll.color_tag = color
    return coll


props = get_collection("Props", color='COLOR_03')
lamp = get_collection("LampPost", props, 'COLOR_05')
city = get_collection("City", color='COLOR_01')


def move_to(ob, coll):
    for c in ob.users_collection:
        c.objects.unlink(ob)
    coll.objects.link(ob)


bpy.ops.mesh.primitive_cylinder_add(radius=0.05, depth=3, location=(0, 0, 1.5))
move_to(bpy.context.object, lamp)
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.25, location=(0, 0, 3.1))
move_to(bpy.context.object, lamp)
lamp.instance_offset = (0, 0, 0)

for x in range(5):
    for y in range(5):
        inst = bpy.data.objects.new(f"lamp_{x}_{y}", None)
        inst.instance_type = 'COLLECTION'
        inst.instance_collection = lamp
        inst.location = (x * 3, y * 3, 0)
        inst.rotation_euler.z = radians(random.uniform(0, 360))
        inst.empty_display_size = 0.2
        city.objects.link(inst)


def find_layer_collection(layer_coll, name):
    if layer_coll.name == name:
        return layer_coll
    for child in layer_coll.children:
        found = find_layer_collection(child, name)
        if found:
            return found


main_layer = bpy.context.view_layer
find_layer_collection(main_layer.layer_collection, "Props").exclude = True

fg = scene.view_layers.new("Foreground")
find_layer_collection(fg.layer_collection, "City").holdout = True
fg.use_pass_z = True
fg.use_pass_object_index = True
fg.samples = 32
bgl = scene.view_layers.new("Background")
find_layer_collection(bgl.layer_collection, "Props").indirect_only = True
bgl.use_sky = True
bgl.use_ao = False

scene.render.use_single_layer = False
dg = bpy.context.evaluated_depsgraph_get()
print("instances:", sum(1 for i in dg.object_instances if i.is_instance))
print([vl.name for vl in scene.view_layers])
