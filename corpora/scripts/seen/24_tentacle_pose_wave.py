"""Skinned tentacle: bone chain, automatic vertex weights by height, and a wave pose animation."""
import bpy
import math

BONES = 8
LENGTH = 0.5


def make_rig():
    bpy.ops.object.armature_add(enter_editmode=True, location=(0, 0, 0))
    rig = bpy.context.object
    rig.name = "Tentacle"
    ebs = rig.data.edit_bones
    ebs.remove(ebs[0])
    parent = None
    for i in range(BONES):
        b = ebs.new(f"seg_{i:02d}")
        b.head = (0, 0, i * LENGTH)
        b.tail = (0, 0, (i + 1) * LENGTH)
        if parent:
            b.parent = parent
            b.use_connect = True
        parent = b
    bpy.ops.object.mode_set(mode='OBJECT')
    rig.data.display_type = 'BBONE'
    for b in rig.data.bones:
        b.bbone_segments = 4
        b.bbone_x = 0.05
        b.bbone_z = 0.05
    return rig


def make_mesh(rig):
    bpy.ops.mesh.primitive_cone_add(vertices=24, radius1=0.4, radius2=0.05, depth=BONES * LENGTH,
                                    location=(0, 0, BONES * LENGTH / 2))
    ob = bpy.context.object
    bpy.ops.object.transform_apply(location=True)
    bpy.ops.object.mode_set(mode='EDIT')
    bpy.ops.mesh.select_all(action='SELECT')
    bpy.ops.mesh.subdivide(number_cuts=20)
    bpy.ops.object.mode_set(mode='OBJECT')
    for i in range(BONES):
        vg = ob.vertex_groups.new(name=f"seg_{i:02d}")
        center = (i + 0.5) * LENGTH
        for v in ob.data.vertices:
            w = 1 - abs(v.co.z - center) / LENGTH
            if w > 0:
                vg.add([v.index], w, 'ADD')
    ob.parent = rig
    mod = ob.modifiers.new("Armature", 'ARMATURE')
    mod.object = rig
    mod.use_deform_preserve_volume = True
    return ob


rig = make_rig()
mesh_ob = make_mesh(rig)
for frame in range(1, 61, 6):
    for i, pb in enumerate(rig.pose.bones):
        pb.rotation_mode = 'XYZ'
        pb.rotation_euler.x = math.radians(20) * math.sin(frame * 0.2 - i * 0.6)
        pb.keyframe_insert("rotation_euler", index=0, frame=frame, group=pb.name)

for pb in rig.pose.bones:
    pb.bone.select = pb.name.endswith("0")
print(len(rig.animation_data.action.fcurves), "curves")
bpy.context.scene.frame_set(30)
print("tip:", rig.pose.bones[-1].tail)
