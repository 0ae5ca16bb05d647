"""Sort all the objects in the scene into collections by type, with color tags."""
import bpy

COLORS = {
    'MESH': 'COLOR_05',
    'LIGHT': 'COLOR_03',
    'CAMERA': 'COLOR_04',
    'EMPTY': 'COLOR_01',
    'CURVE': 'COLOR_06',
    'ARMATURE': 'COLOR_02',
}

scene = bpy.context.scene


def get_collection(name):
    coll = bpy.data.collections.get(name)
    if coll is None:
        coll = bpy.data.collections.new(name)
    if coll.name not in scene.collection.children:
        scene.collection.children.link(coll)
    return coll


for ob in list(scene.objects):
    target = get_collection(ob.type.capitalize() + "s")
    target.color_tag = COLORS.get(ob.type, 'NONE')
    for c in list(ob.users_collection):
        if c != target:
            c.objects.unlink(ob)
    if ob.name not in target.objects:
        target.objects.link(ob)

# get rid of empty collections
for coll in list(bpy.data.collections):
    if not coll.objects and not coll.children:
        bpy.data.collections.remove(coll)

# hide the lights collection in the viewport and exclude the empties from the view layer
vl = bpy.context.view_layer
for lc in vl.layer_collection.children:
    if lc.name == "Lights":
        lc.hide_viewport = True
    if lc.name == "Emptys":
        lc.exclude = True

for coll in scene.collection.children:
    print(coll.name, [o.name for o in coll.objects])
