"""Enable render passes and write them with a File Output node as multilayer EXR, with a denoise node."""
import bpy
import os
import tempfile

scene = bpy.context.scene
scene.render.engine = 'CYCLES'
view_layer = scene.view_layers["ViewLayer"]
view_layer.use_pass_z = True
view_layer.use_pass_mist = True
view_layer.use_pass_normal = True
view_layer.use_pass_diffuse_color = True
view_layer.use_pass_ambient_occlusion = True
view_layer.use_pass_cryptomatte_object = True
view_layer.cycles.denoising_store_passes = True
scene.world.mist_settings.start = 2
scene.world.mist_settings.depth = 30

scene.use_nodes = True
nt = scene.node_tree
nt.nodes.clear()

rlayers = nt.nodes.new('CompositorNodeRLayers')
denoise = nt.nodes.new('CompositorNodeDenoise')
denoise.location = (350, 200)
denoise.use_hdr = True
denoise.prefilter = 'ACCURATE'
composite = nt.nodes.new('CompositorNodeComposite')
composite.location = (700, 200)

nt.links.new(rlayers.outputs['Image'], denoise.inputs['Image'])
nt.links.new(rlayers.outputs['Denoising Normal'], denoise.inputs['Normal'])
nt.links.new(rlayers.outputs['Denoising Albedo'], denoise.inputs['Albedo'])
nt.links.new(denoise.outputs['Image'], composite.inputs['Image'])

fo = nt.nodes.new('CompositorNodeOutputFile')
fo.location = (700, -200)
fo.base_path = os.path.join(tempfile.gettempdir(), "passes_")
fo.format.file_format = 'OPEN_EXR_MULTILAYER'
fo.format.color_depth = '16'
fo.format.exr_codec = 'ZIP'
fo.file_slots.clear()

for name in ('Image', 'Depth', 'Mist', 'Normal', 'DiffCol', 'AO'):
    if name in rlayers.outputs:
        fo.layer_slots.new(name)
        nt.links.new(rlayers.outputs[name], fo.inputs[name])

scene.render.resolution_x = 320
scene.render.resolution_y = 180
scene.cycles.samples = 8
print([s.name for s in fo.layer_slots])
