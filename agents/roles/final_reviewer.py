"""The final reviewer: one look at the rendered result (paper, "Final Render and Review")."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.plan.tactical import FinalReview
from agents.roles.base import Conversation
from agents.roles.prompts import system_prompt

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.roles.base import RoleContext
    from simworlds.llm.messages import Block

NAME = "final_reviewer"
_LOOK = """\
{plan}

The result, rendered. Judge it against the plan, and give your verdict, as one JSON object."""


def final_review(
    context: RoleContext, plan: str, shown: Sequence[Block | str], *, edit: bool = False
) -> FinalReview:
    """The verdict on frames of the rendering. Raises ModelError; Misfit when no answer fits."""
    talk = Conversation(context, NAME, system_prompt(NAME, edit=edit))
    return talk.data("render", FinalReview, _LOOK.format(plan=plan), *shown)
