# SPDX-License-Identifier: GPL-3.0-or-later
"""What to render, from the request and the scene's own settings; and the Blender settings for it."""

import os
import sys

import bpy

from simworlds.sandbox.inside.refusal import Refused

from .engines import CYCLES, WORKBENCH, best_engine

_ENGINES = {
    "cycles": (CYCLES,),
    "eevee": ("BLENDER_EEVEE", "BLENDER_EEVEE_NEXT"),  # the second in 4.2 to 4.5
    "workbench": (WORKBENCH,),
}
_OPENGL_ENGINES = (*_ENGINES["eevee"], WORKBENCH)
_QUICK_SAMPLES = 32  # of Cycles, used instead of EEVEE without a GPU
_MOST_ON_CPU = 128  # samples, unless the request says more
_SMOOTHING = {"OFF": 1, "FXAA": 1, "5": 5, "8": 8, "11": 11, "16": 16, "32": 32}  # Workbench's, in samples
_GPUS = ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI")
_NAMED = 20


def shot_of(scene, wanted, notes):
    """The shot: engine, device, samples and denoise (None: the engine has none), width, height, camera, bound."""
    engine, quick = _engine(scene, wanted["engine"], notes)
    device = _device(engine)
    samples, own = wanted["samples"], _samples_of(scene, engine)
    if own is None:
        if samples is not None:
            notes.append(f"{engine} has no samples setting.")
        samples = None
    elif samples is None:
        samples = _QUICK_SAMPLES if quick else own
        if device == "CPU" and samples > _MOST_ON_CPU:
            notes.append(
                f"{_MOST_ON_CPU} samples, not the scene's {own}, as there is no GPU. To override, pass samples={own}."
            )
            samples = _MOST_ON_CPU
    denoise = None
    if engine == CYCLES:
        denoise = wanted["denoise"] if wanted["denoise"] is not None else quick or scene.cycles.use_denoising
    elif wanted["denoise"]:
        notes.append(f"{engine} has no denoiser: only Cycles has one.")
    if engine == WORKBENCH and scene.display.shading.color_type == "MATERIAL":
        notes.append("Workbench shows materials' viewport colours (diffuse_color), not their nodes.")
    width, height = _size(scene, wanted, notes)
    return {
        "engine": engine,
        "device": device,
        "samples": samples,
        "denoise": denoise,
        "width": width,
        "height": height,
        "camera": _camera(scene, wanted["camera"], notes),
        "bound": wanted["camera"] is None,  # use the cameras that are bound to timeline markers
    }


def _engine(scene, wanted, notes):
    """(identifier, whether it replaces the scene's engine)."""
    listed = {item.identifier for item in scene.render.bl_rna.properties["engine"].enum_items}
    if wanted is not None:
        engine = next(
            (identifier for identifier in _ENGINES[wanted] if identifier in listed), _ENGINES[wanted][0]
        )
        if engine in _OPENGL_ENGINES and (fault := best_engine()[1]):
            raise Refused(f"{wanted} cannot draw here: {fault}. Pass engine='cycles'.")
        if engine in _ENGINES["eevee"] and not _has_gpu():
            notes.append("EEVEE runs without a GPU here: the first frame takes long.")
        return engine, False
    engine, why = scene.render.engine, ""
    if engine in _OPENGL_ENGINES:
        why = best_engine()[1]
        if not why and engine in _ENGINES["eevee"] and not _has_gpu():
            why = "it is slow without a GPU; to use it anyway, pass engine='eevee'"
    if not why:
        return engine, False
    name = "EEVEE" if engine in _ENGINES["eevee"] else "Workbench"
    notes.append(f"Cycles instead of the scene's {name}: {why}.")
    return CYCLES, True


def _has_gpu():
    """Whether there seems to be a GPU, not only a software renderer."""
    if sys.platform in {"darwin", "win32"}:
        return True
    return any(os.path.exists(f"/dev/{name}") for name in ("nvidia0", "kfd", "dri/renderD128"))


def _device(engine):
    """GPU or CPU; Cycles uses a GPU if there is one."""
    if engine != CYCLES:
        return "GPU" if _has_gpu() else "CPU"
    addon = bpy.context.preferences.addons.get("cycles")
    if addon is None:
        return "CPU"
    settings = addon.preferences
    for kind in _GPUS:
        try:
            listed = settings.get_devices_for_type(kind)
        except (ValueError, TypeError, AttributeError):
            continue
        devices = [device for device in listed if device.type == kind]
        if devices:
            settings.compute_device_type = kind
            for device in settings.devices:
                device.use = device.type == kind
            return "GPU"
    return "CPU"


def _samples_of(scene, engine):
    if engine == CYCLES:
        return scene.cycles.samples
    if engine == WORKBENCH:
        return _SMOOTHING.get(scene.display.render_aa, 1)
    if engine in _ENGINES["eevee"]:
        return scene.eevee.taa_render_samples
    return None


