# SPDX-License-Identifier: GPL-3.0-or-later
"""Remembers which frames of unbaked simulations were simulated, so that none is simulated twice.

Blender keeps every frame that it steps through in the simulation's cache. It may be used again as long as nothing
changed that the simulation depends on.
"""

import bpy
from bpy.app.handlers import persistent

from ..blend.simulation_zones import objects_with_zones
from ..digests.fingerprint import simulation_inputs
from . import caches

_stepped = {}  # scene → _Steps


class _Steps:
    """Frames ``first`` to ``last`` of a scene, just stepped through in order."""

    def __init__(self, scene, first, last):
        self.first, self.last = first, last
        self.held = {
            cache.label: cache.frames
            for cache in waiting_caches(scene)
            if cache.frames >= _frames_of(cache, first, last)
        }
        self.inputs = simulation_inputs(scene)


def waiting_caches(scene):
    """The caches that are filled by stepping: those that are switched on and not baked.

    A fluid is simulated by stepping only if its cache is of type REPLAY.
    """
    return [
        cache
        for cache in caches.find_caches(scene)
        if cache.simulated
        and not (cache.baked and not cache.outdated)
        and (cache.domain is None or (not cache.baked and cache.domain.cache_type == "REPLAY"))
    ]


def note(scene, first, last):
    """Remembers that all frames from ``first`` to ``last`` were visited in order, after a restart."""
    if _check_counts not in bpy.app.handlers.frame_change_post:
        bpy.app.handlers.frame_change_post.append(_check_counts)
    _stepped[_key(scene)] = _Steps(scene, first, last)


def forget():
    """Forgets all frames: they are simulated again when they are needed."""
    _stepped.clear()


def last_held(scene):
    """The last frame up to which every unbaked cache still holds what was simulated; None if any does not."""
    steps = _valid_steps(scene)
    if steps is None or objects_with_zones(scene):
        return None
    return steps.last if all(_is_held(steps, cache) for cache in waiting_caches(scene)) else None


def held_caches(scene, chosen, first, last):
    """Those of the ``chosen`` caches that are not baked and hold the frames ``first`` to ``last`` as simulated."""
    steps = _valid_steps(scene)
    if steps is None or steps.first > first:
        return []
    return [
        cache
        for cache in chosen
        if not cache.baked
        and cache.range[0] == first
        and (steps.last >= last or steps.last >= cache.expected[1])
        and _is_held(steps, cache)
    ]


def restart(scene):
    """Makes unbaked simulations start again at their first frame, without what is left of earlier ones; those that
    still hold their frames go on with them."""
    steps = _valid_steps(scene)
    for cache in waiting_caches(scene):
        if steps is not None and _is_held(steps, cache):
            continue
        if cache.points is not None and not cache.baked:
            caches.restart(cache)
        elif cache.domain is not None and cache.frames:
            # Blender replays files of an older state of the scene; a change of type removes them.
            cache.domain.cache_type = "ALL"
            cache.domain.cache_type = "REPLAY"


def _key(scene):
    return getattr(scene, "session_uid", scene.name)


def _frames_of(cache, first, last):
    """How many frames a cache gets when frames ``first`` to ``last`` are stepped through."""
    start, end = cache.expected
    step = 1 if cache.points is None else max(1, cache.points.frame_step)
    return max(0, (min(end, last) - max(start, first)) // step + 1)


def _is_held(steps, cache):
    fresh = cache.points is None or not cache.points.is_outdated
    return fresh and cache.label in steps.held and cache.frames >= steps.held[cache.label]


def _valid_steps(scene):
    steps = _stepped.get(_key(scene))
    return steps if steps is not None and steps.inputs == simulation_inputs(scene) else None


@persistent
def _check_counts(scene, _graph=None):
    """Forgets a scene's frames as soon as Blender has dropped some: what it simulates then may be something else."""
    steps = _stepped.get(_key(scene))
    if steps is None:
        return
    for cache in caches.find_caches(scene):
        held = steps.held.get(cache.label)
        if held is not None and cache.points is not None and cache.frames < held:
            if (
                cache.kind == caches.DYNAMIC_PAINT
            ):  # Blender drops its frames at the first one, whatever has changed
                del steps.held[cache.label]
                continue
            del _stepped[_key(scene)]
            return
