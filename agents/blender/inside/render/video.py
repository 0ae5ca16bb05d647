# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a video of pictures with Blender's own FFmpeg: H.264 in MP4."""

import os
import sys
import time

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.temporary import without_render_result
from .shot_settings import escaped_path

_SCENE = ".video"


def assemble(arguments, report):
    """Makes the video ``path`` of ``pictures``: file names in ``folder``, one for each frame.

    ``width`` and ``height`` are those of the pictures, and even; the rate is ``fps`` / ``fps_base``. Returns what is
    read back from the video: {"frames", "width", "height", "fps", "bytes", "seconds"}.
    """
    path = arguments["path"]
    started = time.perf_counter()
    scene = bpy.data.scenes.new(_SCENE)
    progress = _Progress(scene.name, len(arguments["pictures"]), report)
    try:
        _add_strip(scene, arguments)
        _set_up(scene, arguments)
        bpy.app.handlers.render_post.append(progress)
        with without_render_result():
            bpy.ops.render.render(animation=True, scene=scene.name)
    except RuntimeError as error:
        raise Refused(f"The video could not be made: {str(error).strip()[:600]}") from None
    finally:
        if progress in bpy.app.handlers.render_post:
            bpy.app.handlers.render_post.remove(progress)
        bpy.data.scenes.remove(scene)
    sys.stdout.flush()
    if not os.path.isfile(path):
        raise Refused("The video could not be made: FFmpeg wrote no file.")
    return {**_read_back(path), "bytes": os.path.getsize(path), "seconds": time.perf_counter() - started}


def _add_strip(scene, arguments):
    """Adds one strip with all the pictures."""
    pictures = arguments["pictures"]
    editor = scene.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences  # the second before 4.4
    first = os.path.join(arguments["folder"], pictures[0])
    strip = strips.new_image(name="frames", filepath=first, channel=1, frame_start=1, fit_method="ORIGINAL")
    for name in pictures[1:]:
        strip.elements.append(name)


def _set_up(scene, arguments):
    scene.frame_start, scene.frame_end = 1, len(arguments["pictures"])
    render, image, film = scene.render, scene.render.image_settings, scene.render.ffmpeg
    render.resolution_x, render.resolution_y = arguments["width"], arguments["height"]
    render.resolution_percentage = 100
    render.fps, render.fps_base = arguments["fps"], arguments["fps_base"]
    render.use_file_extension, render.use_overwrite, render.use_placeholder = False, True, False
    render.filepath = escaped_path(arguments["path"])
    if hasattr(image, "media_type"):
        image.media_type = "VIDEO"
    image.file_format = "FFMPEG"
    image.color_mode = "RGB"
    film.format, film.codec, film.audio_codec = "MPEG4", "H264", "NONE"
    film.constant_rate_factor, film.ffmpeg_preset = "HIGH", "GOOD"
    film.gopsize = max(1, round(arguments["fps"] / arguments["fps_base"]))
    film.use_autosplit = False
    # Colour management is already in the pictures.
    view = scene.view_settings
    view.view_transform, view.look, view.exposure, view.gamma = "Standard", "None", 0.0, 1.0


def _read_back(path):
    try:
        clip = bpy.data.movieclips.load(path)
    except RuntimeError as error:
        raise Refused(f"The video was made, but cannot be read: {str(error).strip()[:300]}") from None
    try:
        width, height = clip.size
        return {"frames": clip.frame_duration, "width": width, "height": height, "fps": clip.fps}
    finally:
        bpy.data.movieclips.remove(clip)


class _Progress:
    """Reports the number of frames written."""

    def __init__(self, scene, total, report):
        self._scene, self._total, self._report = scene, total, report
        self._done = 0
        self._at = time.monotonic()

    def __call__(self, scene, *_rest):
        if getattr(scene, "name", None) != self._scene:
            return
        self._done += 1
        if time.monotonic() > self._at + 0.5:
            self._at = time.monotonic()
            self._report(self._done, self._total, f"{self._done} of {self._total} frames of the video")
