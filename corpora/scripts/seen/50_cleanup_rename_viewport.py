"""Clean up a scene: purge orphans, remove empty material slots and doubles, batch rename, and set viewport shading."""
import bpy
import bmesh
import re

PREFIX = {'MESH': "geo", 'LIGHT': "lgt", 'CAMERA': "cam", 'CURVE': "crv",
          'EMPTY': "loc", 'ARMATURE': "rig", 'GPENCIL': "gp", 'FONT': "txt"}


def batch_rename():
    counters = {}
    for ob in sorted(bpy.data.objects, key=lambda o: o.name):
        base = re.sub(r"\.\d{3}$", "", ob.name).lower().replace(" ", "_")
        base = re.sub(r"^(geo|lgt|cam|crv|loc|rig|gp|txt)_", "", base)
        key = (ob.type, base)
        counters[key] = counters.get(key, 0) + 1
        ob.name = f"{PREFIX.get(ob.type, 'obj')}_{base}_{counters[key]:02d}"
        if ob.data:
            ob.data.name = ob.name + "_data"


def merge_doubles(ob, dist=0.0001):
    bm = bmesh.new()
    bm.from_mesh(ob.data)
    before = len(bm.verts)
    bmesh.ops.remove_doubles(bm, verts=bm.verts[:], dist=dist)
    bmesh.ops.dissolve_degenerate(bm, dist=dist, edges=bm.edges[:])
    bm.to_mesh(ob.data)
    removed = before - len(bm.verts)
    bm.free()
    return removed


def remove_unused_slots(ob):
    with bpy.context.temp_override(object=ob, active_object=ob, selected_objects=[ob]):
        bpy.ops.object.material_slot_remove_unused()


def purge():
    for block in (bpy.data.meshes, bpy.data.materials, bpy.data.textures, bpy.data.images):
        for item in [i for i in block if i.users == 0]:
            block.remove(item)
    bpy.ops.outliner.orphans_purge(do_local_ids=True, do_linked_ids=True, do_recursive=True)


def viewport():
    for screen in bpy.data.screens:
        for area in screen.areas:
            if area.type != 'VIEW_3D':
                continue
            space = area.spaces.active
            space.shading.type = 'SOLID'
            space.shading.light = 'MATCAP'
            space.shading.color_type = 'RANDOM'
            space.shading.show_cavity = True
            space.overlay.show_wireframes = True
            space.overlay.wireframe_threshold = 0.5
            space.clip_end = 2000
            space.show_gizmo = True


for ob in bpy.data.objects:
    if ob.type == 'MESH':
        print(ob.name, "merged", merge_doubles(ob))
        remove_unused_slots(ob)
batch_rename()
purge()
viewport()
bpy.context.preferences.view.show_statusbar_stats = True
print(sorted(o.name for o in bpy.data.objects))
