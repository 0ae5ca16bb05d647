"""Grease pencil v3: frame-by-frame animation of a growing line, with a noise and thickness modifier."""
import bpy
import math


def main():
    scene = bpy.context.scene
    scene.frame_end = 24
    data = bpy.data.grease_pencils_v3.new("GrowingLine")
    ob = bpy.data.objects.new("GrowingLine", data)
    scene.collection.objects.link(ob)

    mat = bpy.data.materials.new("GP_Blue")
    bpy.data.materials.create_gpencil_data(mat)
    mat.grease_pencil.color = (0.1, 0.2, 0.9, 1.0)
    data.materials.append(mat)

    layer = data.layers.new("Animated")
    layer.opacity = 0.9
    layer.blend_mode = 'REGULAR'
    layer.tint_color = (1, 1, 1)
    layer.tint_factor = 0.0

    for f in range(1, 25, 2):
        frame = layer.frames.new(f)
        drawing = frame.drawing
        n = 4 + f * 2
        drawing.add_strokes([n])
        stroke = drawing.strokes[0]
        stroke.cyclic = False
        stroke.material_index = 0
        stroke.softness = 0.1
        for i, pt in enumerate(stroke.points):
            t = i / 10
            pt.position = (t, 0.0, math.sin(t * 2) * 0.5)
            pt.radius = 0.02 + 0.01 * math.sin(t * 5)
            pt.opacity = 1.0
            pt.vertex_color = (1.0, 0.2, 0.2, 0.5)

    noise = ob.modifiers.new("Noise", 'GREASE_PENCIL_NOISE')
    noise.factor = 0.3
    noise.noise_scale = 0.5
    noise.step = 2
    thick = ob.modifiers.new("Thickness", 'GREASE_PENCIL_THICKNESS')
    thick.thickness_factor = 1.5
    thick.use_uniform_thickness = False

    print("frames:", [fr.frame_number for fr in layer.frames])
    last = layer.frames[-1].drawing
    print("attributes:", [a.name for a in last.attributes])
    print("points in last:", len(last.strokes[0].points))
    layer.frames.remove(1)


main()
