"""Set up EEVEE rendering with shadows, ambient occlusion, motion blur and PNG + video output settings."""
import bpy
import os
import tempfile

scene = bpy.context.scene
render = scene.render

render.engine = 'BLENDER_EEVEE_NEXT'
render.resolution_x = 640
render.resolution_y = 360
render.resolution_percentage = 50
render.fps = 30
render.film_transparent = True

ee = scene.eevee
ee.taa_render_samples = 32
ee.taa_samples = 16
ee.use_gtao = True
ee.gtao_distance = 0.5
ee.use_shadows = True
ee.shadow_ray_count = 2
ee.shadow_step_count = 6
ee.use_raytracing = True
ee.ray_tracing_method = 'SCREEN'
ee.ray_tracing_options.resolution_scale = '2'
ee.ray_tracing_options.use_denoise = True
ee.use_ssr = True
ee.shadow_cube_size = '1024'
ee.volumetric_samples = 64

render.use_motion_blur = True
render.motion_blur_shutter = 0.5
ee.motion_blur_steps = 2

scene.view_settings.view_transform = 'AgX'
scene.view_settings.look = 'AgX - Medium High Contrast'
scene.view_settings.exposure = 0.2
scene.display_settings.display_device = 'sRGB'

render.image_settings.file_format = 'PNG'
render.image_settings.color_mode = 'RGBA'
render.image_settings.color_depth = '16'
render.image_settings.compression = 30
render.filepath = os.path.join(tempfile.gettempdir(), "eevee_still.png")
print("still:", render.filepath)


def setup_video(path):
    render.image_settings.file_format = 'FFMPEG'
    render.ffmpeg.format = 'MPEG4'
    render.ffmpeg.codec = 'H264'
    render.ffmpeg.constant_rate_factor = 'HIGH'
    render.ffmpeg.ffmpeg_preset = 'GOOD'
    render.ffmpeg.audio_codec = 'AAC'
    render.ffmpeg.gopsize = 12
    render.filepath = path


setup_video(os.path.join(tempfile.gettempdir(), "eevee_anim.mp4"))
print("frame path:", render.frame_path(frame=1))
