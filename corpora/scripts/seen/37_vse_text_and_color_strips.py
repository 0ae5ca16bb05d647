"""Video sequencer: build a title card with colour strips, text strips, a cross fade and a transform."""
import bpy

scene = bpy.context.scene
scene.frame_start = 1
scene.frame_end = 150
scene.render.fps = 25

if not scene.sequence_editor:
    scene.sequence_editor_create()
seq = scene.sequence_editor.sequences

for s in list(seq):
    seq.remove(s)

bg1 = seq.new_effect(name="BlueBG", type='COLOR', channel=1, frame_start=1, frame_end=80)
bg1.color = (0.05, 0.1, 0.35)
bg2 = seq.new_effect(name="RedBG", type='COLOR', channel=2, frame_start=60, frame_end=150)
bg2.color = (0.4, 0.05, 0.05)

cross = seq.new_effect(name="Cross", type='GAMMA_CROSS', channel=3,
                       frame_start=60, frame_end=80, seq1=bg1, seq2=bg2)

title = seq.new_effect(name="Title", type='TEXT', channel=4, frame_start=10, frame_end=70)
title.text = "Hello Blender"
title.font_size = 90
title.color = (1, 1, 1, 1)
title.use_shadow = True
title.shadow_color = (0, 0, 0, 0.8)
title.location = (0.5, 0.6)
title.align_x = 'CENTER'
title.align_y = 'CENTER'
title.blend_type = 'ALPHA_OVER'

sub = seq.new_effect(name="Subtitle", type='TEXT', channel=5, frame_start=25, frame_end=140)
sub.text = "made with Python"
sub.font_size = 45
sub.wrap_width = 0.8
sub.transform.offset_y = -120
sub.transform.scale_x = 1.1

for strip in (title, sub):
    strip.blend_alpha = 0.0
    strip.keyframe_insert("blend_alpha", frame=strip.frame_final_start)
    strip.blend_alpha = 1.0
    strip.keyframe_insert("blend_alpha", frame=strip.frame_final_start + 12)

bg2.modifiers.new("Bright", 'BRIGHT_CONTRAST').bright = 10
adj = seq.new_effect(name="Grade", type='ADJUSTMENT', channel=6, frame_start=1, frame_end=150)
adj.color_saturation = 1.2

for s in sorted(scene.sequence_editor.sequences_all, key=lambda s: s.channel):
    print(s.channel, s.name, s.type, s.frame_final_start, s.frame_final_end, s.frame_final_duration)
