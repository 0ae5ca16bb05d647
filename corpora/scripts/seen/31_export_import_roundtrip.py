"""Export every mesh object to OBJ, STL, FBX and glTF in a temp folder and import them back."""
import bpy
import os
import tempfile

out = tempfile.mkdtemp(prefix="roundtrip_")

if not [o for o in bpy.data.objects if o.type == 'MESH']:
    bpy.ops.mesh.primitive_monkey_add()

meshes = [o for o in bpy.context.scene.objects if o.type == 'MESH']

for ob in meshes:
    bpy.ops.object.select_all(action='DESELECT')
    ob.select_set(True)
    bpy.context.view_layer.objects.active = ob
    base = os.path.join(out, bpy.path.clean_name(ob.name))

    bpy.ops.wm.obj_export(filepath=base + ".obj", export_selected_objects=True,
                          forward_axis='NEGATIVE_Z', up_axis='Y',
                          export_materials=True, apply_modifiers=True)
    bpy.ops.export_mesh.stl(filepath=base + ".stl", use_selection=True, global_scale=1.0)
    bpy.ops.export_scene.fbx(filepath=base + ".fbx", use_selection=True,
                             apply_scale_options='FBX_SCALE_ALL',
                             object_types={'MESH', 'ARMATURE'},
                             bake_space_transform=False, mesh_smooth_type='FACE',
                             add_leaf_bones=False)
    bpy.ops.export_scene.gltf(filepath=base + ".glb", export_format='GLB',
                              use_selection=True, export_apply=True,
                              export_colors=True, export_yup=True)

for f in sorted(os.listdir(out)):
    path = os.path.join(out, f)
    before = set(bpy.data.objects)
    ext = os.path.splitext(f)[1].lower()
    if ext == ".obj":
        bpy.ops.wm.obj_import(filepath=path)
    elif ext == ".stl":
        bpy.ops.wm.stl_import(filepath=path)
    elif ext == ".fbx":
        bpy.ops.import_scene.fbx(filepath=path, automatic_bone_orientation=True)
    elif ext == ".glb":
        bpy.ops.import_scene.gltf(filepath=path)
    else:
        continue
    new = set(bpy.data.objects) - before
    print(f, "->", [o.name for o in new])
