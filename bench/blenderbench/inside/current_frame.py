# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the current frame of the open scene by Cycles, through its camera."""

import os

import bpy

from simworlds.sandbox.inside.refusal import Refused

from .playback import play_to_current_frame

_GPUS = ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI")
_IMAGE = {
    "media_type": "IMAGE",  # since Blender 5.0
    "file_format": "PNG",
    "color_depth": "8",
    "compression": 15,
    "color_management": "FOLLOW_SCENE",
}


def render(path, width, height, samples):
    """Renders to ``path``, a PNG. Returns ``camera`` (its name) and ``device`` (CPU, or GPU where there is one)."""
    scene = bpy.context.scene
    _set_camera(scene)
    device = _device()
    _set_output(scene, path, width, height)
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = device, samples
    play_to_current_frame(scene, os.path.dirname(path))
    try:
        bpy.ops.render.render(write_still=True)
    except RuntimeError as error:
        raise Refused(f"Blender cannot render this: {str(error).strip()[:600]}") from None
    if not os.path.isfile(path):
        raise Refused("Cycles wrote no picture")
    return {"camera": scene.camera.name, "device": device}


def _set_camera(scene):
    """The only camera is taken where the scene has not chosen one. Raises Refused."""
    cameras = [obj for obj in scene.objects if obj.type == "CAMERA"]
    if scene.camera is None and len(cameras) == 1:
        scene.camera = cameras[0]
    if scene.camera is None:
        raise Refused("scene.camera is not set" if cameras else "the scene has no camera")


def _set_output(scene, path, width, height):
    settings = scene.render
    settings.resolution_x, settings.resolution_y, settings.resolution_percentage = width, height, 100
    settings.use_sequencer = settings.use_multiview = settings.use_file_extension = False
    settings.use_overwrite, settings.use_placeholder = True, False
    # Since 5.0, braces in an output path are variables.
    settings.filepath = path.replace("{", "{{").replace("}", "}}") if bpy.app.version >= (5, 0, 0) else path
    for name, value in _IMAGE.items():
        if hasattr(settings.image_settings, name):
            setattr(settings.image_settings, name, value)
    settings.image_settings.color_mode = "RGBA" if settings.film_transparent else "RGB"


def _device():
    """GPU if Cycles can render on one, which is then switched on; else CPU."""
    addon = bpy.context.preferences.addons.get("cycles")
    for kind in _GPUS if addon is not None else ():
        try:
            devices = addon.preferences.get_devices_for_type(kind)
        except (ValueError, TypeError, AttributeError):
            continue
        if any(device.type == kind for device in devices):
            addon.preferences.compute_device_type = kind
            for device in addon.preferences.devices:
                device.use = device.type == kind
            return "GPU"
    return "CPU"
