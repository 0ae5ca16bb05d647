"""Answers to the lines of ``acceptance`` of a tactical plan: each holds, fails, or is left to a later stage."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Literal

from pydantic import Field, model_validator

from agents.plan.part import STAGES, PlanPart, Stage

if TYPE_CHECKING:
    from collections.abc import Sequence

Verdict = Literal["holds", "fails", "later"]


class AcceptanceAnswer(PlanPart):
    """The answer to a line of ``acceptance``, by its number. ``fails`` keeps the stage open."""

    line: int = Field(ge=1)
    verdict: Verdict
    source: Literal["picture", "number", "finding"] | None = None
    evidence: str = Field(min_length=1, max_length=2000)
    stage: Stage | None = Field(default=None, description="For `later`: which.")

    @model_validator(mode="after")
    def _has_its_evidence(self) -> AcceptanceAnswer:
        if self.verdict == "later" and self.stage is None:
            raise ValueError("stage: `later` must say which stage can judge the line")
        if self.verdict != "later" and self.source is None:
            raise ValueError("source: say whether a picture, a number or a finding shows it")
        return self


def faults_of_answers(answers: Sequence[AcceptanceAnswer], count: int, stage: Stage = "render") -> list[str]:
    """Sentences about what is wrong with the answers to ``count`` lines at the end of a stage; [] for none."""
    numbers = Counter(answer.line for answer in answers)
    missing = [str(line) for line in range(1, count + 1) if not numbers[line]]
    faults = [f"acceptance: not answered: {', '.join(missing)}."] if missing else []
    faults += [
        f"acceptance: line {line} is answered {times} times." for line, times in numbers.items() if times > 1
    ]
    faults += [f"acceptance: there is no line {line}; there are {count}." for line in numbers if line > count]
    left = (answer for answer in answers if answer.verdict == "later" and answer.stage is not None)
    faults += [
        f"acceptance: line {answer.line} cannot be left to {answer.stage}, which is not after {stage}."
        for answer in left
        if STAGES.index(answer.stage or stage) <= STAGES.index(stage)
    ]
    return faults


def format_numbered(lines: Sequence[str]) -> str:
    """The lines with the numbers by which they are answered."""
    return "\n".join(f"{number}. {line}" for number, line in enumerate(lines, 1))
