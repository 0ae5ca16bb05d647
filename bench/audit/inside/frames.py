# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders frames of the open file as its camera sees them. The file is not saved, and nothing is left on disk.

Baked physics plays from its cache. Unbaked physics is simulated from the first frame on, as in a render of the whole
clip (a fluid writes to a folder of this process); with ``jump`` it is switched off instead.
"""

import base64
import math
import os

import bpy
from mathutils import Vector

from simworlds.sandbox.inside.refusal import Refused
from simworlds.sandbox.inside.scene_estimate import check_scene

from . import sample_frames, solvers
from .json_values import called

_AROUND, _ABOVE = 0.6, 0.45  # radians: the added camera looks from the front, right and above
_LOOSE = 1.1  # times the least distance at which everything fits
_SETTING = 4.0  # times as large as all the rest: ground or sky, which need not fit in the picture
_LONGEST_SIDE = 4  # times the shorter one
_MOST_FRAMES = 5000  # that are stepped through
_UNSEEN = {"CAMERA", "LIGHT", "SPEAKER", "LIGHT_PROBE", "ARMATURE", "LATTICE"}
_PICTURE = {"file_format": "PNG", "color_mode": "RGB", "color_depth": "8", "compression": 15}


def render(shares, pixels, samples, jump=False, report=lambda *_: None):
    """Renders the frames at ``shares`` (0 to 1) of the clip by Cycles, with about ``pixels`` pixels and ``samples``.

    Returns ``frames``: for each its number and ``png`` (base64); ``camera``: its name, None if one was added;
    ``unbaked``: physics without a bake, in words. ``report`` is told of each frame before it is rendered. Raises
    Refused.
    """
    scene = bpy.context.scene
    check_scene(scene, render=True)
    facts_by_object = {obj: {"modifiers": solvers.modifiers_of(obj)} for obj in scene.objects}
    solvers.take_moved_caches(facts_by_object)
    unbaked = sample_frames.unbaked_of(scene, facts_by_object)
    first, last = scene.frame_start, scene.frame_end
    wanted = [first + round(share * (last - first)) for share in shares]
    if jump:
        _switch_off(scene, unbaked)
    _keep_fluids_here(scene)
    _settle(scene, pixels, samples)
    scene.frame_set(first)
    camera = called(scene.camera)
    if scene.camera is None or scene.camera.type != "CAMERA":
        camera, scene.camera = None, _camera(scene)
    steps = range(first, last + 1) if unbaked and not jump else sorted(set(wanted))
    if len(steps) > _MOST_FRAMES:
        raise Refused(f"{len(steps):,} frames would have to be simulated; the most is {_MOST_FRAMES:,}")
    pictures = {}
    for frame in steps:
        scene.frame_set(frame)
        if frame in wanted:
            report(len(pictures), len(set(wanted)))
            pictures[frame] = _picture(scene)
    labels = sorted(each.label for each in unbaked)
    return {
        "frames": [{"frame": frame, "png": pictures[frame]} for frame in wanted],
        "camera": camera,
        "unbaked": labels[:4],
    }


def _switch_off(scene, unbaked):
    """Switches unbaked physics off, in the render too."""
    modifiers = [modifier for obj in scene.objects for modifier in obj.modifiers if modifier.show_viewport]
    for each in unbaked:
        each.switch_off()
    for modifier in modifiers:
        modifier.show_render = modifier.show_render and modifier.show_viewport


def _keep_fluids_here(scene):
    """Makes fluids that are simulated during playback write to a folder of this process."""
    for obj in scene.objects:
        for modifier in obj.modifiers:
            if modifier.type != "FLUID" or modifier.fluid_type != "DOMAIN" or not modifier.show_viewport:
                continue
            domain = modifier.domain_settings
            if domain.cache_type == "REPLAY" and not domain.has_cache_baked_data:
                domain.cache_directory = os.path.join(os.getcwd(), f"fluid-{len(os.listdir())}")


def _settle(scene, pixels, samples):
    """Sets up the render: only the camera's view, without sequencer strips, border or stereo."""
    render, shape = scene.render, scene.render.resolution_x / max(1, scene.render.resolution_y)
    shape = min(_LONGEST_SIDE, max(1 / _LONGEST_SIDE, shape))
    render.resolution_x = max(4, round((pixels * shape) ** 0.5))
    render.resolution_y = max(4, round((pixels / shape) ** 0.5))
    render.resolution_percentage = 100
    render.use_border = render.use_multiview = render.use_sequencer = render.use_stamp = False
    render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", samples, 0
    cycles.use_animated_seed = cycles.use_adaptive_sampling = False
    cycles.time_limit = 0
    cycles.use_denoising = bool(getattr(bpy.app.build_options, "openimagedenoise", True))
    settings = render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    for name, value in _PICTURE.items():
        setattr(settings, name, value)
    render.use_file_extension = True
    render.filepath = os.path.join(os.getcwd(), "frame.png")


def _picture(scene):
    """The PNG of the current frame (base64); without compositing if that fails, as when a file of it is missing."""
    path = scene.render.filepath
    for composited in dict.fromkeys((scene.render.use_compositing, False)):
        scene.render.use_compositing = composited
        try:
            bpy.ops.render.render(write_still=True)
            with open(path, "rb") as file:
                content = file.read()
            os.unlink(path)
            return base64.b64encode(content).decode("ascii")
        except (RuntimeError, OSError) as error:
            why = error
    raise Refused(f"frame {scene.frame_current} could not be rendered: {why}")


# Where the file has no camera


def _camera(scene):
    camera = bpy.data.objects.new("Camera of the benchmark", bpy.data.cameras.new("Camera of the benchmark"))
    scene.collection.objects.link(camera)
    camera.rotation_euler = (math.pi / 2 - _ABOVE, 0.0, _AROUND)
    graph = bpy.context.evaluated_depsgraph_get()
    points = _framed(scene, graph)
    if points:
        camera.location, _ = camera.camera_fit_coords(graph, [value for point in points for value in point])
        centre = sum(points, Vector()) / len(points)
        camera.location = centre + _LOOSE * (camera.location - centre)
        away = (camera.location - centre).length
        camera.data.clip_start, camera.data.clip_end = max(away / 1e4, 1e-4), max(100.0, away * 1e3)
    return camera


def _framed(scene, graph):
    """The corners of all rendered objects, except ground and sky."""
    boxes = []
    for obj in scene.objects:
        evaluated = obj.evaluated_get(graph)
        if obj.hide_render or obj.type in _UNSEEN or not any(evaluated.dimensions):
            continue
        boxes.append([evaluated.matrix_world @ Vector(corner) for corner in evaluated.bound_box])
    boxes.sort(key=_extent)
    while len(boxes) > 1:
        smaller = [corner for box in boxes[:-1] for corner in box]
        if _extent(boxes[-1]) <= _SETTING * _extent(smaller):
            break
        boxes.pop()
    return [corner for box in boxes for corner in box]


def _extent(points):
    """The diagonal of the bounds of points."""
    low, high = (Vector([pick(point[axis] for point in points) for axis in range(3)]) for pick in (min, max))
    return (high - low).length
