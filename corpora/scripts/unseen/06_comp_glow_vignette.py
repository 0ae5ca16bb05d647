"""Set up the compositor with a glow, lens distortion and a vignette on the render."""
import bpy

scene = bpy.context.scene
scene.use_nodes = True
tree = scene.node_tree
tree.nodes.clear()

rl = tree.nodes.new("CompositorNodeRLayers")
rl.location = (-600, 0)

glare = tree.nodes.new("CompositorNodeGlare")
glare.glare_type = 'FOG_GLOW'
glare.quality = 'HIGH'
glare.threshold = 0.8
glare.size = 7
glare.mix = -0.3
glare.location = (-300, 100)

lens = tree.nodes.new("CompositorNodeLensdist")
lens.inputs["Distortion"].default_value = 0.02
lens.inputs["Dispersion"].default_value = 0.01
lens.use_fit = True
lens.location = (-50, 100)

ellipse = tree.nodes.new("CompositorNodeEllipseMask")
ellipse.width = 0.9
ellipse.height = 0.7
ellipse.location = (-500, -350)

blur = tree.nodes.new("CompositorNodeBlur")
blur.filter_type = 'FAST_GAUSS'
blur.use_relative = True
blur.factor_x = 20
blur.factor_y = 20
blur.location = (-250, -350)

mix = tree.nodes.new("CompositorNodeMixRGB")
mix.blend_type = 'MULTIPLY'
mix.inputs[0].default_value = 0.6
mix.location = (200, 50)

comp = tree.nodes.new("CompositorNodeComposite")
comp.location = (450, 100)
viewer = tree.nodes.new("CompositorNodeViewer")
viewer.location = (450, -100)

links = tree.links
links.new(rl.outputs["Image"], glare.inputs["Image"])
links.new(glare.outputs["Image"], lens.inputs["Image"])
links.new(lens.outputs["Image"], mix.inputs[1])
links.new(ellipse.outputs["Mask"], blur.inputs["Image"])
links.new(blur.outputs["Image"], mix.inputs[2])
links.new(mix.outputs["Image"], comp.inputs["Image"])
links.new(mix.outputs["Image"], viewer.inputs["Image"])

scene.render.use_compositing = True
print("compositor nodes:", [n.name for n in tree.nodes])
