"""Whether planned falls fit their time, their speed, and the ground below. Metres, seconds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agents.plan.faults import Fault

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.boxes import PlannedBox
    from agents.plan.motion import MotionPhase
    from agents.plan.scene import ScenePlan

_GRAVITY = 9.81
_MORE = 1.15  # times as far as gravity takes it: no rounding to frames any more
_FASTER = 1.5  # times the planned top speed, as the verifier has it


def fall_doubts(plan: ScenePlan, boxes: dict[str, PlannedBox]) -> Iterator[Fault]:
    """Phases that fall farther than their frames allow, faster than planned, or through the ground."""
    for place, phase in enumerate(plan.motion.phases):
        if phase.kind == "fall" and phase.extent:
            for why in _doubts(plan, boxes, phase, phase.extent):
                yield Fault(f"motion.phases[{place}]", why)


def _doubts(
    plan: ScenePlan, boxes: dict[str, PlannedBox], phase: MotionPhase, extent: float
) -> Iterator[str]:
    seconds = (phase.end - phase.start) / plan.fps
    if extent > _MORE * _GRAVITY * seconds**2 / 2 and not _moves_before(plan, phase):
        needed = math.sqrt(2 * extent / _GRAVITY)
        yield (
            f"a fall of {extent:g} m from rest takes {needed:.2f} s, {math.ceil(needed * plan.fps)} frames at "
            f"{plan.fps} fps; the phase has {phase.end - phase.start}."
        )
    speed = math.sqrt(2 * _GRAVITY * extent)
    if phase.top_speed is not None and speed > _FASTER * phase.top_speed:
        yield f"a fall of {extent:g} m reaches {speed:.2g} m/s; top_speed is {phase.top_speed:g} m/s."
    box = boxes.get(phase.actor)
    floors = [floor for floor in boxes.values() if floor.is_ground and floor is not box]
    if box is None or not floors or _moves_before(plan, phase):
        return
    room = box.low[2] - min(floor.low[2] for floor in floors)
    if extent > room + box.slack:
        yield f"{box.name!r} falls {extent:g} m, but is only {max(0.0, room):.3g} m above the ground's underside."


def _moves_before(plan: ScenePlan, phase: MotionPhase) -> bool:
    """Whether an actor moves in an earlier phase, so that it may have a speed, or be elsewhere."""
    return any(
        other.actor == phase.actor and other.start < phase.start and other.kind != "hold"
        for other in plan.motion.phases
    )
