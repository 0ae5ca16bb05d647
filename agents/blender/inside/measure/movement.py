# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows how objects move (see agents.protocol.measures.motion, and following). Metres, radians."""

import itertools
import math

import bpy
import numpy
from mathutils import Matrix, Vector

from ..geometry.solids import Unmeasurable
from ..motion.actors import Actor
from ..motion.contacts import surface_distance
from ..motion.trajectories import Track, best_rotation

_POINTS = 1000  # of an actor that are followed
_NEAREST = 0.1  # share of an actor's points, those nearest to the other one, that are compared
_FEWEST = 12
_MOST_PAIRS = 400  # of meshes whose distances are measured
_BESIDE = 0.005  # meshes that are farther than the nearest by no more than this count as well
_FAR = 1e4


def actor_of(names):
    """The named objects as one actor. Raises Unmeasurable."""
    objects = []
    for name in names:
        obj = bpy.context.view_layer.objects.get(name)
        if obj is None:
            raise Unmeasurable(f"there is no object {name!r} in the view layer")
        objects.append(obj)
    if not objects:
        raise Unmeasurable("no object was named")
    return Actor(", ".join(names), "objects", objects, _POINTS)


def check_evaluated(actor, graph):
    """Raises Unmeasurable for an object that is disabled in the viewport: nothing moves it there."""
    for obj in actor.objects:
        if not obj.evaluated_get(graph).is_evaluated:
            raise Unmeasurable(f"{obj.name!r} is disabled in the viewport, so nothing moves it")


class PathFollower:
    """Follows where an actor is at every frame."""

    def __init__(self, request):
        self.start, self.end = request["start"], request["end"]
        scene = bpy.context.scene
        self._actor = actor_of(request["names"])
        self._track = Track(self._actor, scene.render.fps / scene.render.fps_base)
        self._marks = set(request["marks"])
        self._mark = None
        self._origins, self._ways, self._reaches = [], [], []
        self._centre = None
        self._size = 0.0

    def look(self, frame, graph, tracker):
        """Measures a frame."""
        del tracker
        check_evaluated(self._actor, graph)
        state = self._actor.state_at(graph)
        self._track.add(frame, state)
        self._origins.append(state and self._origin(graph))
        self._ways.append(_mean_distance(self._mark, state))
        if self._centre is None and state is not None:
            self._centre = state.centre
        self._reaches.append(_reach(state, self._centre))
        if state is not None and not self._size:
            self._size = max(state.high - state.low)
        if frame in self._marks:
            self._mark = state
            self._centre = state and state.centre

    def _origin(self, graph):
        places = [obj.evaluated_get(graph).matrix_world.translation for obj in self._actor.objects]
        return sum(places, Vector()) / len(places)

    def result(self):
        """The result as data."""
        track = self._track
        speeds = [
            own if own is not None else other
            for own, other in zip(track.point_speeds, track.speeds, strict=True)
        ]
        return {
            "start": self.start,
            "measured": self._actor.measured,
            "deforms": track.deforms,
            "size": self._size,
            "centres": [_rounded(centre) for centre in track.centres],
            "origins": [_rounded(origin) for origin in self._origins],
            "speeds": speeds,
            "rotations": [_rounded(rotation) for rotation in track.rotations],
            "ways": self._ways,
            "reaches": self._reaches,
        }


def _rounded(vector):
    return None if vector is None else [round(part, 7) for part in vector]


def _reach(state, centre):
    """How far the farthest point of a state is from a place; None where one of them does not exist."""
    if state is None or centre is None:
        return None
    return float(numpy.linalg.norm(state.places[state.alive] - numpy.array(centre), axis=1).max())


def _pairs(before, after):
    """The places of the points that exist in both states; None if points cannot be followed."""
    if before is None or after is None or not (before.is_followed and after.is_followed):
        return None
    if len(before.places) != len(after.places):
        return None
    both = before.alive & after.alive
    return (before.places[both], after.places[both]) if both.any() else None


def _mean_distance(before, after):
    pairs = _pairs(before, after)
    if pairs is None:
        return None
    areas = after.areas if after.areas is not None and len(after.areas) == len(pairs[0]) else None
    return float(numpy.average(numpy.linalg.norm(pairs[1] - pairs[0], axis=1), weights=areas))


