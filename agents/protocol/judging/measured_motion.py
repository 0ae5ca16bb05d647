"""The measured motion of a planned actor. Frames, metres, seconds, radians."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agents.protocol.measures.motion import MotionPathRequest
from agents.protocol.measures.requests import Unmeasured

if TYPE_CHECKING:
    from agents.protocol.judging.geometry.vectors import Array
    from agents.protocol.measures.motion import MotionPathMeasure
    from agents.protocol.measures.requests import Measures, Names
    from agents.protocol.rule import RuleContext

_GENERATORS = frozenset({"PARTICLE_SYSTEM", "FLUID_DOMAIN"})  # modifiers that make what is followed
_MAX_STEP_ANGLE = 2.6  # radians per frame; beyond it, a rotation the other way round would look the same


class MeasuredMotion:
    """An actor's motion over the frames. Its methods raise Unmeasured for what is unknown."""

    def __init__(self, path: MotionPathMeasure, fps: float) -> None:
        self.path = path
        self.fps = fps
        self.start = path.start
        self.end = path.start + len(path.centres) - 1
        self._speeds = np.array([math.nan if speed is None else speed for speed in path.speeds], dtype=float)
        self._exists = np.array([centre is not None for centre in path.centres])

    @property
    def deforms(self) -> bool:
        """Whether its points move relative to each other."""
        return self.path.deforms

    @property
    def has_fixed_points(self) -> bool:
        """Whether it consists of the same points all the time; particles and fluids do not."""
        return self.path.measured in {"vertices", "origin"}

    def speeds(self, start: int, end: int) -> Array:
        """The speed of each step from ``start`` to ``end``, in m/s; infinite where the actor appears."""
        steps = slice(start + 1 - self.start, end + 1 - self.start)
        appears = self._exists[steps] & ~self._exists[start - self.start : end - self.start]
        return np.where(appears, math.inf, self._speeds[steps])

    def step_lengths(self, start: int, end: int) -> Array:
        """How far the centre moves in each step; nan where the actor does not exist."""
        return np.linalg.norm(np.diff(self.places(start, end), axis=0), axis=1)

    def places(self, start: int, end: int, *, origins: bool = False) -> Array:
        """The centre (or the mean of the objects' origins) at each frame, n × 3; nan where the actor does not exist."""
        series = self.path.origins if origins else self.path.centres
        places = series[start - self.start : end + 1 - self.start]
        return np.array([(math.nan,) * 3 if place is None else place for place in places], dtype=float)

    def displacements(self, start: int, end: int) -> Array:
        """The centre at each frame relative to its first place, n × 3."""
        places = self.places(start, end)
        exists = ~np.isnan(places[:, 0])
        if not exists.any():
            raise Unmeasured(f"it does not exist from frame {start} to {end}")
        places = places[exists]
        return places - places[0]

    def point_distances(self, start: int, end: int) -> Array:
        """The mean distance of the points from where they were at ``start``, a phase's first frame."""
        distances = self.path.ways[start + 1 - self.start : end + 1 - self.start]
        if not distances or None in distances:
            raise Unmeasured("its points are not the same at each frame")
        return np.array(distances, dtype=float)

    @property
    def flows(self) -> bool:
        """Whether it is a liquid or gas, which spreads: its middle goes another way than its front."""
        return self.path.measured == "fluid"

    def reach(self, end: int) -> float:
        """How far its farthest point is, at a frame, from where its centre was when its phase began."""
        reaches = self.path.reaches[end - self.start : end - self.start + 1]
        if not reaches or reaches[0] is None:
            raise Unmeasured(f"it does not exist at frame {end}")
        return reaches[0]

    def step_rotations(self, start: int, end: int) -> Array:
        """The rotation of each step, as an axis as long as the angle."""
        rotations = self.path.rotations[start + 1 - self.start : end + 1 - self.start]
        if not rotations or None in rotations:
            raise Unmeasured("its rotation cannot be measured from its points")
        turns = np.array(rotations, dtype=float)
        if (np.linalg.norm(turns, axis=1) > _MAX_STEP_ANGLE).any():
            raise Unmeasured("it turns so far in a frame that the angle and direction are ambiguous")
        return turns


def followed_names(context: RuleContext, node: str) -> Names:
    """The objects to follow for a node: its surfaces, particle emitters and fluid domains; else its bones or roots."""
    structure = context.structure
    obj = structure.by_name.get(node)
    if obj is None:
        return structure.surfaces_of(node)
    if domains := tuple(item.name for item in obj.meshes if item.is_fluid_domain):
        return domains  # flows are where a fluid comes from, no part of it
    generators = [item.name for item in (*obj.meshes, *obj.others) if item.has_modifier(_GENERATORS)]
    bones = [item.name for item in obj.others if item.type == "ARMATURE"]
    return tuple(dict.fromkeys([*generators, *obj.surfaces] or bones or [root.name for root in obj.roots]))


def mesh_names(context: RuleContext, node: str) -> Names:
    """The meshes of a node, on which contact and depth can be measured."""
    objects = context.structure.objects
    return tuple(name for name in context.structure.surfaces_of(node) if objects[name].type == "MESH")


def path_request(context: RuleContext, actor: str) -> MotionPathRequest | None:
    """The request for an actor's motion over the timeline; None if there is no object of that name."""
    names = followed_names(context, actor)
    if not names:
        return None
    phases = context.planned.motion.phases
    return MotionPathRequest(
        names,
        min(context.planned.frame_start, *(phase.start for phase in phases)),
        max(context.planned.frame_end, *(phase.end for phase in phases)),
        tuple(sorted({phase.start for phase in phases if phase.actor == actor})),
    )


def measured_motion(context: RuleContext, measures: Measures, actor: str) -> MeasuredMotion:
    """An actor's motion. Raises Unmeasured."""
    request = path_request(context, actor)
    if request is None:
        raise Unmeasured(f"there is no object {actor!r}")
    return MeasuredMotion(measures[request], context.facts.fps)
