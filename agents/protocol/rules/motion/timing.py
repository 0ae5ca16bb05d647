"""T2 to T4: when motions start, in which order, and how far they go."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from agents.protocol.judging import solver_advice
from agents.protocol.judging.arrivals import arrival, arrival_request, arrive_at, meeting
from agents.protocol.judging.geometry.vectors import angle_between
from agents.protocol.judging.measured_motion import measured_motion, path_request
from agents.protocol.judging.phases import (
    RESTING,
    actual_span,
    cause_of,
    find_onset,
    moving_speed,
    onset_tolerance,
    onset_window,
    phase_label,
    planned_phases,
)
from agents.protocol.measures.requests import Measures, Request, Unmeasured
from agents.protocol.rule import NotApplicable, Rule, RuleContext
from agents.protocol.tolerances import CONTACT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.motion import MotionPhase
    from agents.protocol.findings import Finding
    from agents.protocol.judging.geometry.vectors import Array
    from agents.protocol.judging.measured_motion import MeasuredMotion

_RETURNING = frozenset({"swing", "bounce"})  # judged by how far they get, not where they end
_WITH_ITS_CAUSE = 2  # frames between a contact and a motion that comes from it


# Onset


def _moving_phases(context: RuleContext) -> list[tuple[int, MotionPhase]]:
    """The phases that start with a motion. Raises NotApplicable."""
    phases = [(place, phase) for place, phase in planned_phases(context) if phase.kind not in RESTING]
    if not phases:
        raise NotApplicable("the plan has no phase that starts with a motion")
    return phases


def _onset_requests(context: RuleContext) -> Iterator[Request[Any]]:
    for _, phase in _moving_phases(context):
        if request := path_request(context, phase.actor):
            yield request
        if request := arrival_request(context, phase):
            yield request


def _wrong_onsets(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    for place, phase in _moving_phases(context):
        try:
            motion = measured_motion(context, measures, phase.actor)
            onset = find_onset(context, motion, phase)
        except Unmeasured as reason:
            yield T2.undecided((phase.actor,), reason)
            continue
        most = onset_window(context, phase)
        if onset is None:
            least = moving_speed(context, motion, phase)
            speeds = motion.speeds(phase.start, phase.end)
            peak = float(speeds[np.isfinite(speeds)].max(initial=0.0))
            yield T2.finding(
                (phase.actor,),
                f"{phase_label(place, phase)} does not move from frame {phase.start} to {phase.end}; "
                f"its top speed is {peak:.3g} m/s.",
                frame=phase.start,
                measured=peak,
                tolerance=least,
                unit="m/s",
                fix=solver_advice.onset(context, phase.actor) or T2.fix,
            )
        elif abs(late := onset.frame - phase.start) > most:
            arrived, fix = "", solver_advice.onset(context, phase.actor) or T2.fix
            met = arrival(context, measures, phase)
            if met is not None and abs(met[1] - onset.frame) <= _WITH_ITS_CAUSE:
                arrived = f" {met[0]!r}, which causes it, touches it at frame {met[1]}."
                fix = arrive_at(met[0], phase.start)
            yield T2.finding(
                (phase.actor,),
                f"{phase_label(place, phase)} starts to move at frame {onset.frame}, "
                f"{abs(late)} frames {'late' if late > 0 else 'early'}; the plan says frame {phase.start}.{arrived}",
                frame=onset.frame,
                measured=float(late),
                tolerance=most,
                unit="frames",
                fix=fix,
            )


# Order


def _effects(context: RuleContext) -> list[tuple[int, MotionPhase, MotionPhase]]:
    """(index, effect, its cause) for every moving phase with a cause. Raises NotApplicable."""
    effects = [
        (place, phase, cause)
        for place, phase in planned_phases(context)
        if phase.kind not in RESTING and (cause := cause_of(context, phase)) is not None
    ]
    if not effects:
        raise NotApplicable("the plan has no phase with a cause")
    return effects


def _order_requests(context: RuleContext) -> Iterator[Request[Any]]:
    for _, effect, cause in _effects(context):
        for actor in (effect.actor, cause.actor):
            if request := path_request(context, actor):
                yield request
        if request := meeting(context, effect, cause):
            yield request


def _wrong_order(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    for place, effect, cause in _effects(context):
        pair = (effect.actor, cause.actor) if effect.actor != cause.actor else (effect.actor,)
        try:
            yield from _out_of_order(context, measures, (place, effect, cause), pair)
        except Unmeasured as reason:
            yield T3.undecided(pair, reason)


def _out_of_order(
    context: RuleContext,
    measures: Measures,
    phases: tuple[int, MotionPhase, MotionPhase],
    pair: tuple[str, ...],
) -> Iterator[Finding]:
    place, effect, cause = phases
    began = find_onset(context, measured_motion(context, measures, effect.actor), effect)
    caused = find_onset(context, measured_motion(context, measures, cause.actor), cause)
    if began is None:
        raise Unmeasured(f"{effect.actor!r} does not move in {effect.name!r}")
    first = cause.start if caused is None or cause.kind in RESTING else caused.frame
    if caused is None and cause.kind not in RESTING:
        raise Unmeasured(f"{cause.actor!r} does not move in its cause {cause.name!r}")
    # An actor that moves already does not show when it is pushed; its planned frame counts then.
    most = context.tolerances.order + (onset_tolerance(context, effect) if began.carried else 0.0)
    if first - began.frame > most:
        yield T3.finding(
            pair,
            f"{phase_label(place, effect)} moves from frame {began.frame} on, but its cause {cause.name!r} "
            f"starts only at frame {first}.",
            frame=began.frame,
            measured=float(first - began.frame),
            tolerance=most,
            unit="frames",
        )
    touching = meeting(context, effect, cause)
    met = measures[touching].frames if touching else ()
    # What touches when the cause begins may have touched long before.
    if met and met[0] > cause.start and met[0] - began.frame > most:
        yield T3.finding(
            pair,
            f"{phase_label(place, effect)} moves from frame {began.frame} on, but {cause.actor!r} "
            f"touches it only at frame {met[0]}.",
            frame=began.frame,
            measured=float(met[0] - began.frame),
            tolerance=most,
            unit="frames",
        )


# Extent


def _has_extent(phase: MotionPhase) -> bool:
    return any(value is not None for value in (phase.extent, phase.direction, phase.amplitude, phase.turn))


def _phases_with_extent(context: RuleContext) -> list[tuple[int, MotionPhase]]:
    """The phases with a planned distance, direction or turn. Raises NotApplicable."""
    phases = [(place, phase) for place, phase in planned_phases(context) if _has_extent(phase)]
    if not phases:
        raise NotApplicable("the plan does not say how far anything moves")
    return phases


def _extent_requests(context: RuleContext) -> Iterator[Request[Any]]:
    for _, phase in _phases_with_extent(context):
        if request := path_request(context, phase.actor):
            yield request


def _wrong_extents(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    for place, phase in _phases_with_extent(context):
        try:
            motion = measured_motion(context, measures, phase.actor)
            frames = actual_span(context, motion, phase)
        except Unmeasured as reason:
            yield T4.undecided((phase.actor,), reason)
            continue
        for check in (_extent, _amplitude, _direction, _turn):
            try:
                violation = check(context, motion, phase, frames)
            except Unmeasured as reason:
                yield T4.undecided((phase.actor,), reason)
                continue
            if violation is not None:
                sentence, measured, tolerance, unit = violation
                yield T4.finding(
                    (phase.actor,),
                    f"{phase_label(place, phase)} {sentence}",
                    frame=frames[1],
                    measured=measured,
                    tolerance=tolerance,
                    unit=unit,
                    fix=solver_advice.extent(context, phase.actor) or T4.fix,
                )


_Violation = tuple[str, float, float, str] | None  # sentence, measured, tolerance, unit


def _distances(motion: MeasuredMotion, phase: MotionPhase, frames: tuple[int, int]) -> Array:
    """The distance of the actor from its first place at each frame: of its centre, or of its points if it deforms."""
    if phase.kind == "deform" or (motion.deforms and motion.has_fixed_points):
        return motion.point_distances(phase.start, frames[1])
    return np.linalg.norm(motion.displacements(*frames), axis=1)


def _min_distance(context: RuleContext, motion: MeasuredMotion) -> float:
    """Shorter distances count as no motion."""
    return context.tolerances.contact_gap(motion.path.size)


def _extent(
    context: RuleContext, motion: MeasuredMotion, phase: MotionPhase, frames: tuple[int, int]
) -> _Violation:
    if phase.extent is None:
        return None
    distance = float(_distances(motion, phase, frames)[-1])
    most = max(context.tolerances.extent_share * phase.extent, _min_distance(context, motion))
    if abs(distance - phase.extent) <= most:
        return None
    if motion.flows and distance < phase.extent:
        # What flows spreads: its extent may be meant as the way of its middle, or of its front.
        reach = motion.reach(frames[1])
        if phase.extent - most <= reach:
            return None
        sentence = f"reaches {reach:.3f} m from where it began; the plan says {phase.extent:g} m."
        return sentence, reach, most, "m"
    return f"moves {distance:.3f} m; the plan says {phase.extent:g} m.", distance, most, "m"


def _amplitude(
    context: RuleContext, motion: MeasuredMotion, phase: MotionPhase, frames: tuple[int, int]
) -> _Violation:
    if phase.amplitude is None:
        return None
    distance = float(_distances(motion, phase, frames).max())
    most = max(context.tolerances.extent_share * phase.amplitude, _min_distance(context, motion))
    if abs(distance - phase.amplitude) <= most:
        return None
    return (
        f"gets at most {distance:.3f} m away from its start; the plan says {phase.amplitude:g} m.",
        distance,
        most,
        "m",
    )


def _direction(
    context: RuleContext, motion: MeasuredMotion, phase: MotionPhase, frames: tuple[int, int]
) -> _Violation:
    if phase.direction is None:
        return None
    moves = motion.displacements(*frames)
    distances = np.linalg.norm(moves, axis=1)
    move = moves[int(np.argmax(distances)) if phase.kind in _RETURNING else -1]
    planned = np.array(phase.direction, dtype=float)
    most = context.tolerances.flow_course if motion.flows else context.tolerances.course
    if np.linalg.norm(move) <= _min_distance(context, motion):
        if phase.kind != "rotate":
            return "ends where it started; it does not move in the planned direction.", 180.0, most, "°"
        axis = motion.step_rotations(*frames).sum(axis=0)
        off = min(angle_between(axis, planned), angle_between(-axis, planned))
        sentence = f"turns about an axis {off:.1f}° away from the planned direction."
    else:
        off = angle_between(move, planned)
        sentence = f"moves in a direction {off:.1f}° away from the planned one."
    return (sentence, off, most, "°") if off > most else None


def _turn(
    context: RuleContext, motion: MeasuredMotion, phase: MotionPhase, frames: tuple[int, int]
) -> _Violation:
    if phase.turn is None:
        return None
    turned = np.degrees(np.linalg.norm(np.cumsum(motion.step_rotations(*frames), axis=0), axis=1))
    turn = float(turned.max() if phase.kind in _RETURNING else turned[-1])
    planned, tolerances = abs(phase.turn), context.tolerances
    # A small turn has a small tolerance, so that no turn at all does not pass.
    most = max(tolerances.extent_share * planned, min(tolerances.course, planned / 2), 1.0)
    if abs(turn - planned) <= most:
        return None
    return f"turns by {turn:.1f}°; the plan says {planned:g}°.", turn, most, "°"


T2 = Rule(
    "T2",
    "onset",
    "hard",
    "Each phase's actor starts to move when planned: from then on it is faster than a share of its top speed.",
    "An actor that starts too early seems to move by itself; one that starts too late leaves the scene waiting.",
    "Shift the keyframes, or release, push or emit at the planned frame, and bake again.",
    _wrong_onsets,
    _onset_requests,
    needs_plan=True,
    tolerances=("onset", "onset_share", "onset_caused", "moving_share", "rest_speed"),
)
T3 = Rule(
    "T3",
    "order",
    "hard",
    "A cause comes before its effect: it moves first, and if the two ever touch, they touch before the effect.",
    "A domino that falls before it is hit shows that the physics is faked.",
    "Let the contact start the effect: an active rigid body, at rest and without keyframes, in the path of its cause.",
    _wrong_order,
    _order_requests,
    needs_plan=True,
    tolerances=("order", *CONTACT, "moving_share", "rest_speed"),
)
T4 = Rule(
    "T4",
    "extent",
    "hard",
    "The actor moves as far as planned in its phase: displacement, direction, amplitude, turn (of what flows: "
    "its middle or front).",
    "A swing of a few centimetres is not seen, and a ball that rolls half the way knocks nothing over.",
    "Change the start, the speed or the keyframes until the end of the phase is the planned one, and bake again.",
    _wrong_extents,
    _extent_requests,
    needs_plan=True,
    tolerances=("extent_share", "course", "flow_course", *CONTACT),
)
RULES = (T2, T3, T4)