class TogetherFollower:
    """Follows how an actor shifts and turns against another one, by the meshes and points that are nearest at first.

    So what is attached to a part of something that bends is compared with that part.
    """

    def __init__(self, request):
        self.start, self.end = request["start"], request["end"]
        self._a, self._b = actor_of(request["a"]), actor_of(request["b"])
        self._first = None
        self._result = {"shift": 0.0, "shift_frame": self.start, "at": None, "turn": None, "turn_frame": None}

    def look(self, frame, graph, tracker):
        """Measures a frame."""
        for actor in (self._a, self._b):
            check_evaluated(actor, graph)
        if self._first is None:
            self._a, self._b = _next_to_each_other(self._a, self._b, tracker)
        a, b = self._a.state_at(graph), self._b.state_at(graph)
        if a is None or b is None:
            return  # one does not exist yet, or no more
        if self._first is None:
            self._first = a, b, _nearest(a, b.centre), _nearest(b, a.centre)
        first_a, first_b, near_a, near_b = self._first
        middle_a, turn_a = _middle_and_rotation(first_a, a, near_a)
        middle_b, turn_b = _middle_and_rotation(first_b, b, near_b)
        before = _middle(first_a, near_a) - _middle(first_b, near_b)
        carried = before if turn_b is None else turn_b @ before
        shift = (middle_a - (middle_b + carried)).length
        if shift > self._result["shift"]:
            self._result.update(shift=shift, shift_frame=frame, at=tuple(middle_a))
        if turn_a is not None and turn_b is not None:
            angle = (turn_b.transposed() @ turn_a).to_quaternion().angle
            turn = min(angle, 2 * math.pi - angle)
            if self._result["turn"] is None or turn > self._result["turn"]:
                self._result.update(turn=turn, turn_frame=frame)

    def result(self):
        """The result as data."""
        if self._first is None:
            raise Unmeasurable("at no frame do both exist")
        return self._result


def _next_to_each_other(a, b, tracker):
    """Two actors, each without those of its meshes that are farther from the other one."""
    count = len(a.objects) * len(b.objects)
    if a.measured != "vertices" or b.measured != "vertices" or not 1 < count <= _MOST_PAIRS:
        return a, b
    gaps = {}
    for ours, theirs in itertools.product(a.objects, b.objects):
        surfaces = [tracker.surface(obj.name) for obj in (ours, theirs) if obj.type == "MESH"]
        if len(surfaces) == 2 and all(surface.exists for surface in surfaces):
            gaps[ours.name, theirs.name] = surface_distance(*surfaces, _FAR)  # pyright: ignore[reportCallIssue]
    least = min(gaps.values(), default=_FAR)
    if least >= _FAR:
        return a, b
    pairs = [pair for pair, gap in gaps.items() if gap <= least + _BESIDE]
    return tuple(actor_of(sorted({pair[side] for pair in pairs})) for side in (0, 1))


def _nearest(state, place):
    """A mask of the points nearest to a place: a tenth, but at least a dozen.

    None for particles and fluids.
    """
    if not state.is_followed or not state.alive.all():
        return None
    ways = numpy.linalg.norm(state.places - numpy.array(place), axis=1)
    count = min(len(ways), max(_FEWEST, int(_NEAREST * len(ways))))
    chosen = numpy.zeros(len(ways), bool)
    chosen[numpy.argsort(ways, kind="stable")[:count]] = True
    if best_rotation(state.places[chosen], state.places[chosen]) is None:  # they lie on a line
        chosen[:] = True
    return chosen


def _middle(state, chosen):
    return state.centre if chosen is None else Vector(state.places[chosen].mean(axis=0))


def _middle_and_rotation(first, now, chosen):
    """(the mean of the chosen points, their rotation since the first state).

    Particles and fluids have no rotation.
    """
    if chosen is None:
        return now.centre, None
    if _pairs(first, now) is None:
        raise Unmeasurable("its points are not the same ones from frame to frame")
    rotation = best_rotation(first.places[chosen], now.places[chosen])
    if rotation is None:
        raise Unmeasurable("its points are on a line, so it has no measurable rotation")
    return _middle(now, chosen), Matrix.Rotation(rotation.length, 3, rotation)
