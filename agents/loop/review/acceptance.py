"""What a run has to fulfil: the acceptance of all its tactical plans, carried to the stage that can judge it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from simworlds.terminal.text import shortened

if TYPE_CHECKING:
    from agents.plan.acceptance import AcceptanceAnswer
    from agents.plan.part import Stage
    from agents.plan.tactical import Review, TacticalPlan

_EVIDENCE = 160  # letters of a stage's evidence that the final reviewer reads


@dataclass(slots=True)
class AcceptanceRecord:
    """The lines of closed stages, each with the stage that judged it last and its answer."""

    _judged: dict[str, tuple[Stage, AcceptanceAnswer]] = field(
        default_factory=dict[str, "tuple[Stage, AcceptanceAnswer]"]
    )

    def with_lines_due(self, tactic: TacticalPlan) -> TacticalPlan:
        """The plan of a stage with the lines that earlier stages have left to it."""
        due = (line for line, (_, answer) in self._judged.items() if _is_left_to(answer, tactic.stage))
        lines = tuple(dict.fromkeys((*tactic.acceptance, *due)))
        return tactic if lines == tactic.acceptance else tactic.model_copy(update={"acceptance": lines})

    def close(self, tactic: TacticalPlan, review: Review) -> None:
        """Keeps what the review that closed a stage says of each line of its plan."""
        for answer in review.acceptance:
            self._judged[tactic.acceptance[answer.line - 1]] = (tactic.stage, answer)

    @property
    def lines(self) -> tuple[str, ...]:
        """All lines, in the order in which they were planned."""
        return tuple(self._judged)

    def described(self) -> list[str]:
        """All lines, each with what its stage's reviewer said of it."""
        return [
            f"{line} (stage {stage}: {answer.verdict}, {shortened(answer.evidence, _EVIDENCE)})"
            for line, (stage, answer) in self._judged.items()
        ]


def _is_left_to(answer: AcceptanceAnswer, stage: Stage) -> bool:
    return answer.verdict == "later" and answer.stage == stage
