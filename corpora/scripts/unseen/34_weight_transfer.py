"""Parent a mesh to an armature with automatic weights, limit to 4 bones per vertex and normalize, then print the weights."""
import bpy

bpy.ops.mesh.primitive_cylinder_add(vertices=24, radius=0.3, depth=4, location=(0, 0, 2))
mesh_ob = bpy.context.object
mesh_ob.name = "Arm"
bpy.ops.object.mode_set(mode='EDIT')
bpy.ops.mesh.select_all(action='SELECT')
bpy.ops.mesh.bisect(plane_co=(0, 0, 2), plane_no=(0, 0, 1))
for i in range(1, 16):
    bpy.ops.mesh.select_all(action='SELECT')
    bpy.ops.mesh.bisect(plane_co=(0, 0, i * 0.25), plane_no=(0, 0, 1))
bpy.ops.object.mode_set(mode='OBJECT')

bpy.ops.object.armature_add(enter_editmode=True, location=(0, 0, 0))
rig = bpy.context.object
rig.name = "ArmRig"
bones = rig.data.edit_bones
b = bones[0]
b.name = "bone_0"
b.head = (0, 0, 0)
b.tail = (0, 0, 1)
for i in range(1, 4):
    nb = bones.new("bone_%d" % i)
    nb.head = b.tail
    nb.tail = (0, 0, i + 1)
    nb.parent = b
    nb.use_connect = True
    b = nb
bpy.ops.object.mode_set(mode='OBJECT')

bpy.ops.object.select_all(action='DESELECT')
mesh_ob.select_set(True)
rig.select_set(True)
bpy.context.view_layer.objects.active = rig
bpy.ops.object.parent_set(type='ARMATURE_AUTO')

bpy.context.view_layer.objects.active = mesh_ob
bpy.ops.object.mode_set(mode='WEIGHT_PAINT')
bpy.ops.object.vertex_group_limit_total(group_select_mode='ALL', limit=4)
bpy.ops.object.vertex_group_normalize_all(lock_active=False)
bpy.ops.object.vertex_group_clean(group_select_mode='ALL', limit=0.01)
bpy.ops.object.mode_set(mode='OBJECT')

for m in mesh_ob.modifiers:
    if m.type == 'ARMATURE':
        m.use_deform_preserve_volume = True

rig.data.pose_position = 'POSE'
pb = rig.pose.bones["bone_2"]
pb.rotation_mode = 'XYZ'
pb.rotation_euler = (0.8, 0, 0)
pb.keyframe_insert("rotation_euler", frame=10)
pb.bone.select = True
rig.data.bones.active = pb.bone

for v in list(mesh_ob.data.vertices)[:5]:
    print(v.index, [(mesh_ob.vertex_groups[g.group].name, round(g.weight, 3)) for g in v.groups])
