"""T2 to T4: when motions begin, in which order, and how far they go."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from agents.protocol.judging.contact_pairs import smallest_diagonal
from agents.protocol.judging.phases import (
    RESTING,
    acting,
    meshes_of,
    motion_of,
    moving_speed,
    onset,
    path_of,
    slack,
    span,
    told,
)
from agents.protocol.judging.sample_frames import angle
from agents.protocol.measures.measure import Measures, Request, Unmeasured
from agents.protocol.measures.motion import Touches
from agents.protocol.rule import Idle, Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.motion import Phase
    from agents.protocol.findings import Finding
    from agents.protocol.judging.phases import Motion
    from agents.protocol.judging.sample_frames import Array

_SWAYING = frozenset({"swing", "bounce"})  # they come back: what counts is how far they got


# Onset


def _beginning(subject: Subject) -> Iterator[tuple[int, Phase]]:
    """The phases that begin with a motion. Raises Idle."""
    found = [(place, phase) for place, phase in acting(subject) if phase.kind not in RESTING]
    if not found:
        raise Idle("the plan has no phase that begins with a motion")
    return iter(found)


def _onsets(subject: Subject, measures: Measures) -> Iterator[Finding]:
    for place, phase in _beginning(subject):
        try:
            motion = motion_of(subject, measures, phase.actor)
            found = onset(subject, motion, phase)
        except Unmeasured as reason:
            yield T2.undecided((phase.actor,), reason)
            continue
        most = slack(subject, phase)
        if found is None:
            least = moving_speed(subject, motion, phase)
            speeds = motion.speeds(phase.start, phase.end)
            peak = float(speeds[np.isfinite(speeds)].max(initial=0.0))
            yield T2.finding(
                (phase.actor,),
                f"{told(place, phase)} does not move from frame {phase.start} to {phase.end}; "
                f"its greatest speed is {peak:.3g} m/s.",
                frame=phase.start,
                measured=peak,
                tolerance=least,
                unit="m/s",
            )
        elif abs(late := found.frame - phase.start) > most:
            yield T2.finding(
                (phase.actor,),
                f"{told(place, phase)} begins to move at frame {found.frame}, "
                f"{abs(late)} frames {'late' if late > 0 else 'early'}; planned is frame {phase.start}.",
                frame=found.frame,
                measured=float(late),
                tolerance=most,
                unit="frames",
            )


# Order


def _effects(subject: Subject) -> list[tuple[int, Phase, Phase]]:
    """(place, effect, its cause) for every phase that has a cause. Raises Idle."""
    by_name = {phase.name: phase for phase in subject.planned.motion.phases}
    found = [
        (place, phase, by_name[phase.cause])
        for place, phase in acting(subject)
        if phase.cause is not None and phase.cause in by_name and phase.kind not in RESTING
    ]
    if not found:
        raise Idle("the plan has no phase that moves because of another one")
    return found


def _meeting(subject: Subject, effect: Phase, cause: Phase) -> Touches | None:
    """The request for when the actor of the cause first touches that of its effect; None where they cannot touch."""
    a, b = meshes_of(subject, cause.actor), meshes_of(subject, effect.actor)
    if effect.actor == cause.actor or not a or not b:
        return None
    within = subject.tolerances.contact_gap(smallest_diagonal(subject, a, b))
    return Touches(a, b, cause.start, effect.end, within, once=True)


def _ask_order(subject: Subject) -> Iterator[Request[Any]]:
    for _, effect, cause in _effects(subject):
        for actor in (effect.actor, cause.actor):
            if request := path_of(subject, actor):
                yield request
        if request := _meeting(subject, effect, cause):
            yield request


def _order(subject: Subject, measures: Measures) -> Iterator[Finding]:
    for place, effect, cause in _effects(subject):
        pair = (effect.actor, cause.actor) if effect.actor != cause.actor else (effect.actor,)
        try:
            yield from _out_of_order(subject, measures, (place, effect, cause), pair)
        except Unmeasured as reason:
            yield T3.undecided(pair, reason)


def _out_of_order(
    subject: Subject, measures: Measures, phases: tuple[int, Phase, Phase], pair: tuple[str, ...]
) -> Iterator[Finding]:
    place, effect, cause = phases
    began = onset(subject, motion_of(subject, measures, effect.actor), effect)
    caused = onset(subject, motion_of(subject, measures, cause.actor), cause)
    if began is None:
        raise Unmeasured(f"{effect.actor!r} does not move in {effect.name!r}")
    first = cause.start if caused is None or cause.kind in RESTING else caused.frame
    if caused is None and cause.kind not in RESTING:
        raise Unmeasured(f"{cause.actor!r} does not move in {cause.name!r}, which is to set it off")
    # What moves already does not show when it is pushed: then it is by the plan.
    most = subject.tolerances.order + (slack(subject, effect) if began.carried else 0.0)
    if first - began.frame > most:
        yield T3.finding(
            pair,
            f"{told(place, effect)} moves from frame {began.frame} on, but {cause.name!r}, "
            f"which is to set it off, begins at frame {first}.",
            frame=began.frame,
            measured=float(first - began.frame),
            tolerance=most,
            unit="frames",
        )
    meeting = _meeting(subject, effect, cause)
    met = measures[meeting].frames if meeting else ()
    if met and met[0] - began.frame > most:
        yield T3.finding(
            pair,
            f"{told(place, effect)} moves from frame {began.frame} on, but {cause.actor!r} "
            f"touches it at frame {met[0]} only.",
            frame=began.frame,
            measured=float(met[0] - began.frame),
            tolerance=most,
            unit="frames",
        )


# Extent


def _measured(phase: Phase) -> bool:
    return any(one is not None for one in (phase.extent, phase.direction, phase.amplitude, phase.turn))


def _going(subject: Subject) -> list[tuple[int, Phase]]:
    """The phases of which the plan says how far they go, or where to. Raises Idle."""
    found = [(place, phase) for place, phase in acting(subject) if _measured(phase)]
    if not found:
        raise Idle("the plan does not say how far anything moves")
    return found


def _ask_extents(subject: Subject) -> Iterator[Request[Any]]:
    for _, phase in _going(subject):
        if request := path_of(subject, phase.actor):
            yield request


def _extents(subject: Subject, measures: Measures) -> Iterator[Finding]:
    for place, phase in _going(subject):
        try:
            motion = motion_of(subject, measures, phase.actor)
            frames = span(subject, motion, phase)
        except Unmeasured as reason:
            yield T4.undecided((phase.actor,), reason)
            continue
        for check in (_extent, _amplitude, _direction, _turn):
            try:
                miss = check(subject, motion, phase, frames)
            except Unmeasured as reason:
                yield T4.undecided((phase.actor,), reason)
                continue
            if miss is not None:
                sentence, measured, tolerance, unit = miss
                yield T4.finding(
                    (phase.actor,),
                    f"{told(place, phase)} {sentence}",
                    frame=frames[1],
                    measured=measured,
                    tolerance=tolerance,
                    unit=unit,
                )


_Miss = tuple[str, float, float, str] | None


def _distances(motion: Motion, phase: Phase, frames: tuple[int, int]) -> Array:
    """How far the actor is from where it was first, at each frame: its centre, or if it deforms, its points."""
    if phase.kind == "deform" or (motion.deforms and motion.is_followed):
        return motion.ways(phase.start, frames[1])
    return np.linalg.norm(motion.displacements(*frames), axis=1)


def _least_way(subject: Subject, motion: Motion) -> float:
    """Ways that are shorter are none."""
    return subject.tolerances.contact_gap(motion.path.size)


def _extent(subject: Subject, motion: Motion, phase: Phase, frames: tuple[int, int]) -> _Miss:
    if phase.extent is None:
        return None
    way = float(_distances(motion, phase, frames)[-1])
    most = max(subject.tolerances.extent_share * phase.extent, _least_way(subject, motion))
    if abs(way - phase.extent) <= most:
        return None
    return f"gets {way:.3f} m from where it was; planned are {phase.extent:g} m.", way, most, "m"


def _amplitude(subject: Subject, motion: Motion, phase: Phase, frames: tuple[int, int]) -> _Miss:
    if phase.amplitude is None:
        return None
    way = float(_distances(motion, phase, frames).max())
    most = max(subject.tolerances.extent_share * phase.amplitude, _least_way(subject, motion))
    if abs(way - phase.amplitude) <= most:
        return None
    return f"is at most {way:.3f} m from where it began; planned are {phase.amplitude:g} m.", way, most, "m"


def _direction(subject: Subject, motion: Motion, phase: Phase, frames: tuple[int, int]) -> _Miss:
    if phase.direction is None:
        return None
    ways = motion.displacements(*frames)
    far = np.linalg.norm(ways, axis=1)
    way = ways[int(np.argmax(far)) if phase.kind in _SWAYING else -1]
    planned, most = np.array(phase.direction, dtype=float), subject.tolerances.course
    if np.linalg.norm(way) <= _least_way(subject, motion):
        if phase.kind != "rotate":
            return "is where it was; it does not go in the planned direction.", 180.0, most, "°"
        axis = motion.turning(*frames).sum(axis=0)
        off = min(angle(axis, planned), angle(-axis, planned))
        sentence = f"turns about an axis that is {off:.1f}° from the planned direction."
    else:
        off = angle(way, planned)
        sentence = f"goes {off:.1f}° beside the planned direction."
    return (sentence, off, most, "°") if off > most else None


def _turn(subject: Subject, motion: Motion, phase: Phase, frames: tuple[int, int]) -> _Miss:
    if phase.turn is None:
        return None
    turned = np.degrees(np.linalg.norm(np.cumsum(motion.turning(*frames), axis=0), axis=1))
    found = float(turned.max() if phase.kind in _SWAYING else turned[-1])
    planned, tolerances = abs(phase.turn), subject.tolerances
    # Of a small turn not so much that none at all would do.
    most = max(tolerances.extent_share * planned, min(tolerances.course, planned / 2), 1.0)
    if abs(found - planned) <= most:
        return None
    return f"turns by {found:.1f}°; planned are {planned:g}°.", found, most, "°"


T2 = Rule(
    "T2",
    "onset",
    "hard",
    "Each phase's actor begins to move when planned: from there on it is faster than a share of its greatest speed.",
    "What starts too early moves by itself; what starts too late leaves the scene waiting.",
    "Shift the keyframes, or release, push or emit at the planned frame, and bake again.",
    _onsets,
    lambda subject: [
        request for _, phase in _beginning(subject) if (request := path_of(subject, phase.actor))
    ],
    needs_plan=True,
    tolerances=("onset", "onset_share", "moving_share", "rest_speed"),
)
T3 = Rule(
    "T3",
    "order",
    "hard",
    "What sets a phase off comes before it: the cause moves first, and if the two ever touch, they touch first.",
    "A domino that falls before it is hit tells that nothing here is physics.",
    "Let the contact set the target off: an active rigid body, at rest and without keyframes, in the way of its cause.",
    _order,
    _ask_order,
    needs_plan=True,
    tolerances=("order", "contact", "contact_share", "contact_most", "moving_share", "rest_speed"),
)
T4 = Rule(
    "T4",
    "extent",
    "hard",
    "The actor gets as far as planned in its phase: displacement, direction, amplitude, turn.",
    "A swing of a hand's breadth is no swing, and a ball that rolls half the way knocks nothing over.",
    "Change the start, the speed or the keyframes until the end of the phase is the planned one, and bake again.",
    _extents,
    _ask_extents,
    needs_plan=True,
    tolerances=("extent_share", "course", "contact", "contact_share", "contact_most"),
)
RULES = (T2, T3, T4)
