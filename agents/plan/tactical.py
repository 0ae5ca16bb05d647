"""What is to be done in one stage, and what is decided after it (paper, "Per-Stage Execution Loop")."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from agents.plan.part import Name, Part, Stage


class Asset(Part):
    """Something that the stage is to realise: for which object, and how it is known to be done."""

    target: Name
    task: str = Field(min_length=1, max_length=2000)


class TacticalPlan(Part):
    """The plan of one stage. ``questions`` are for the reviewer, who sees previews and the scene's readout."""

    stage: Stage
    goal: str = Field(min_length=1, max_length=2000)
    assets: tuple[Asset, ...] = ()
    relations: tuple[int, ...] = Field(
        default=(), description="Relations to satisfy, by their place in the scene plan."
    )
    acceptance: tuple[str, ...] = Field(default=(), description="What must hold when the stage is closed.")
    questions: tuple[str, ...] = Field(default=(), description="What the reviewer is to judge by eye.")


class Decision(Part):
    """What becomes of a stage. ``advance`` is never taken while a hard rule fails or a review blocks."""

    transition: Literal["advance", "retry", "replan", "abort"]
    reason: str = Field(min_length=1, max_length=2000)
    instructions: str = Field(
        default="", max_length=8000, description="For a retry: what the coder is to mend."
    )

    @model_validator(mode="after")
    def _retry_says_what(self) -> Decision:
        if self.transition == "retry" and not self.instructions.strip():
            raise ValueError("instructions: a retry needs to say what is to be mended")
        return self


class Judgement(Part):
    """The reviewer's answer to one question."""

    question: str
    holds: bool
    evidence: str = Field(max_length=2000)


class Review(Part):
    """What a reviewer found. ``blocking`` keeps the stage from being closed."""

    judgements: tuple[Judgement, ...]
    blocking: bool
    summary: str = Field(max_length=4000)


class FinalReview(Part):
    """The verdict on the rendered result."""

    verdict: Literal["accept", "needs_fix"]
    summary: str = Field(max_length=4000)
    instructions: str = Field(default="", max_length=8000)

    @model_validator(mode="after")
    def _fix_says_what(self) -> FinalReview:
        if self.verdict == "needs_fix" and not self.instructions.strip():
            raise ValueError("instructions: needs_fix must say what is to be mended")
        return self
