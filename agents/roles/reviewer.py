"""The reviewer: a fresh session for each stage, which sees previews and readouts and changes nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from agents.plan.acceptance import faults_of_answers, format_numbered
from agents.plan.tactical import Review
from agents.roles.base import Conversation, plan_json
from agents.roles.prompts import system_prompt
from simworlds.llm.structured import fits

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.plan.part import Stage
    from agents.plan.tactical import TacticalPlan
    from agents.roles.base import RoleContext
    from simworlds.llm.messages import Block

NAME = "reviewer"
_LOOK = """\
{plan}

Attempt {attempt} of the stage {stage} is over. Its tactical plan, whose questions you are to answer:
{tactic}

{acceptance}What there is to see; look closer with your tools where you need to. Then give your review, as one JSON \
object."""


_ACCEPTANCE = """\
The lines of its acceptance, each to be answered in `acceptance` by its number:
{lines}

"""


class Reviewer:
    """One stage's reviewer. Raises ModelError; Misfit when no answer fits."""

    def __init__(self, context: RoleContext, stage: Stage, plan: str, *, edit: bool = False) -> None:
        self._stage: Stage = stage
        self._plan = plan
        self._talk = Conversation(
            context, NAME, system_prompt(NAME, stage, edit=edit), context.tools(NAME, stage)
        )

    def review(self, tactic: TacticalPlan, attempt: int, evidence: Sequence[Block | str]) -> Review:
        """The judgement on an attempt, by previews and readouts."""

        def reader(data: Any) -> tuple[Review | None, Sequence[object]]:
            review, problems = fits(Review)(data)
            if review is None:
                return None, problems
            faults = faults_of_answers(review.acceptance, len(lines), self._stage)
            if len(review.judgements) < len(tactic.questions):
                asked, given = len(tactic.questions), len(review.judgements)
                faults.append(f"judgements: {asked} questions were asked, {given} are answered.")
            return (None, faults) if faults else (review, ())

        lines = tactic.acceptance
        words = _LOOK.format(
            plan=self._plan,
            attempt=attempt,
            stage=self._stage,
            tactic=plan_json(tactic.model_copy(update={"acceptance": ()})),
            acceptance=_ACCEPTANCE.format(lines=format_numbered(lines)) if lines else "",
        )
        return self._talk.work_then_data(
            self._stage, Review, words, *evidence, reader=reader, pinned=(self._plan,)
        )
