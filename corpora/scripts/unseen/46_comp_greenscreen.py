"""Compositor green screen set-up: keying node, despill, color balance, alpha over on a gradient background."""
import bpy

scene = bpy.context.scene
scene.use_nodes = True
nt = scene.node_tree
for n in list(nt.nodes):
    nt.nodes.remove(n)

img = bpy.data.images.new("GreenPlate", 960, 540)
img.generated_type = 'BLANK'
img.generated_color = (0.1, 0.7, 0.15, 1)

src = nt.nodes.new('CompositorNodeImage')
src.image = img

key = nt.nodes.new('CompositorNodeKeying')
key.inputs["Key Color"].default_value = (0.1, 0.7, 0.15, 1)
key.clip_black = 0.1
key.clip_white = 0.9
key.dilate_distance = -1
key.feather_distance = 2
key.despill_factor = 1.0

spill = nt.nodes.new('CompositorNodeColorSpill')
spill.channel = 'G'
spill.limit_method = 'AVERAGE'

bal = nt.nodes.new('CompositorNodeColorBalance')
bal.correction_method = 'LIFT_GAMMA_GAIN'
bal.lift = (1.0, 0.98, 0.97)
bal.gamma = (1.02, 1.0, 0.98)
bal.gain = (1.05, 1.0, 0.95)

bg = nt.nodes.new('CompositorNodeRGB')
bg.outputs[0].default_value = (0.05, 0.1, 0.3, 1)

over = nt.nodes.new('CompositorNodeAlphaOver')
over.premul = 1.0

curves = nt.nodes.new('CompositorNodeCurveRGB')
c = curves.mapping.curves[3]
c.points.new(0.25, 0.2)
c.points.new(0.75, 0.8)
curves.mapping.update()

scale = nt.nodes.new('CompositorNodeScale')
scale.space = 'RENDER_SIZE'
scale.frame_method = 'FIT'

comp = nt.nodes.new('CompositorNodeComposite')
comp.use_alpha = True

link = nt.links.new
link(src.outputs['Image'], scale.inputs['Image'])
link(scale.outputs['Image'], key.inputs['Image'])
link(key.outputs['Image'], spill.inputs['Image'])
link(spill.outputs['Image'], bal.inputs['Image'])
link(bg.outputs[0], over.inputs[1])
link(bal.outputs['Image'], over.inputs[2])
link(over.outputs['Image'], curves.inputs['Image'])
link(curves.outputs['Image'], comp.inputs['Image'])

for i, n in enumerate(nt.nodes):
    n.location = (i * 220, 0)
print(len(nt.nodes), "nodes", len(nt.links), "links")
