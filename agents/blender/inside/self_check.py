# SPDX-License-Identifier: GPL-3.0-or-later
"""Tries out what works in this Blender. Most checks replace the open file."""

import os
import socket
import subprocess
import time

import bpy

from .render.engines import WORKBENCH, best_engine

_PIXELS = 64
_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader", "software")


def try_escapes(arguments, report):
    """Which of these the sandbox fails to prevent: ``read``, ``write``, ``network``, ``process``, ``secret``.

    ``file`` and ``folder`` are outside what may be read and written; ``variable`` is an environment variable.
    """
    del report
    return {
        "read": _works(lambda: open(arguments["file"]).close()),
        "write": _works(lambda: open(os.path.join(arguments["folder"], "written"), "w").close()),
        "network": _works(lambda: socket.socket(socket.AF_INET).close()),
        "process": _works(lambda: subprocess.run(["true"], check=False)),
        "secret": arguments["variable"] in os.environ,
    }


def _works(act):
    try:
        act()
    except OSError:
        return False
    return True


def workbench(arguments, report):
    """Draws a cube. Returns ``fault`` ("" if Workbench can draw), ``seconds``, ``renderer`` (the GPU's name, if known)
    and whether that is ``software``."""
    del arguments
    report(0, None, "drawing with Workbench")
    engine, fault = best_engine()
    if engine != WORKBENCH:
        return {"fault": fault, "seconds": 0.0, "renderer": "", "software": False}
    scene = _scene()
    scene.render.engine = WORKBENCH
    seconds, shades = _rendered(scene)
    renderer = _renderer()
    return {
        "fault": "" if shades > 1 else "the rendered picture is empty",
        "seconds": seconds,
        "renderer": renderer,
        "software": any(word in renderer.lower() for word in _SOFTWARE),
    }


def cycles(arguments, report):
    """Renders a cube on the processor. Returns ``fault``, ``seconds`` and ``devices``: {type: names of GPUs}."""
    del arguments
    report(0, None, "rendering with Cycles")
    scene = _scene()
    try:
        scene.render.engine = "CYCLES"
    except TypeError:
        return {"fault": "this Blender was built without Cycles", "seconds": 0.0, "devices": {}}
    scene.cycles.samples, scene.cycles.device, scene.cycles.use_denoising = 1, "CPU", False
    seconds, shades = _rendered(scene)
    return {
        "fault": "" if shades > 1 else "the rendered picture is empty",
        "seconds": seconds,
        "devices": _devices(),
    }


def video(arguments, report):
    """Returns ``supported``: whether video can be written, and the ``version`` of the codec library."""
    del arguments, report
    written = bpy.app.ffmpeg
    return {"supported": bool(written.supported), "version": ".".join(map(str, written.avcodec_version))}


def _scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_cube_add(rotation=(0.5, 0.5, 0))
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.camera.location.z = 6
    lamp = bpy.data.objects.new("Light", bpy.data.lights.new("Light", "SUN"))
    for obj in (scene.camera, lamp):
        scene.collection.objects.link(obj)
    scene.render.resolution_x = scene.render.resolution_y = _PIXELS
    scene.render.resolution_percentage = 100
    return scene


def _rendered(scene):
    """(seconds, number of different shades of green in the picture)."""
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = os.path.join(bpy.app.tempdir, "checkup.png")
    started = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    seconds = time.perf_counter() - started
    image = bpy.data.images.load(scene.render.filepath)
    shades = len({round(value, 2) for value in list(image.pixels)[1::4]})
    os.unlink(scene.render.filepath)
    return seconds, shades


def _renderer():
    try:
        import gpu

        return str(gpu.platform.renderer_get())
    except (ImportError, SystemError):  # no GPU context for Python
        return ""


def _devices():
    addon = bpy.context.preferences.addons.get("cycles")
    names_by_type = {}
    for kind in ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI"):
        try:
            devices = addon.preferences.get_devices_for_type(kind)
        except (AttributeError, ValueError, TypeError):
            continue
        names = [device.name for device in devices or () if device.type == kind]
        if names:
            names_by_type[kind] = names
    return names_by_type
