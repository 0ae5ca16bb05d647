"""Draw a grease pencil spiral and a star from Python with its own layer and materials."""
import bpy
import math

gp_data = bpy.data.grease_pencils.new("Sketch")
gp_ob = bpy.data.objects.new("Sketch", gp_data)
bpy.context.scene.collection.objects.link(gp_ob)


def gp_material(name, stroke, fill=None):
    mat = bpy.data.materials.new(name)
    bpy.data.materials.create_gpencil_data(mat)
    mat.grease_pencil.color = stroke
    mat.grease_pencil.show_stroke = True
    if fill:
        mat.grease_pencil.show_fill = True
        mat.grease_pencil.fill_color = fill
    gp_data.materials.append(mat)
    return mat


gp_material("Ink", (0, 0, 0, 1))
gp_material("StarFill", (0.6, 0.3, 0, 1), (1, 0.85, 0.1, 1))

layer = gp_data.layers.new("Lines", set_active=True)
layer.use_lights = False
frame = layer.frames.new(1)


def add_stroke(frame, points, material_index=0, cyclic=False, width=20):
    stroke = frame.strokes.new()
    stroke.display_mode = '3DSPACE'
    stroke.line_width = width
    stroke.material_index = material_index
    stroke.use_cyclic = cyclic
    stroke.points.add(count=len(points))
    for p, co in zip(stroke.points, points):
        p.co = co
        p.pressure = 1.0
        p.strength = 1.0
    return stroke


spiral = []
for i in range(200):
    a = i * 0.15
    r = 0.02 * i * 0.5
    spiral.append((r * math.cos(a), 0, r * math.sin(a)))
add_stroke(frame, spiral)

star = []
for i in range(10):
    a = math.pi / 2 + i * math.pi / 5
    r = 1.0 if i % 2 == 0 else 0.4
    star.append((3.5 + r * math.cos(a), 0, r * math.sin(a)))
add_stroke(frame, star, material_index=1, cyclic=True, width=40)

print("strokes:", len(frame.strokes), "points:", sum(len(s.points) for s in frame.strokes))
