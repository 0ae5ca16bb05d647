"""Export every mesh object of the scene to its own FBX, OBJ and glTF file with transforms at the origin."""
import bpy
import os
import tempfile

out = os.path.join(tempfile.gettempdir(), "exports")
os.makedirs(out, exist_ok=True)

meshes = [o for o in bpy.context.scene.objects if o.type == 'MESH']
if not meshes:
    bpy.ops.mesh.primitive_cube_add(location=(2, 0, 0))
    meshes.append(bpy.context.object)

bpy.ops.mesh.primitive_torus_add(location=(-3, 1, 0))
meshes.append(bpy.context.object)

for ob in meshes:
    bpy.ops.object.select_all(action='DESELECT')
    ob.select_set(True)
    bpy.context.view_layer.objects.active = ob
    loc = ob.location.copy()
    ob.location = (0, 0, 0)
    name = bpy.path.clean_name(ob.name)

    bpy.ops.export_scene.fbx(
        filepath=os.path.join(out, name + ".fbx"),
        use_selection=True,
        apply_scale_options='FBX_SCALE_ALL',
        axis_forward='-Z',
        axis_up='Y',
        use_mesh_modifiers=True,
        mesh_smooth_type='FACE',
        bake_anim=False,
    )
    bpy.ops.export_scene.obj(
        filepath=os.path.join(out, name + ".obj"),
        use_selection=True,
        use_materials=True,
        use_triangles=True,
    )
    bpy.ops.export_scene.gltf(
        filepath=os.path.join(out, name + ".glb"),
        export_format='GLB',
        use_selection=True,
        export_apply=True,
        export_colors=True,
    )
    ob.location = loc

print(sorted(os.listdir(out)))
