"""The plan of one stage, and the decisions and reviews that close it (paper, "Per-Stage Execution Loop")."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field, model_validator

from agents.plan.acceptance import AcceptanceAnswer
from agents.plan.part import Name, PlanPart, Stage

if TYPE_CHECKING:
    from agents.protocol.findings import Finding


class Asset(PlanPart):
    """One task of the stage: which object it builds or changes, and what to do."""

    target: Name
    task: str = Field(min_length=1, max_length=2000)


class TacticalPlan(PlanPart):
    """The plan of one stage. ``questions`` go to the reviewer, who sees previews and the scene's state."""

    stage: Stage
    goal: str = Field(min_length=1, max_length=2000)
    assets: tuple[Asset, ...] = ()
    relations: tuple[int, ...] = Field(
        default=(), description="Relations to satisfy, by their index in the scene plan."
    )
    acceptance: tuple[str, ...] = Field(default=(), description="What must be true at the end of the stage.")
    questions: tuple[str, ...] = Field(default=(), description="What the reviewer must judge by eye.")


class Withdrawal(PlanPart):
    """What the plan states and cannot be held to, by the rule that finds it broken and the objects of its finding."""

    rule: str = Field(pattern=r"^[RT]\d+$", description="A rule that compares with the plan: R…, T….")
    objects: tuple[str, ...] = Field(min_length=1, description="Objects of the finding, as it names them.")
    says: str = Field(
        default="",
        max_length=200,
        description="Words of its message; others stay.",
    )

    def covers(self, finding: Finding) -> bool:
        """Whether a finding is about this."""
        return (
            finding.rule == self.rule
            and set(self.objects) <= set(finding.objects)
            and self.says in finding.message
        )

    def __str__(self) -> str:
        return f"{self.rule} {', '.join(self.objects)}" + (f" ({self.says})" if self.says else "")


class Decision(PlanPart):
    """What happens after an attempt that leaves a stage open."""

    transition: Literal["retry", "replan", "withdraw", "abort"]
    reason: str = Field(min_length=1, max_length=2000)
    instructions: str = Field(
        default="", max_length=8000, description="For a retry: what the coder must fix."
    )
    tactic: TacticalPlan | None = Field(default=None, description="For a replan: the stage's new plan.")
    withdraw: tuple[Withdrawal, ...] = Field(
        default=(), description="To withdraw: hard findings that the plan is wrong about."
    )

    @model_validator(mode="after")
    def _says_what(self) -> Decision:
        if self.transition == "retry" and not self.instructions.strip():
            raise ValueError("instructions: a retry must say what to fix")
        if self.transition == "withdraw" and not self.withdraw:
            raise ValueError("withdraw: name the findings, each by its rule and objects")
        return self


class FilmDecision(PlanPart):
    """What happens before the film is rendered, once its frames have been seen. ``mend`` is possible once."""

    transition: Literal["film", "mend"]
    reason: str = Field(min_length=1, max_length=2000)
    instructions: str = Field(
        default="", max_length=8000, description="For mend: what the coder must change."
    )

    @model_validator(mode="after")
    def _mend_says_what(self) -> FilmDecision:
        if self.transition == "mend" and not self.instructions.strip():
            raise ValueError("instructions: mend must say what to change")
        return self


class ReviewAnswer(PlanPart):
    """The reviewer's answer to one question."""

    question: str
    holds: bool
    evidence: str = Field(max_length=2000)


class Review(PlanPart):
    """A reviewer's answers. ``blocking`` keeps the stage open."""

    judgements: tuple[ReviewAnswer, ...]
    acceptance: tuple[AcceptanceAnswer, ...] = ()
    blocking: bool
    summary: str = Field(max_length=4000)

    @property
    def blocks(self) -> bool:
        """Whether it keeps the stage open: by its own word, or by a line of ``acceptance`` that fails."""
        return self.blocking or any(answer.verdict == "fails" for answer in self.acceptance)


class FinalReview(PlanPart):
    """The verdict on the rendered result."""

    verdict: Literal["accept", "needs_fix"]
    acceptance: tuple[AcceptanceAnswer, ...] = ()
    summary: str = Field(max_length=4000)
    instructions: str = Field(default="", max_length=8000)

    @model_validator(mode="after")
    def _fix_says_what(self) -> FinalReview:
        if self.verdict == "needs_fix" and not self.instructions.strip():
            raise ValueError("instructions: needs_fix must say what to fix")
        return self