def _size(scene, wanted, notes):
    render = scene.render
    full = (render.resolution_x, render.resolution_y)
    width, height = wanted["width"], wanted["height"]
    if width and not height:
        height = width * full[1] / full[0]
    elif height and not width:
        width = height * full[0] / full[1]
    elif not width:
        share = (wanted["percentage"] or render.resolution_percentage) / 100
        width, height = full[0] * share, full[1] * share
    size = [max(4, round(side)) for side in (width, height)]
    if wanted["even"]:
        even = [side - side % 2 for side in size]
        if even != size:
            notes.append(f"{even[0]}×{even[1]} instead of {size[0]}×{size[1]}: video needs even sizes.")
        size = even
    return size


def _camera(scene, name, notes):
    cameras = sorted(obj.name for obj in scene.objects if obj.type == "CAMERA")
    listed = ", ".join(repr(camera) for camera in cameras[:_NAMED]) + (" …" if len(cameras) > _NAMED else "")
    if name is not None:
        obj = scene.objects.get(name)
        if obj is None or obj.type != "CAMERA":
            what = f"{name!r} is not a camera" if obj else f"The scene has no camera {name!r}"
            raise Refused(f"{what}. Its cameras: {listed or 'none'}.")
        return name
    if scene.camera is not None:
        return scene.camera.name
    if len(cameras) == 1:
        notes.append(f"Rendered through {cameras[0]!r}, the only camera; scene.camera is not set.")
        return cameras[0]
    if cameras:
        raise Refused(f"The scene has cameras, but scene.camera is not set: pass camera= one of {listed}.")
    raise Refused(
        "The scene has no camera. Add one with blender_execute, for example:\n"
        "from mathutils import Vector\n"
        "camera = bpy.data.objects.new('Camera', bpy.data.cameras.new('Camera'))\n"
        "bpy.context.scene.collection.objects.link(camera)\n"
        "camera.location = (7, -7, 5)\n"
        "camera.rotation_euler = (Vector((0, 0, 1)) - camera.location).to_track_quat('-Z', 'Y').to_euler()\n"
        "bpy.context.scene.camera = camera"
    )


def settings_for(scene, shot, samples, path):
    """Yields (owner, name, value) of every setting that the picture needs."""
    render = scene.render
    image = render.image_settings
    transparent = render.film_transparent
    if not shot["bound"]:
        for marker in scene.timeline_markers:
            yield marker, "camera", None
    # After the markers, which change the scene's camera.
    yield scene, "camera", scene.objects.get(shot["camera"]) or scene.camera
    for name, value in (
        ("engine", shot["engine"]),
        ("resolution_x", shot["width"]),
        ("resolution_y", shot["height"]),
        ("resolution_percentage", 100),
        ("use_sequencer", False),
        ("use_multiview", False),
        ("use_file_extension", False),
        ("use_overwrite", True),
        ("use_placeholder", False),
        ("filepath", escaped_path(path)),
    ):
        yield render, name, value
    # Each of these limits the next: they are set, and restored, in this order.
    for name, value in (
        ("media_type", "IMAGE"),
        ("file_format", "PNG"),
        ("color_mode", "RGBA" if transparent else "RGB"),
        ("color_depth", "8"),
        ("compression", 15),
        ("color_management", "FOLLOW_SCENE"),
    ):
        if hasattr(image, name):
            yield image, name, value
    if shot["engine"] == CYCLES:
        yield scene.cycles, "device", shot["device"]
        yield scene.cycles, "use_denoising", shot["denoise"]
        if _denoises_slowly(scene, shot):
            yield scene.cycles, "denoising_quality", "BALANCED"
            yield scene.cycles, "denoising_prefilter", "FAST"
    if samples is not None and samples != _samples_of(scene, shot["engine"]):
        yield _samples_setting(scene, shot["engine"], samples)


def _denoises_slowly(scene, shot):
    """Whether a processor denoises by Blender's default: as slow as all else of a small frame, for no visible gain."""
    quality = getattr(scene.cycles, "denoising_quality", None)  # none before 4.2
    return shot["denoise"] and shot["device"] == "CPU" and quality == "HIGH"


def _samples_setting(scene, engine, samples):
    if engine == CYCLES:
        return scene.cycles, "samples", samples
    if engine == WORKBENCH:
        fitting = [name for name, count in _SMOOTHING.items() if count <= max(samples, 1)]
        return scene.display, "render_aa", fitting[-1]
    return scene.eevee, "taa_render_samples", samples


def escaped_path(path):
    """A path escaped for an output setting: since 5.0, braces in it are variables."""
    return path.replace("{", "{{").replace("}", "}}") if bpy.app.version >= (5, 0, 0) else path
