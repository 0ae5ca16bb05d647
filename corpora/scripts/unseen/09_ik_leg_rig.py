"""Create a simple leg rig with IK, a pole target and bone collections."""
import bpy
from mathutils import Vector

arm = bpy.data.armatures.new("LegRig")
rig = bpy.data.objects.new("LegRig", arm)
bpy.context.collection.objects.link(rig)
bpy.context.view_layer.objects.active = rig
rig.select_set(True)
bpy.ops.object.mode_set(mode='EDIT')

eb = arm.edit_bones


def add_bone(name, head, tail, parent=None, connect=False, deform=True):
    b = eb.new(name)
    b.head = Vector(head)
    b.tail = Vector(tail)
    b.use_deform = deform
    if parent:
        b.parent = eb[parent]
        b.use_connect = connect
    return b


add_bone("root", (0, 0, 0), (0, 0.5, 0), deform=False)
add_bone("thigh.L", (0.2, 0, 1.0), (0.2, -0.05, 0.5), "root")
add_bone("shin.L", (0.2, -0.05, 0.5), (0.2, 0, 0.08), "thigh.L", True)
add_bone("foot.L", (0.2, 0, 0.08), (0.2, -0.2, 0.0), "shin.L", True)
add_bone("foot_ik.L", (0.2, 0, 0.08), (0.2, 0.2, 0.08), "root", deform=False)
add_bone("knee_pole.L", (0.2, -0.8, 0.5), (0.2, -1.0, 0.5), "root", deform=False)

bpy.ops.armature.select_all(action='SELECT')
bpy.ops.armature.symmetrize()
bpy.ops.object.mode_set(mode='POSE')

for side in ("L", "R"):
    shin = rig.pose.bones["shin." + side]
    ik = shin.constraints.new('IK')
    ik.target = rig
    ik.subtarget = "foot_ik." + side
    ik.pole_target = rig
    ik.pole_subtarget = "knee_pole." + side
    ik.pole_angle = -1.5708
    ik.chain_count = 2
    foot = rig.pose.bones["foot." + side]
    con = foot.constraints.new('COPY_ROTATION')
    con.target = rig
    con.subtarget = "foot_ik." + side
    con.mix_mode = 'ADD'
    con.target_space = 'LOCAL'
    con.owner_space = 'LOCAL'

ctrl = arm.collections.new("Controls")
dfm = arm.collections.new("Deform")
for bone in arm.bones:
    if bone.use_deform:
        dfm.assign(bone)
    else:
        ctrl.assign(bone)
        rig.pose.bones[bone.name].custom_shape_scale_xyz = (1, 1, 1)
        bone.color.palette = 'THEME04'
arm.display_type = 'OCTAHEDRAL'
rig.show_in_front = True
bpy.ops.object.mode_set(mode='OBJECT')
print([b.name for b in arm.bones])
