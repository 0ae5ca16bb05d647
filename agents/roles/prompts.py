"""The roles' system prompts: the role's own text, the protocol, the shapes of what is read and answered, the stage.

The texts are the Markdown files beside this module (paper, "Implementation Details": a role file plus the documentation
of the scene protocol). A section that is headed "Making: …" is left out when a file is edited, one that is headed
"Editing: …" when a scene is made.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from agents.plan.edit import EditPlan
from agents.plan.part import STAGES, Stage
from agents.plan.scene import ScenePlan
from agents.plan.tactical import Decision, FinalReview, Review, TacticalPlan
from agents.protocol.guide import format_stage_rules, guide, rules_guide
from simworlds.schemas.notation import shape_of

if TYPE_CHECKING:
    from pydantic import BaseModel

Role = Literal["planner", "coder", "reviewer", "final_reviewer"]
ROLES: tuple[Role, ...] = ("planner", "coder", "reviewer", "final_reviewer")

FOLDER = Path(__file__).with_name("prompts")
# What a role answers; the planner also writes the plan of the whole. What is read explains itself.
_ANSWERS: dict[Role, tuple[type[BaseModel], ...]] = {
    "planner": (TacticalPlan, Decision),
    "coder": (),
    "reviewer": (Review,),
    "final_reviewer": (FinalReview,),
}
_SECTION = re.compile(r"^(?=## )", re.MULTILINE)
_ONLY = {True: "## Making:", False: "## Editing:"}  # what is left out
_HOLE = re.compile(r"\{\{(\w+)\}\}")


def system_prompt(role: Role, stage: Stage | None = None, *, edit: bool = False) -> tuple[str, ...]:
    """The parts of a role's system prompt, from what all runs share to what only this stage has.

    Each role gets what it needs: the planner the whole protocol and the shapes of plans, the coder the protocol with
    the rules of its stage, reviewers the shape of their answer. ``stage`` is for roles that work on a single one;
    ``edit``: a file is edited, no scene is made.
    """
    parts = [role_text(role, edit=edit)]
    if role == "planner":
        parts += [protocol_text(), rules_guide()]
    if role == "coder":
        parts.append(guide(with_relations=False))
    if _ANSWERS[role]:
        parts.append(shapes_text(role, edit=edit))
    if stage and role == "coder":
        parts.append(rules_guide(stage, edit=edit))
    if stage:
        parts.append(stage_text(stage, edit=edit))
    return tuple(parts)


@cache
def role_text(role: Role, *, edit: bool = False) -> str:
    """What the role is, and how it works."""
    return _filled(
        _mode(f"{role}.md", edit=edit), stages="\n".join(f"- {stage_title(stage)}" for stage in STAGES)
    )


def team_text(*, edit: bool = False) -> str:
    """How one model is all roles, one after the other."""
    return _filled(_mode("team.md", edit=edit))


@cache
def stage_text(stage: Stage, *, edit: bool = False) -> str:
    """What belongs into a stage, when it is done, what goes wrong in it, and which rules judge it."""
    return f"{_read(f'stages/{stage}.md')}\n\nRules that judge this stage: {format_stage_rules(stage, edit=edit)}."


def stage_title(stage: Stage) -> str:
    """A stage in a line: ``uv: coordinates for …``."""
    return _read(f"stages/{stage}.md").partition("\n")[0].removeprefix("# ")


@cache
def shapes_text(role: Role, *, edit: bool = False) -> str:
    """The shapes of what a role answers, without what the protocol's guide tells."""
    plans = (EditPlan if edit else ScenePlan,) if role == "planner" else ()
    told = shape_of(*plans, *_ANSWERS[role], before=protocol_text() if plans else "")
    return (
        "# Shapes of answers\n\n"
        "JSON, written as types: `name?` may be left out and is then the value behind `=`, or null; what stands behind "
        f"`//` is its meaning. No other fields are taken.\n\n```\n{told}\n```"
    )


@cache
def protocol_text() -> str:
    """The words of the scene protocol: levels, tags, relations."""
    return guide()


def _mode(name: str, *, edit: bool) -> str:
    """A file without the sections of the other mode."""
    return "".join(one for one in _SECTION.split(_read(name)) if not one.startswith(_ONLY[edit]))


@cache
def _read(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8").strip()


def _filled(text: str, **values: str) -> str:
    """``text`` with each ``{{name}}`` replaced. Raises KeyError for one that nothing is known of."""
    return _HOLE.sub(lambda hole: values[hole[1]], text).strip()
