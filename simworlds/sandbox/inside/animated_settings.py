# SPDX-License-Identifier: GPL-3.0-or-later
"""The extreme values that keyframes give to settings, read from the curves themselves; nothing is evaluated.

Drivers are not followed: a driven setting counts as it was saved.
"""

import math

import bpy
import numpy

_SAMPLES = 64  # of a curve that modifiers change


class AnimatedSettings:
    """Looks settings up by their path, whichever action animates it: too much is better than too little here."""

    def __init__(self, scene):
        self._frames = numpy.linspace(scene.frame_start, scene.frame_end, _SAMPLES).tolist()
        self._bounds = {}
        for action in bpy.data.actions:
            for curve in _curves(action):
                low, high = self._extremes(curve)
                before = self._bounds.get(curve.data_path, (low, high))
                self._bounds[curve.data_path] = min(low, before[0]), max(high, before[1])

    def highest(self, owner, name):
        """The largest value of a number or flag during the clip."""
        bounds = self._of(owner, name)
        value = getattr(owner, name)
        return value if bounds is None else max(value, type(value)(min(bounds[1], 2**53)))

    def highest_at(self, path, value):
        """The larger of ``value`` and what keyframes give to the setting at ``path``; None stays None."""
        bounds = self._bounds.get(path)
        return value if bounds is None or value is None else max(value, bounds[1])

    def lowest(self, owner, name):
        """The smallest one."""
        bounds = self._of(owner, name)
        value = getattr(owner, name)
        return value if bounds is None else min(value, type(value)(max(bounds[0], -(2**53))))

    def _of(self, owner, name):
        if not self._bounds:
            return None
        path = name if isinstance(owner, bpy.types.ID) else owner.path_from_id(name)
        return self._bounds.get(path)

    def _extremes(self, curve):
        values = [
            curve.evaluate(frame)
            for frame in (self._frames if curve.modifiers else self._frames[:: _SAMPLES - 1])
        ]
        if count := len(curve.keyframe_points):
            # A curve stays between its keyframes and their handles.
            for name in ("co", "handle_left", "handle_right"):
                flat = numpy.empty(2 * count, dtype=numpy.float32)
                curve.keyframe_points.foreach_get(name, flat)
                values += [float(flat[1::2].min()), float(flat[1::2].max())]
        values = [value for value in values if not math.isnan(value)]
        return min(values, default=0.0), max(values, default=0.0)


def _curves(action):
    if hasattr(action, "layers"):
        for layer in action.layers:
            for strip in layer.strips:
                for bag in strip.channelbags:
                    yield from bag.fcurves
    else:  # before Blender 4.4
        yield from action.fcurves
