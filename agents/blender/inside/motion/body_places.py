# SPDX-License-Identifier: GPL-3.0-or-later
"""Where rigid bodies are while frames are stepped: enough for those that there is no room to tell more about."""

from mathutils import Vector

from .actors import round_to

_MOVED = 0.01  # metres
_MOVING = 0.02  # m/s, above which a body is not at rest
_NAMED = 6


class BodyPlaces:
    """The origins of ``objects``, at each frame that is added."""

    def __init__(self, objects, fps):
        self._objects, self._fps = objects, fps
        self._first, self._before, self._last = {}, {}, {}

    def add(self, graph):
        """Takes their places at a frame, the next after the one that was added."""
        self._before = self._last
        self._last = {
            obj.name: Vector(obj.evaluated_get(graph).matrix_world.translation) for obj in self._objects
        }
        self._first = self._first or self._last

    def summary(self):
        """How many they are, have ``moved``, and are ``moving`` at the last frame; None without any.

        Of both, a few names with how far (metres) or fast (m/s) these are, the most first.
        """
        if not self._last:
            return None
        way = {name: (place - self._first[name]).length for name, place in self._last.items()}
        speed = {name: (self._last[name] - place).length * self._fps for name, place in self._before.items()}
        return {
            "count": len(self._objects),
            "moved": _above(way, _MOVED),
            "moving": _above(speed, _MOVING),
        }


def _above(values, least):
    ranked = sorted((name for name in values if values[name] > least), key=lambda name: -values[name])
    return {"count": len(ranked), "most": [[name, round_to(values[name])] for name in ranked[:_NAMED]]}
