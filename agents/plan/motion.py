"""The motion plan: which actor moves, when, how, how far, and what causes it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from agents.plan.part import Frame, Metres, Name, PlanPart, Vector

PhaseKind = Literal[
    "hold", "translate", "rotate", "fall", "slide", "roll", "topple", "swing", "bounce", "deform", "flow", "emit",
    "settle",
]  # fmt: skip


class MotionPhase(PlanPart):
    """One actor's motion from ``start`` to ``end`` (frames, both included).

    ``extent`` is the displacement of the actor's centre in metres (for a deforming actor: the mean displacement of its
    vertices), ``direction`` the direction of motion in the world, ``turn`` the rotation in degrees, ``amplitude`` the
    largest distance from the starting point, in metres. ``cause`` names the phase that triggers this one.
    """

    name: Name
    actor: Name
    kind: PhaseKind
    start: Frame
    end: Frame
    direction: Vector | None = None
    extent: Annotated[float, Field(ge=0, le=1e5)] | None = None
    turn: Annotated[float, Field(ge=-36_000, le=36_000)] | None = None
    amplitude: Annotated[float, Field(ge=0, le=1e5)] | None = None
    top_speed: Annotated[Metres, Field(ge=0)] | None = Field(default=None, description="Metres per second.")
    cause: Name | None = None

    @model_validator(mode="after")
    def _consistent(self) -> MotionPhase:
        if self.end < self.start:
            raise ValueError(f"end: frame {self.end} is before the start frame, {self.start}")
        if self.direction is not None and not any(self.direction):
            raise ValueError(
                "direction: (0, 0, 0) has no direction; leave the field out, or give a direction"
            )
        return self


class MotionPlan(PlanPart):
    """All phases, in any order. A still scene has none."""

    phases: tuple[MotionPhase, ...] = ()
