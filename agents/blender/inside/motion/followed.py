# SPDX-License-Identifier: GPL-3.0-or-later
"""What a trial follows frame by frame: actors, of which some are told of in full, and bodies by their places alone."""

from mathutils import Vector

from .actors import round_to
from .fallen_particles import watches
from .trajectories import Track

_TOLD = 12  # actors that are told of in full
_MOVED = 0.01  # metres
_MOVING = 0.02  # m/s, above which a body is not at rest
_NAMED = 6


class Followed:
    """``tracks`` of ``actors``, and places of ``bodies`` (objects): enough for those that there is no room to tell of.

    ``first``: names of actors that are told of before others. ``own``: the caches that move them all.
    """

    def __init__(self, scene, actors, bodies, first, own):
        fps = scene.render.fps / scene.render.fps_base
        self.tracks = [Track(actor, fps) for actor in actors]
        self._bodies = _BodyPlaces(bodies, fps)
        self._named = [track for track in self.tracks if track.actor.name in first]
        self._is_many = len(actors) + len(bodies) > _TOLD
        self._watches = watches(scene, own)

    def add(self, frame, graph):
        """Measures everything at a frame, the next after the one that was added."""
        for track in self.tracks:
            track.add(frame, track.actor.state_at(graph))
        self._bodies.add(graph)
        for watch in self._watches:
            watch.add(frame, graph)

    def told(self):
        """The tracks that are told of in full: of many those that are named first, then those that have moved most."""
        if not self._is_many:
            return self.tracks
        moved = [track for track in self.tracks if track not in self._named and track.path > _MOVED]
        return [*self._named, *sorted(moved, key=lambda track: -round(track.path, 2))][:_TOLD]

    def shown(self):
        """The tracks that are measured in full and drawn: those that are told of, or a few before anything moves."""
        return self.told() or self.tracks[:_TOLD]

    def fallen(self):
        """Sentences about particles that have gone through what is to hold them."""
        return [fault for watch in self._watches if (fault := watch.fault())]

    def others(self):
        """What is not told of in full, as data; None without any.

        How many that are, have ``moved`` and are ``moving`` at the last frame; of both, a few names with how far
        (metres) or fast (m/s) these are, the most first.
        """
        ways, speeds, told = self._bodies.ways(), self._bodies.speeds(), self.told()
        for track in self.tracks:
            if track not in told and track.centres:
                ways[track.actor.name] = track.displacements()[-1] or 0.0
                speeds[track.actor.name] = track.main_speeds[-1] or 0.0
        if not ways:
            return None
        return {"count": len(ways), "moved": _above(ways, _MOVED), "moving": _above(speeds, _MOVING)}


class _BodyPlaces:
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

    def ways(self):
        """How far each is from where it was first, in metres, by name."""
        return {name: (place - self._first[name]).length for name, place in self._last.items()}

    def speeds(self):
        """How fast each is at the last frame, in m/s, by name."""
        return {name: (self._last[name] - place).length * self._fps for name, place in self._before.items()}


def _above(values, least):
    ranked = sorted((name for name in values if values[name] > least), key=lambda name: -values[name])
    return {"count": len(ranked), "most": [[name, round_to(values[name])] for name in ranked[:_NAMED]]}
