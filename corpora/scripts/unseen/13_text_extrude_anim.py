"""Create 3D title text with extrude and bevel, and animate the letters appearing one after another."""
import bpy
import math

text = "BLENDER"
start = 1
step = 6

scene = bpy.context.scene
coll = bpy.data.collections.new("Title")
scene.collection.children.link(coll)

mat = bpy.data.materials.new("TitleGold")
mat.use_nodes = True
bsdf = mat.node_tree.nodes["Principled BSDF"]
bsdf.inputs["Base Color"].default_value = (1.0, 0.7, 0.2, 1)
bsdf.inputs["Metallic"].default_value = 1
bsdf.inputs["Roughness"].default_value = 0.2
bsdf.inputs["Emission"].default_value = (1.0, 0.5, 0.1, 1)
bsdf.inputs["Emission Strength"].default_value = 0.2

x = 0.0
letters = []
for i, ch in enumerate(text):
    cu = bpy.data.curves.new("Letter_" + ch, type='FONT')
    cu.body = ch
    cu.size = 1.0
    cu.extrude = 0.1
    cu.bevel_depth = 0.02
    cu.bevel_resolution = 3
    cu.align_x = 'CENTER'
    cu.align_y = 'CENTER'
    cu.materials.append(mat)
    ob = bpy.data.objects.new("Letter_%02d" % i, cu)
    coll.objects.link(ob)
    bpy.context.view_layer.update()
    w = ob.dimensions.x
    ob.location = (x + w / 2, 0, 0)
    ob.rotation_euler.x = math.pi / 2
    x += w + 0.12
    letters.append(ob)

for ob in letters:
    ob.location.x -= x / 2

for i, ob in enumerate(letters):
    f = start + i * step
    ob.scale = (0, 0, 0)
    ob.keyframe_insert("scale", frame=f)
    ob.scale = (1, 1, 1)
    ob.keyframe_insert("scale", frame=f + 15)
    for fc in ob.animation_data.action.fcurves:
        for k in fc.keyframe_points:
            k.interpolation = 'BACK'
            k.easing = 'EASE_OUT'

scene.frame_end = start + len(text) * step + 40
print("title width", round(x, 2))
