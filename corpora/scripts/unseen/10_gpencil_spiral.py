"""Draw a colored spiral with grease pencil from Python, with thickness that grows."""
import bpy
import math

gp_data = bpy.data.grease_pencils.new("SpiralGP")
gp_obj = bpy.data.objects.new("Spiral", gp_data)
bpy.context.scene.collection.objects.link(gp_obj)

mat = bpy.data.materials.new("SpiralInk")
bpy.data.materials.create_gpencil_data(mat)
mat.grease_pencil.show_stroke = True
mat.grease_pencil.color = (0.9, 0.2, 0.1, 1.0)
mat.grease_pencil.show_fill = False
gp_data.materials.append(mat)

layer = gp_data.layers.new("Lines", set_active=True)
layer.use_lights = False

turns = 6
steps = 60
total = turns * steps

for f in range(1, 6):
    frame = layer.frames.new(f * 10)
    stroke = frame.strokes.new()
    stroke.display_mode = '3DSPACE'
    stroke.line_width = 40
    stroke.material_index = 0
    count = int(total * f / 5)
    stroke.points.add(count=count)
    for i in range(count):
        a = 2 * math.pi * i / steps
        r = 0.05 + 0.4 * i / steps
        p = stroke.points[i]
        p.co = (math.cos(a) * r, 0, math.sin(a) * r)
        p.pressure = 0.2 + 1.2 * i / total
        p.strength = 1.0

mod = gp_obj.grease_pencil_modifiers.new("Noise", 'GP_NOISE')
mod.factor = 0.1

bpy.context.scene.frame_end = 60
print("strokes per frame:", [len(fr.strokes) for fr in layer.frames])
