"""3D text that follows a bezier curve, with bevel and extrude, converted to mesh at the end."""
import bpy
import math

curve = bpy.data.curves.new("Path", 'CURVE')
curve.dimensions = '3D'
curve.resolution_u = 24
spline = curve.splines.new('BEZIER')
spline.bezier_points.add(3)
pts = [(-4, 0, 0), (-1.5, 1.5, 0), (1.5, -1.5, 0), (4, 0, 0)]
for bp, co in zip(spline.bezier_points, pts):
    bp.co = co
    bp.handle_left_type = 'AUTO'
    bp.handle_right_type = 'AUTO'
path = bpy.data.objects.new("Path", curve)
bpy.context.collection.objects.link(path)

font_curve = bpy.data.curves.new(name="Label", type='FONT')
font_curve.body = "Following a curve"
font_curve.size = 0.7
font_curve.extrude = 0.08
font_curve.bevel_depth = 0.015
font_curve.bevel_resolution = 3
font_curve.align_x = 'CENTER'
font_curve.align_y = 'BOTTOM'
font_curve.space_character = 1.1
font_curve.fill_mode = 'BOTH'
font_curve.follow_curve = path
text = bpy.data.objects.new("Label", font_curve)
bpy.context.collection.objects.link(text)

for i, ch in enumerate(font_curve.body_format[:9]):
    ch.use_bold = True
    ch.material_index = 0

mat = bpy.data.materials.new("Gold")
mat.use_nodes = True
p = mat.node_tree.nodes["Principled BSDF"]
p.inputs["Base Color"].default_value = (1.0, 0.76, 0.33, 1)
p.inputs["Metallic"].default_value = 1
p.inputs["Roughness"].default_value = 0.2
font_curve.materials.append(mat)

bpy.ops.object.text_add(location=(0, 0, 2), rotation=(math.radians(90), 0, 0))
second = bpy.context.object
second.data.body = "Mesh text"
second.data.align_x = 'CENTER'
second.data.extrude = 0.1
second.data.offset = 0.01
bpy.ops.object.convert(target='MESH')
second = bpy.context.object
rem = second.modifiers.new("Remesh", 'REMESH')
rem.mode = 'VOXEL'
rem.voxel_size = 0.03
print(second.type, len(second.data.vertices))

dg = bpy.context.evaluated_depsgraph_get()
me = bpy.data.meshes.new_from_object(text.evaluated_get(dg))
print("text mesh verts:", len(me.vertices), "dims:", tuple(round(d, 2) for d in text.dimensions))
