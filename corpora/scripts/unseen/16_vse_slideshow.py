"""Build a slideshow in the video sequencer with color strips, text titles and cross fades."""
import bpy

scene = bpy.context.scene
if scene.sequence_editor is None:
    scene.sequence_editor_create()
seq = scene.sequence_editor

for s in list(seq.sequences):
    seq.sequences.remove(s)

slides = [
    ("Intro", (0.1, 0.2, 0.5)),
    ("Chapter One", (0.5, 0.15, 0.1)),
    ("Chapter Two", (0.1, 0.4, 0.2)),
    ("The End", (0.05, 0.05, 0.05)),
]
length = 75
fade = 15
frame = 1
prev = None

for i, (title, color) in enumerate(slides):
    channel = 1 + (i % 2)
    strip = seq.sequences.new_effect(
        name="Slide_%d" % i, type='COLOR', channel=channel,
        frame_start=frame, frame_end=frame + length)
    strip.color = color

    txt = seq.sequences.new_effect(
        name="Title_%d" % i, type='TEXT', channel=5,
        frame_start=frame + fade, frame_end=frame + length - fade)
    txt.text = title
    txt.font_size = 96
    txt.location = (0.5, 0.5)
    txt.align_x = 'CENTER'
    txt.align_y = 'CENTER'
    txt.use_shadow = True
    txt.shadow_color = (0, 0, 0, 0.8)
    txt.blend_type = 'ALPHA_OVER'
    txt.blend_alpha = 0.0
    txt.keyframe_insert("blend_alpha", frame=frame + fade)
    txt.blend_alpha = 1.0
    txt.keyframe_insert("blend_alpha", frame=frame + fade + 10)

    if prev is not None:
        cross = seq.sequences.new_effect(
            name="Cross_%d" % i, type='CROSS', channel=3,
            frame_start=frame, frame_end=frame + fade,
            seq1=prev, seq2=strip)
        cross.use_default_fade = True
    prev = strip
    frame += length - fade

scene.frame_start = 1
scene.frame_end = frame + fade
scene.render.use_sequencer = True
for s in sorted(seq.sequences_all, key=lambda s: s.frame_final_start):
    print(s.name, s.type, s.channel, s.frame_final_start, s.frame_final_end)
