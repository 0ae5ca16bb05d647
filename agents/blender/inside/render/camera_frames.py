# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the view of the scene's camera, a frame for each call, and restores the scene's settings after it."""

import contextlib
import os
import re
import sys
import threading
import time

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.simulation_zones import objects_with_zones
from ..blend.temporary import temporary_settings, without_render_result
from ..digests.fingerprint import fingerprint
from ..digests.still_digest import still_digest
from ..physics import caches
from .shot_settings import settings_for, shot_of

_STILL_FRAME = 1  # the frame at which scenes are compared
_BACK_SECONDS = 20.0  # for stepping back to the frame before
_DENOISER = "Build without OpenImageDenoiser"  # as Cycles says it
_SAMPLE = re.compile(r"Sample (\d+)/(\d+)")
_REMAINING = re.compile(r"Remaining:\s*([\d:.]+)")


def plan(arguments, report):
    """Chooses what to render and how, from the request and the scene; renders nothing.

    Returns ``shot`` (see shot_of), ``scene`` (see fingerprint), ``unbaked`` (caches.unbaked and simulation zones),
    ``notes``, and the timeline: ``current``, ``subframe``, ``frame_start``, ``frame_end``, ``fps``, ``fps_base``; with
    ``keep`` also ``looks`` (see still_digest) of a still at ``frame`` (None: the current one). If a simulation is not
    baked, it is made to start again, and the scene stays at frame 1.
    """
    del report
    scene = bpy.context.scene
    notes = []
    shot = shot_of(scene, arguments, notes)
    current, subframe = scene.frame_current, scene.frame_subframe
    unbaked = [*caches.unbaked(scene), *_zones(scene)]
    with temporary_settings(settings_for(scene, shot, shot["samples"], "")):
        scene.frame_set(_STILL_FRAME)
        digests = fingerprint(scene)
        frame = current if arguments["frame"] is None else arguments["frame"]
        looks = still_digest(scene, frame, digests) if arguments["keep"] else ""
    if unbaked:
        caches.restart_unbaked(scene)
    else:
        scene.frame_set(current, subframe=subframe)
    render = scene.render
    return {
        "shot": shot,
        "scene": digests,
        "looks": looks,
        "unbaked": unbaked,
        "notes": notes,
        "current": current,
        "subframe": subframe,
        "frame_start": scene.frame_start,
        "frame_end": scene.frame_end,
        "fps": render.fps,
        "fps_base": render.fps_base,
    }


def step(arguments, report):
    """Steps through the frames ``first`` to ``last`` for at most ``seconds``; returns the last frame reached."""
    scene = bpy.context.scene
    first, last = arguments["first"], arguments["last"]
    deadline = time.monotonic() + arguments["seconds"]
    for frame in range(first, last + 1):
        scene.frame_set(frame)
        report(frame - first, last - first, f"simulated up to {frame}")
        if time.monotonic() > deadline:
            return frame
    return last


def render_frame(arguments, report):
    """Renders ``frame`` of ``shot`` with ``samples`` into ``path`` (PNG). Returns the seconds it took.

    The scene stays at that frame, so that the next one can go on from there.
    """
    scene = bpy.context.scene
    shot, path = arguments["shot"], arguments["path"]
    started = time.perf_counter()
    try:
        settings = temporary_settings(settings_for(scene, shot, arguments["samples"], path))
        with without_render_result(), settings, _ProgressReports(report):
            scene.frame_set(arguments["frame"])
            bpy.ops.render.render(write_still=True, scene=scene.name)
    except RuntimeError as error:
        message = str(error).strip()[:600]
        if _DENOISER in message:
            message = f"{message}. This Blender was built without a denoiser: pass denoise=false"
        raise Refused(f"Blender could not render this: {message}") from None
    sys.stdout.flush()
    if not os.path.isfile(path):
        raise Refused(f"{shot['engine']} wrote no picture.")
    return time.perf_counter() - started


def put_back(arguments, report):
    """Takes the scene back to ``frame`` and ``subframe``, in steps from ``first`` unless that is None or takes long."""
    frame, first = arguments["frame"], arguments["first"]
    if first is not None and first < frame:
        step({"first": first, "last": frame - 1, "seconds": _BACK_SECONDS}, report)
    bpy.context.scene.frame_set(frame, subframe=arguments["subframe"])


def _zones(scene):
    """Objects with simulation zones in their geometry nodes. Whether these are baked, no property tells."""
    return [
        {
            "kind": "simulation_zone",
            "object": obj.name,
            "label": f"simulation zone of {obj.name!r} (if it is not baked)",
            "start": scene.frame_start,
        }
        for obj in objects_with_zones(scene)
    ]


class _ProgressReports:
    """Reports the engine's progress with a frame, as a share. Engines call it from their own threads."""

    def __init__(self, report):
        self._report = report
        self._lock = threading.Lock()
        self._reported = time.monotonic()
        self._share = 0.0

    def __enter__(self):
        bpy.app.handlers.render_stats.append(self._note)

    def __exit__(self, *error):
        with contextlib.suppress(ValueError):
            bpy.app.handlers.render_stats.remove(self._note)

    def _note(self, stats, *_rest):
        if not isinstance(stats, str) or not (sample := _SAMPLE.search(stats)):
            return
        with self._lock:
            share = int(sample[1]) / max(1, int(sample[2]))
            if share <= self._share or time.monotonic() < self._reported + 0.5:
                return
            self._share, self._reported = share, time.monotonic()
            left = _REMAINING.search(stats)
            self._report(
                share, 1.0, f"sample {sample[1]} of {sample[2]}" + (f", {left[1]} left" if left else "")
            )
