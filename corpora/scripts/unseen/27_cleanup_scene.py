"""Clean-up tool: purge orphans, remove unused material slots, merge doubles, recalc normals, apply scale on all meshes."""
import bpy
import bmesh


def clean_mesh(ob, dist=0.0001):
    me = ob.data
    bm = bmesh.new()
    bm.from_mesh(me)
    before = len(bm.verts)
    bmesh.ops.remove_doubles(bm, verts=bm.verts, dist=dist)
    bmesh.ops.dissolve_degenerate(bm, edges=bm.edges, dist=dist)
    loose = [v for v in bm.verts if not v.link_edges]
    bmesh.ops.delete(bm, geom=loose, context='VERTS')
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces)
    after = len(bm.verts)
    bm.to_mesh(me)
    bm.free()
    me.update()
    return before - after


def clean_slots(ob):
    used = {p.material_index for p in ob.data.polygons}
    for i in reversed(range(len(ob.material_slots))):
        if i not in used:
            ob.active_material_index = i
            ob.data.materials.pop(index=i)


if bpy.context.object and bpy.context.object.mode != 'OBJECT':
    bpy.ops.object.mode_set(mode='OBJECT')

bpy.ops.object.select_all(action='DESELECT')
removed = 0
for ob in bpy.context.scene.objects:
    if ob.type != 'MESH':
        continue
    removed += clean_mesh(ob)
    clean_slots(ob)
    if ob.data.has_custom_normals:
        bpy.context.view_layer.objects.active = ob
        bpy.ops.mesh.customdata_custom_splitnormals_clear()
    if ob.data.users == 1:
        ob.select_set(True)

if bpy.context.selected_objects:
    bpy.context.view_layer.objects.active = bpy.context.selected_objects[0]
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)

# merge duplicate materials Foo.001 -> Foo
for mat in list(bpy.data.materials):
    base, _, num = mat.name.rpartition(".")
    if num.isdigit() and base in bpy.data.materials:
        mat.user_remap(bpy.data.materials[base])
        bpy.data.materials.remove(mat)

bpy.ops.outliner.orphans_purge(do_local_ids=True, do_linked_ids=True, do_recursive=True)
print("removed verts:", removed)
