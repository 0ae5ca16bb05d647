"""Planned phases and the measured motion of their actors, side by side. Frames, metres, seconds, radians."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agents.protocol.measures.measure import Unmeasured
from agents.protocol.measures.motion import Path
from agents.protocol.rule import Idle

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy.typing as npt

    from agents.plan.motion import Phase
    from agents.protocol.judging.sample_frames import Array
    from agents.protocol.measures.measure import Measures, Names
    from agents.protocol.measures.motion import PathMeasure
    from agents.protocol.rule import Subject

RESTING = frozenset({"hold", "settle"})
# What gravity may drive: such a thing gets as fast as one that falls as far.
_DRIVEN = frozenset({"fall", "slide", "roll", "topple", "swing", "bounce", "flow", "emit", "settle"})
_MAKERS = frozenset({"PARTICLE_SYSTEM", "FLUID_DOMAIN"})
_LASTING = 3  # steps that a motion must go on for; a shorter one is a twitch
_SLOWEST = 0.25  # share of a planned mean speed that counts as moving, however slow that is
_ARM = 0.25  # of a thing's size: how far its points are from the axis that it turns about, on average
_ALIASED = 2.6  # radians in a frame: turned as far the other way round, it would look the same


@dataclass(frozen=True, slots=True)
class Onset:
    """The frame from which an actor moves. ``carried``: it moved already, in the phase before."""

    frame: int
    carried: bool = False


class Motion:
    """The measured path of an actor: what it does between two frames. Raises Unmeasured for what is not known."""

    def __init__(self, path: PathMeasure, fps: float) -> None:
        self.path = path
        self.fps = fps
        self.start = path.start
        self.end = path.start + len(path.centres) - 1
        self._speeds = np.array([math.nan if one is None else one for one in path.speeds], dtype=float)
        self._there = np.array([one is not None for one in path.centres])

    @property
    def deforms(self) -> bool:
        """Whether its points move against each other."""
        return self.path.deforms

    @property
    def is_followed(self) -> bool:
        """Whether it is made of the same points all the time; particles and fluids are not."""
        return self.path.measured in {"vertices", "origin"}

    def speeds(self, start: int, end: int) -> Array:
        """Of each step from ``start`` to ``end``, in m/s; where it comes to be, infinite."""
        steps = slice(start + 1 - self.start, end + 1 - self.start)
        appears = self._there[steps] & ~self._there[start - self.start : end - self.start]
        return np.where(appears, math.inf, self._speeds[steps])

    def steps(self, start: int, end: int) -> Array:
        """How far the centre goes at each step, in metres; nan where there is nothing."""
        return np.linalg.norm(np.diff(self.places(start, end), axis=0), axis=1)

    def places(self, start: int, end: int, *, origins: bool = False) -> Array:
        """Where its centre (or the mean of its objects' origins) is at each frame (n × 3); nan where nothing is."""
        found = (self.path.origins if origins else self.path.centres)[
            start - self.start : end + 1 - self.start
        ]
        return np.array([(math.nan,) * 3 if one is None else one for one in found], dtype=float)

    def displacements(self, start: int, end: int) -> Array:
        """How far its centre is from where it was first, at each frame (n × 3)."""
        places = self.places(start, end)
        there = ~np.isnan(places[:, 0])
        if not there.any():
            raise Unmeasured(f"there is nothing of it from frame {start} to {end}")
        places = places[there]
        return places - places[0]

    def ways(self, start: int, end: int) -> Array:
        """How far its points are on average from where they were at ``start``, a phase's first frame."""
        found = self.path.ways[start + 1 - self.start : end + 1 - self.start]
        if not found or None in found:
            raise Unmeasured("its points are not the same ones from frame to frame")
        return np.array(found, dtype=float)

    def turning(self, start: int, end: int) -> Array:
        """The rotation of each step, as an axis that is as long as the angle."""
        found = self.path.rotations[start + 1 - self.start : end + 1 - self.start]
        if not found or None in found:
            raise Unmeasured("its rotation cannot be told from its points")
        turns = np.array(found, dtype=float)
        if (np.linalg.norm(turns, axis=1) > _ALIASED).any():
            raise Unmeasured("it turns so far in a frame that it cannot be told how far, or which way")
        return turns


def acting(subject: Subject, *kinds: str) -> Iterator[tuple[int, Phase]]:
    """(place in the plan, phase) of some kinds (by default all). Raises Idle if the plan has none."""
    phases = subject.planned.motion.phases
    if not any(not kinds or phase.kind in kinds for phase in phases):
        raise Idle(f"the plan has no {' or '.join(kinds)}" if kinds else "the plan has no motion")
    for place, phase in enumerate(phases):
        if not kinds or phase.kind in kinds:
            yield place, phase


def told(place: int, phase: Phase) -> str:
    """How a finding begins that is about a phase."""
    return f"motion.phases[{place}] ({phase.name!r}): {phase.actor!r}"


def phases_of(subject: Subject, actor: str) -> list[Phase]:
    """The phases of an actor, in order of time."""
    return sorted(
        (phase for phase in subject.planned.motion.phases if phase.actor == actor),
        key=lambda phase: (phase.start, phase.end),
    )


def body_of(subject: Subject, node: str) -> Names:
    """What of a node is followed: its surfaces, what makes particles or holds a fluid; else its bones or its root."""
    structure = subject.structure
    thing = structure.by_name.get(node)
    if thing is None:
        return structure.find(node)
    makers = [
        one.name
        for one in (*thing.meshes, *thing.others)
        if any(modifier.type in _MAKERS and modifier.on for modifier in one.modifiers)
    ]
    bones = [one.name for one in thing.others if one.type == "ARMATURE"]
    found = [*makers, *thing.surfaces] or bones or [root.name for root in thing.roots]
    return tuple(dict.fromkeys(found))


def meshes_of(subject: Subject, node: str) -> Names:
    """The meshes of a node: what contact and depth can be measured on."""
    objects = subject.structure.objects
    return tuple(name for name in subject.structure.find(node) if objects[name].type == "MESH")


def path_of(subject: Subject, actor: str) -> Path | None:
    """The request for how an actor moves over the timeline; None if there is nothing of that name."""
    names = body_of(subject, actor)
    if not names:
        return None
    phases = subject.planned.motion.phases
    return Path(
        names,
        min(subject.planned.frame_start, *(phase.start for phase in phases)),
        max(subject.planned.frame_end, *(phase.end for phase in phases)),
        tuple(sorted({phase.start for phase in phases if phase.actor == actor})),
    )


def paths(subject: Subject, *kinds: str) -> Iterator[Path]:
    """The requests for all actors of phases of some kinds."""
    for _, phase in acting(subject, *kinds):
        if request := path_of(subject, phase.actor):
            yield request


def motion_of(subject: Subject, measures: Measures, actor: str) -> Motion:
    """How an actor moves. Raises Unmeasured."""
    request = path_of(subject, actor)
    if request is None:
        raise Unmeasured(f"there is no object {actor!r}")
    return Motion(measures[request], subject.facts.fps)


def rest_speed(subject: Subject, motion: Motion) -> float:
    """Up to which speed an actor is at rest, in m/s."""
    return subject.tolerances.rest_speed * max(1.0, motion.path.size)


def resting(phase: Phase, fps: float) -> int:
    """The frame from which a ``settle`` phase must be at rest: its last second, or its last quarter, if shorter."""
    return phase.end - max(1, round(min(fps, (phase.end - phase.start) / 4)))


def slack(subject: Subject, phase: Phase) -> float:
    """How many frames a phase may begin early or late."""
    return max(subject.tolerances.onset, subject.tolerances.onset_share * (phase.end - phase.start))


def moving_speed(subject: Subject, motion: Motion, phase: Phase) -> float:
    """From which speed on an actor counts as moving in a phase, in m/s.

    A share of its greatest speed in the phase, but more than rest; less only where the plan wants it slower than that.
    """
    speeds = motion.speeds(phase.start, phase.end)
    speeds = speeds[np.isfinite(speeds)]
    peak = float(speeds.max()) if len(speeds) else 0.0
    seconds = max(1, phase.end - phase.start) / motion.fps
    planned = [one for one in (phase.extent, phase.amplitude) if one]
    if phase.turn:
        planned.append(math.radians(abs(phase.turn)) * _ARM * motion.path.size)
    floor = min([rest_speed(subject, motion), *(_SLOWEST * one / seconds for one in planned)])
    return max(subject.tolerances.moving_share * peak, floor)


def onset(subject: Subject, motion: Motion, phase: Phase) -> Onset | None:
    """From when on the actor makes the motion of a phase; None if it does not move in it.

    It is looked for as far back as nothing else is planned to move the actor.
    """
    first, carried = _looked_from(subject, motion, phase)
    speeds = motion.speeds(first, phase.end)
    moving = speeds > moving_speed(subject, motion, phase)
    moving[1:-1] |= moving[:-2] & moving[2:]  # a moment of rest, as at the top of a bounce
    for begin, stop in _runs(moving):
        lasts = stop - begin >= _LASTING or stop == len(moving)
        if lasts and first + stop > phase.start:
            if carried and begin == 0:
                return Onset(max(first, phase.start), carried=True)
            return Onset(first + begin)
    return None


def _looked_from(subject: Subject, motion: Motion, phase: Phase) -> tuple[int, bool]:
    """(frame from which the actor must be at rest before a phase, whether it may be moving there)."""
    earlier = [one for one in phases_of(subject, phase.actor) if one.start < phase.start]
    if not earlier:
        return motion.start, False
    last = max(earlier, key=lambda one: one.end)
    if last.kind == "hold":
        return last.start, False
    if last.kind == "settle":
        return min(resting(last, motion.fps), phase.start), False
    return min(last.end, phase.start), True


def _runs(flags: npt.NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """(begin, end) of each run of flags that are set."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


def span(subject: Subject, motion: Motion, phase: Phase) -> tuple[int, int]:
    """(first, last) frame of a phase as it really is: one that begins a little early or late is not cut off."""
    found = onset(subject, motion, phase)
    if found is None or found.carried:
        return phase.start, phase.end
    shift = found.frame - phase.start
    if abs(shift) > slack(subject, phase):
        return phase.start, phase.end
    later = [
        one.start for one in phases_of(subject, phase.actor) if one.start >= phase.end and one is not phase
    ]
    return phase.start + min(shift, 0), min([phase.end + max(shift, 0), motion.end, *later])


def greatest_speed(subject: Subject, phase: Phase) -> float | None:
    """The greatest speed that is planned for a phase, in m/s; None if nothing tells.

    It is the planned one; or that of a fall over the planned extent; or twice the mean speed, as of what speeds up
    evenly. Of what gravity drives without a planned extent: that of a fall as long as the phase.
    """
    if phase.top_speed is not None:
        return phase.top_speed
    seconds = max(1, phase.end - phase.start) / subject.facts.fps
    gravity = gravity_of(subject)
    way = max((one for one in (phase.extent, phase.amplitude) if one is not None), default=None)
    if way is None:
        return gravity * seconds if phase.kind in _DRIVEN else None
    even = 2 * way / seconds
    return max(even, math.sqrt(2 * gravity * way)) if phase.kind in _DRIVEN else even


def gravity_of(subject: Subject) -> float:
    """The acceleration of what falls, in m/s²: the scene's, or if that is off, the earth's."""
    return float(np.linalg.norm(subject.facts.gravity)) or 9.81
