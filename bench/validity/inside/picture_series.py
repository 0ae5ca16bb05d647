# SPDX-License-Identifier: GPL-3.0-or-later
"""Small pictures of the open scene, and how much two series of them differ."""

import bpy
import numpy

_WIDTH, _HEIGHT = 160, 90
_CYCLES_WIDTH, _CYCLES_HEIGHT, _SAMPLES, _BOUNCES = 96, 54, 16, 8


def render(path, cycles, seed):
    """Renders start, middle and end to ``path`` with -0, -1, -2.png.

    By Workbench, or by Cycles with ``seed``, smaller: Workbench shows nothing of volumes, and nothing behind glass.
    """
    scene = bpy.context.scene
    settings = scene.render
    settings.resolution_percentage, settings.use_motion_blur = 100, False
    settings.use_compositing = settings.use_sequencer = False
    settings.image_settings.file_format, settings.image_settings.color_mode = "PNG", "RGB"
    if cycles:
        settings.engine = "CYCLES"
        settings.resolution_x, settings.resolution_y = _CYCLES_WIDTH, _CYCLES_HEIGHT
        engine = scene.cycles
        engine.samples, engine.seed, engine.use_denoising = _SAMPLES, seed, False
        engine.use_adaptive_sampling, engine.max_bounces = False, _BOUNCES
        engine.volume_biased = True  # much faster at this size
    else:
        settings.engine = "BLENDER_WORKBENCH"
        settings.resolution_x, settings.resolution_y = _WIDTH, _HEIGHT
    first, last = scene.frame_start, scene.frame_end
    for number, frame in enumerate((first, (first + last) // 2, last)):
        scene.frame_set(frame)
        settings.filepath = f"{path}-{number}.png"
        bpy.ops.render.render(write_still=True)


def compare(first, second):
    """The mean absolute difference of red, green and blue (0 to 1) over both series, as they were saved."""
    pairs = [(_pixels(f"{first}-{number}.png"), _pixels(f"{second}-{number}.png")) for number in range(3)]
    return float(numpy.mean([numpy.abs(a - b).mean() for a, b in pairs]))


def _pixels(path):
    image = bpy.data.images.load(path)
    try:
        image.colorspace_settings.name = "Non-Color"
        flat = numpy.empty(len(image.pixels), dtype=numpy.float32)
        image.pixels.foreach_get(flat)
        return flat.reshape(-1, image.channels)[:, :3]
    finally:
        bpy.data.images.remove(image)
