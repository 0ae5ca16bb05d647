"""The motion plan: who moves when, how, how far, and because of what."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from agents.plan.part import Frame, Metres, Name, Part, Vector

MotionKind = Literal[
    "hold", "translate", "rotate", "fall", "slide", "roll", "topple", "swing", "bounce", "deform", "flow", "emit",
    "settle",
]  # fmt: skip


class Phase(Part):
    """One actor's motion from ``start`` to ``end`` (frames, both included).

    ``extent`` is the displacement of the actor's centre in metres (of a deforming one: of its vertices on average),
    ``direction`` the way it goes in the world, ``turn`` the angle it turns in degrees, ``amplitude`` the greatest
    distance from where the phase begins, in metres. ``cause`` names the phase that sets this one off.
    """

    name: Name
    actor: Name
    kind: MotionKind
    start: Frame
    end: Frame
    direction: Vector | None = None
    extent: Annotated[float, Field(ge=0, le=1e5)] | None = None
    turn: Annotated[float, Field(ge=-36_000, le=36_000)] | None = None
    amplitude: Annotated[float, Field(ge=0, le=1e5)] | None = None
    top_speed: Annotated[Metres, Field(ge=0)] | None = Field(default=None, description="Metres per second.")
    cause: Name | None = None

    @model_validator(mode="after")
    def _sound(self) -> Phase:
        if self.end < self.start:
            raise ValueError(f"end: frame {self.end} is before the start, {self.start}")
        if self.direction is not None and not any(self.direction):
            raise ValueError("direction: (0, 0, 0) is none; leave it out")
        return self


class MotionPlan(Part):
    """All phases, in any order. No phases: a still scene."""

    phases: tuple[Phase, ...] = ()
