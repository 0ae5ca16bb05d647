"""Build a leg armature with an IK constraint, a pole target and bone custom colours."""
import bpy
import math
from mathutils import Vector

arm = bpy.data.armatures.new("LegRig")
rig = bpy.data.objects.new("LegRig", arm)
bpy.context.scene.collection.objects.link(rig)
bpy.context.view_layer.objects.active = rig
rig.select_set(True)

bpy.ops.object.mode_set(mode='EDIT')
eb = arm.edit_bones


def bone(name, head, tail, parent=None, connect=False, deform=True):
    b = eb.new(name)
    b.head = Vector(head)
    b.tail = Vector(tail)
    b.use_deform = deform
    if parent:
        b.parent = eb[parent]
        b.use_connect = connect
    return b


bone("root", (0, 0, 0), (0, 0.5, 0), deform=False)
bone("thigh", (0, 0, 2), (0, -0.1, 1), "root")
bone("shin", (0, -0.1, 1), (0, 0, 0.1), "thigh", True)
bone("foot", (0, 0, 0.1), (0, -0.4, 0), "shin", True)
bone("ik_foot", (0, 0, 0.1), (0, 0.4, 0.1), "root", deform=False)
bone("pole_knee", (0, -1.5, 1), (0, -1.8, 1), "root", deform=False)
for b in eb:
    if b.name in {"thigh", "shin"}:
        b.roll = math.radians(0)

bpy.ops.object.mode_set(mode='POSE')
pb = rig.pose.bones
ik = pb["shin"].constraints.new('IK')
ik.target = rig
ik.subtarget = "ik_foot"
ik.pole_target = rig
ik.pole_subtarget = "pole_knee"
ik.pole_angle = math.radians(-90)
ik.chain_count = 2

ctrl = arm.collections.new("Controls")
deform = arm.collections.new("Deform")
for b in arm.bones:
    (deform if b.use_deform else ctrl).assign(b)
    b.color.palette = 'THEME01' if b.use_deform else 'THEME04'

pb["shin"].lock_ik_y = True
pb["shin"].lock_ik_z = True
pb["ik_foot"].location = (0, 0.3, 0.5)
pb["ik_foot"].keyframe_insert("location", frame=1)
pb["ik_foot"].location = (0, 0, 0)
pb["ik_foot"].keyframe_insert("location", frame=20)
bpy.context.view_layer.update()
print("knee at", (rig.matrix_world @ pb["shin"].head))
bpy.ops.object.mode_set(mode='OBJECT')
arm.display_type = 'OCTAHEDRAL'
rig.show_in_front = True
arm.layers[0] = True
