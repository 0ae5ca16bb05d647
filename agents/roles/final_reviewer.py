"""The final reviewer: one look at the rendered result (paper, "Final Render and Review")."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from agents.plan.acceptance import faults_of_answers, format_numbered
from agents.plan.tactical import FinalReview
from agents.roles.base import Conversation
from agents.roles.prompts import system_prompt
from simworlds.llm.structured import fits

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.roles.base import RoleContext
    from simworlds.llm.messages import Block

NAME = "final_reviewer"
_LOOK = """\
{plan}

{acceptance}The result, rendered. Judge it against the plan, and give your verdict, as one JSON object."""
_ACCEPTANCE = """\
What the stages were to fulfil, and what their reviewers said. Answer each line in `acceptance` by its number, as you \
see it now; where the rendering cannot show it, go by what was said:
{lines}

"""


def final_review(
    context: RoleContext,
    plan: str,
    shown: Sequence[Block | str],
    lines: Sequence[str] = (),
    *,
    edit: bool = False,
) -> FinalReview:
    """The verdict on frames of the rendering, and on each of the ``lines`` of acceptance.

    Raises ModelError; Misfit when no answer fits.
    """

    def reader(data: Any) -> tuple[FinalReview | None, Sequence[object]]:
        review, problems = fits(FinalReview)(data)
        if review is None:
            return None, problems
        faults = faults_of_answers(review.acceptance, len(lines))
        return (None, faults) if faults else (review, ())

    talk = Conversation(context, NAME, system_prompt(NAME, edit=edit))
    acceptance = _ACCEPTANCE.format(lines=format_numbered(lines)) if lines else ""
    words = _LOOK.format(plan=plan, acceptance=acceptance)
    return talk.data("render", FinalReview, words, *shown, reader=reader)
