"""Set up the compositor: glare, colour correction and a vignette on the rendered image."""
import bpy

scene = bpy.context.scene
scene.use_nodes = True
tree = scene.node_tree
for node in tree.nodes:
    tree.nodes.remove(node)

rl = tree.nodes.new("CompositorNodeRLayers")
rl.location = (-600, 0)

glare = tree.nodes.new("CompositorNodeGlare")
glare.glare_type = 'FOG_GLOW'
glare.quality = 'HIGH'
glare.threshold = 0.8
glare.size = 7
glare.location = (-300, 0)

cb = tree.nodes.new("CompositorNodeColorBalance")
cb.correction_method = 'LIFT_GAMMA_GAIN'
cb.lift = (0.98, 0.98, 1.03)
cb.gamma = (1.02, 1.0, 0.98)
cb.gain = (1.05, 1.02, 0.97)
cb.location = (0, 0)

mask = tree.nodes.new("CompositorNodeEllipseMask")
mask.width = 0.9
mask.height = 0.7
mask.location = (-300, -400)

blur = tree.nodes.new("CompositorNodeBlur")
blur.filter_type = 'FAST_GAUSS'
blur.use_relative = True
blur.factor_x = 20
blur.factor_y = 20
blur.location = (0, -400)

mix = tree.nodes.new("CompositorNodeMixRGB")
mix.blend_type = 'MULTIPLY'
mix.inputs[0].default_value = 0.7
mix.location = (300, 0)

lens = tree.nodes.new("CompositorNodeLensdist")
lens.use_fit = True
lens.inputs["Dispersion"].default_value = 0.015
lens.location = (500, 0)

comp = tree.nodes.new("CompositorNodeComposite")
comp.location = (750, 0)
viewer = tree.nodes.new("CompositorNodeViewer")
viewer.location = (750, -200)

tree.links.new(rl.outputs["Image"], glare.inputs["Image"])
tree.links.new(glare.outputs["Image"], cb.inputs["Image"])
tree.links.new(mask.outputs["Mask"], blur.inputs["Image"])
tree.links.new(cb.outputs["Image"], mix.inputs[1])
tree.links.new(blur.outputs["Image"], mix.inputs[2])
tree.links.new(mix.outputs["Image"], lens.inputs["Image"])
tree.links.new(lens.outputs["Image"], comp.inputs["Image"])
tree.links.new(lens.outputs["Image"], viewer.inputs["Image"])
print("Compositor nodes:", len(tree.nodes))
