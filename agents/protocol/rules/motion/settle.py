"""T7: actors come to rest, or stay at rest, as planned."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from agents.protocol.judging.arrivals import arrival, arrival_request, arrive_at, caused_after
from agents.protocol.judging.measured_motion import measured_motion
from agents.protocol.judging.phases import (
    RESTING,
    path_requests,
    phase_label,
    planned_phases,
    rest_speed,
    rest_start,
)
from agents.protocol.judging.solver_advice import from_the_start, unrest
from agents.protocol.measures.requests import Measures, Request, Unmeasured
from agents.protocol.rule import Rule, RuleContext

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from agents.plan.motion import MotionPhase
    from agents.protocol.findings import Finding
    from agents.protocol.judging.measured_motion import MeasuredMotion


def _requests(context: RuleContext) -> Iterator[Request[Any]]:
    yield from path_requests(context, *sorted(RESTING))
    for _, phase in planned_phases(context, *sorted(RESTING)):
        following = caused_after(context, phase)
        if following is not None and (request := arrival_request(context, following)):
            yield request


def _judge(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    for place, phase in planned_phases(context, *sorted(RESTING)):
        try:
            motion = measured_motion(context, measures, phase.actor)
            first = rest_start(phase, motion.fps) if phase.kind == "settle" else phase.start
            yield from _unrest(context, measures, motion, (place, phase), first)
        except Unmeasured as reason:
            yield T7.undecided((phase.actor,), reason)


def _origin(
    context: RuleContext, measures: Measures, phase: MotionPhase, frames: Sequence[int]
) -> tuple[str, str]:
    """What a motion at these frames of a rest comes from, as far as that is known, and what to do about it."""
    told: list[str] = []
    fixes: list[str] = []
    start = context.facts.frame_start
    if frames[0] == start + 1 and (fix := from_the_start(context, phase.actor)):
        told.append(f" It moves at frame {frames[0]}, as the simulation begins.")
        fixes.append(fix)
    elif len(frames) > 1:
        told.append(f" It moves from frame {frames[0]} on.")
    following = caused_after(context, phase)
    met = arrival(context, measures, following) if following is not None else None
    if following is not None and met is not None and met[1] <= frames[-1]:
        told.append(f" {met[0]!r}, which causes {following.name!r}, touches it at frame {met[1]}.")
        fixes.append(arrive_at(met[0], following.start))
    return "".join(told), " ".join(fixes) or unrest(context, phase.actor) or T7.fix


def _unrest(
    context: RuleContext,
    measures: Measures,
    motion: MeasuredMotion,
    indexed: tuple[int, MotionPhase],
    first: int,
) -> Iterator[Finding]:
    place, phase = indexed
    if first >= phase.end:
        raise Unmeasured(f"{phase.name!r} is one frame long; rest needs at least two")
    label = f"{phase_label(place, phase)} must be at rest from frame {first} to {phase.end}, but"
    if motion.deforms:
        speeds, subject = motion.speeds(first, phase.end), "its points move"
    else:
        speeds, subject = motion.step_lengths(first, phase.end) * motion.fps, "it moves"
    speeds[np.isinf(speeds)] = np.nan  # where it appears
    if not np.isfinite(speeds).any():
        raise Unmeasured(f"it does not exist from frame {first} to {phase.end}")
    worst, most = int(np.nanargmax(speeds)), rest_speed(context, motion)
    if speeds[worst] > most:
        told, fix = _origin(context, measures, phase, (first + 1 + np.flatnonzero(speeds > most)).tolist())
        yield T7.finding(
            (phase.actor,),
            f"{label} {subject} at {speeds[worst]:.3g} m/s.{told}",
            frame=first + 1 + worst,
            measured=float(speeds[worst]),
            tolerance=most,
            unit="m/s",
            fix=fix,
        )
    elif (
        phase.kind == "hold"
        and (off := float(np.linalg.norm(motion.displacements(first, phase.end)[-1]))) > most
    ):
        # A drift too slow for any single step: it may be as long as the way at rest speed in a second.
        yield T7.finding(
            (phase.actor,),
            f"{label} it drifts by {off:.3g} m.",
            frame=phase.end,
            measured=off,
            tolerance=most,
            unit="m",
            fix=unrest(context, phase.actor) or T7.fix,
        )
    if motion.deforms or not motion.has_fixed_points:
        return
    rates = np.linalg.norm(motion.step_rotations(first, phase.end), axis=1) * motion.fps
    worst = int(np.argmax(rates))
    if rates[worst] > (slow := context.tolerances.rest_turn):
        told, fix = _origin(context, measures, phase, (first + 1 + np.flatnonzero(rates > slow)).tolist())
        yield T7.finding(
            (phase.actor,),
            f"{label} it turns at {rates[worst]:.3g} rad/s.{told}",
            frame=first + 1 + worst,
            measured=float(rates[worst]),
            tolerance=slow,
            unit="rad/s",
            fix=fix,
        )


T7 = Rule(
    "T7",
    "settle",
    "hard",
    "A settle phase is at rest in its last second, or its last quarter if that is shorter; a hold phase stays at rest.",
    "An object that trembles or creeps at the end was simulated too coarsely, or not long enough.",
    "Simulate longer, with more substeps, more damping or friction, or let bodies sleep; then bake again.",
    _judge,
    _requests,
    needs_plan=True,
    tolerances=("rest_speed", "rest_turn"),
)
RULES = (T7,)
