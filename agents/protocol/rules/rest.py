"""T7: what is to come to rest does, and what is to stay stays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from agents.protocol.judging.phases import RESTING, acting, motion_of, paths, rest_speed, resting, told
from agents.protocol.measures.measure import Measures, Request, Unmeasured
from agents.protocol.rule import Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.motion import Phase
    from agents.protocol.findings import Finding
    from agents.protocol.judging.phases import Motion


def _still(subject: Subject) -> Iterator[tuple[int, Phase]]:
    return acting(subject, *sorted(RESTING))


def _ask_rest(subject: Subject) -> Iterator[Request[Any]]:
    return paths(subject, *sorted(RESTING))


def _rest(subject: Subject, measures: Measures) -> Iterator[Finding]:
    for place, phase in _still(subject):
        try:
            motion = motion_of(subject, measures, phase.actor)
            first = resting(phase, motion.fps) if phase.kind == "settle" else phase.start
            yield from _unrest(subject, motion, (place, phase), first)
        except Unmeasured as reason:
            yield T7.undecided((phase.actor,), reason)


def _unrest(subject: Subject, motion: Motion, named: tuple[int, Phase], first: int) -> Iterator[Finding]:
    place, phase = named
    if first >= phase.end:
        raise Unmeasured(f"{phase.name!r} is one frame long; rest shows in two")
    begin = f"{told(place, phase)} is to be at rest from frame {first} to {phase.end}, but"
    speeds = (
        motion.speeds(first, phase.end) if motion.deforms else motion.steps(first, phase.end) * motion.fps
    )
    speeds[np.isinf(speeds)] = np.nan  # where it comes to be
    if not np.isfinite(speeds).any():
        raise Unmeasured(f"there is nothing of it from frame {first} to {phase.end}")
    worst, most = int(np.nanargmax(speeds)), rest_speed(subject, motion)
    if speeds[worst] > most:
        what = "its points move with" if motion.deforms else "it moves with"
        yield T7.finding(
            (phase.actor,),
            f"{begin} {what} {speeds[worst]:.3g} m/s.",
            frame=first + 1 + worst,
            measured=float(speeds[worst]),
            tolerance=most,
            unit="m/s",
        )
    elif (
        phase.kind == "hold"
        and (off := float(np.linalg.norm(motion.displacements(first, phase.end)[-1]))) > most
    ):
        # So slow that no step shows it: as far as a thing at rest may go in a second.
        yield T7.finding(
            (phase.actor,),
            f"{begin} it drifts by {off:.3g} m.",
            frame=phase.end,
            measured=off,
            tolerance=most,
            unit="m",
        )
    if motion.deforms or not motion.is_followed:
        return
    rates = np.linalg.norm(motion.turning(first, phase.end), axis=1) * motion.fps
    worst = int(np.argmax(rates))
    if rates[worst] > subject.tolerances.rest_turn:
        yield T7.finding(
            (phase.actor,),
            f"{begin} it turns with {rates[worst]:.3g} rad/s.",
            frame=first + 1 + worst,
            measured=float(rates[worst]),
            tolerance=subject.tolerances.rest_turn,
            unit="rad/s",
        )


T7 = Rule(
    "T7",
    "settle",
    "hard",
    "A settle phase is at rest in its last second, or its last quarter if that is shorter; a hold phase stays.",
    "What trembles or creeps at the end was simulated too coarsely, or not long enough.",
    "Simulate longer, with more substeps, more damping or friction, or let bodies sleep; then bake again.",
    _rest,
    _ask_rest,
    needs_plan=True,
    tolerances=("rest_speed", "rest_turn"),
)
RULES = (T7,)
