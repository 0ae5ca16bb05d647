"""Cycles set-up: enable GPU if there is one, adaptive sampling, denoiser, light paths, tiles, then render a small still."""
import bpy
import os
import tempfile


def enable_gpu():
    prefs = bpy.context.preferences.addons['cycles'].preferences
    for kind in ('OPTIX', 'CUDA', 'HIP', 'METAL', 'ONEAPI'):
        try:
            prefs.compute_device_type = kind
        except TypeError:
            continue
        prefs.get_devices()
        gpus = [d for d in prefs.devices if d.type == kind]
        if gpus:
            for d in prefs.devices:
                d.use = d.type == kind
            bpy.context.scene.cycles.device = 'GPU'
            return kind
    bpy.context.scene.cycles.device = 'CPU'
    return 'CPU'


scene = bpy.context.scene
scene.render.engine = 'CYCLES'
print("device:", enable_gpu())

cy = scene.cycles
cy.feature_set = 'SUPPORTED'
cy.samples = 32
cy.preview_samples = 8
cy.use_adaptive_sampling = True
cy.adaptive_threshold = 0.02
cy.adaptive_min_samples = 8
cy.use_denoising = True
cy.denoiser = 'OPENIMAGEDENOISE'
cy.denoising_input_passes = 'RGB_ALBEDO_NORMAL'
cy.max_bounces = 8
cy.diffuse_bounces = 3
cy.glossy_bounces = 4
cy.transmission_bounces = 8
cy.volume_bounces = 1
cy.transparent_max_bounces = 8
cy.caustics_reflective = False
cy.caustics_refractive = False
cy.sample_clamp_indirect = 5.0
cy.blur_glossy = 1.0
cy.use_auto_tile = True
cy.tile_size = 1024
cy.use_fast_gi = True
cy.seed = 12
cy.use_animated_seed = True
cy.debug_use_spatial_splits = True
cy.film_exposure = 1.1
cy.pixel_filter_type = 'BLACKMAN_HARRIS'

r = scene.render
r.resolution_x, r.resolution_y = 160, 90
r.resolution_percentage = 100
r.use_persistent_data = True
r.tile_x = 256
r.threads_mode = 'AUTO'
r.filepath = os.path.join(tempfile.gettempdir(), "cycles_test.png")

if scene.camera is None:
    bpy.ops.object.camera_add(location=(6, -6, 4), rotation=(1.1, 0, 0.785))
    scene.camera = bpy.context.object
bpy.ops.render.render(write_still=True)
