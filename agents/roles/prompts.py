"""The roles' system prompts: the role's own text, the protocol, the shapes of answers, rules, the stage, its solvers.

The texts are the Markdown files beside this module (paper, "Implementation Details": a role file plus the documentation
of the scene protocol). A section that is headed "Making: …" is left out when a file is edited, one that is headed
"Editing: …" when a scene is made, one that is headed "Measuring: …" when there is no verifier. So is a line, or an item
of a list, that begins with "Making: " or "Editing: "; without this word, it is told in the other case.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from agents.plan.edit import EditPlan
from agents.plan.part import STAGES, Stage
from agents.plan.scene import ScenePlan
from agents.plan.tactical import Decision, FinalReview, Review, TacticalPlan
from agents.protocol.guide import builders_guide, format_stage_rules, guide, rules_guide
from agents.protocol.rules.catalogue import RULES, select_rules
from agents.protocol.rules_by_stage import rules_of
from agents.roles.sheets import sheet
from simworlds.schemas.notation import HOW_TO_READ, shape_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pydantic import BaseModel

    from agents.roles.names import Role
    from agents.roles.sheets import Solver

FOLDER = Path(__file__).with_name("prompts")
# What a role answers; the planner also writes the plan of the whole. What is read explains itself.
_ANSWERS: dict[Role, tuple[type[BaseModel], ...]] = {
    "planner": (TacticalPlan, Decision),
    "coder": (),
    "reviewer": (Review,),
    "final_reviewer": (FinalReview,),
}
# The rules that a stage's own work can break, which its coder is told; all that held before must still hold.
_TOLD_RULES: dict[Stage, tuple[str, ...]] = {
    "modeling": ("C", "G", "V", "W1", "W2", "W3", "R"),
    "uv": ("R2",),
    "texture": ("R1",),
    "deformation_setup": ("C3", "V", "W3", "R1", "R4", "R15"),
    "motion": ("V", "R7", "R15", "R18", "R19", "T"),
    "camera": ("W3", "W4", "W6", "R14"),
    "light": ("W3", "W5", "R14"),
    "render": ("V", "R14", "R15", "R19", "T"),
}
_FAMILIES = tuple(dict.fromkeys(rule.id[0] for rule in RULES))
_PLANNED = ("V", "W1", "R", "T")  # what a plan can break
_TOLD_AT_ONCE = ("V", "R", "T")  # grouping by the tool keeps the layout
_SIMULATING: tuple[Stage, ...] = (
    "deformation_setup",
    "motion",
)  # their coders get the sheets of the plan's solvers
_SECTION = re.compile(r"^(?=## )", re.MULTILINE)
_LINE = re.compile(r"^( *(?:- |\d+\. )?)(Making|Editing): (.*\n?)", re.MULTILINE)
_HOLE = re.compile(r"\{\{(\w+)\}\}")
_NO_EDITS = frozenset({"TacticalPlan.relations"})  # fields of answers that point to a scene plan
_AT_ONCE = "at_once"  # the text in place of a stage's, when there are none


def system_prompt(  # noqa: PLR0913 - all that a prompt depends on
    role: Role,
    stage: Stage | None = None,
    *,
    edit: bool = False,
    verifier: bool = True,
    staged: bool = True,
    solvers: Sequence[Solver] = (),
) -> tuple[str, ...]:
    """The parts of a role's system prompt, from what all runs share to what only this stage has.

    Each role gets what it needs: the planner the whole protocol and the shapes of plans, the coder what builders need
    of the protocol, the rules of its stage and the sheets of its ``solvers``, reviewers the shape of their answer.
    ``stage`` is for roles that work on a single one; ``edit``: a file is edited, no scene is made; without ``verifier``
    nothing is measured; not ``staged``: everything is built at once, in ``stage``.
    """
    parts = [role_text(role, edit=edit, verifier=verifier)]
    if role == "planner":
        parts += [protocol_text(edit=edit), rules_text(_PLANNED, edit=edit)]
    if role == "coder":
        parts.append(builders_guide(edit=edit))
    if _ANSWERS[role]:
        parts.append(shapes_text(role, edit=edit))
    if stage is None:
        return tuple(parts)
    if role == "coder" and verifier:
        parts.append(_stage_rules_text(stage, edit=edit, staged=staged))
    parts.append(
        stage_text(stage, edit=edit, verifier=verifier) if staged else _mode(f"{_AT_ONCE}.md", edit=edit)
    )
    if role == "coder" and (stage in _SIMULATING or not staged):
        parts += [sheet(solver) for solver in solvers]
    return tuple(parts)


def rules_text(
    names: Sequence[str] = _FAMILIES,
    stage: Stage = STAGES[-1],
    *,
    edit: bool = False,
    with_tolerances: bool = True,
) -> str:
    """Those rules of these ``names``, or families, that judge up to a stage."""
    told = select_rules(names)
    judging = [rule for rule in rules_of(stage, edit=edit) if rule in told]
    return rules_guide(judging, with_tolerances=with_tolerances, is_planned=not edit)


def _stage_rules_text(stage: Stage, *, edit: bool, staged: bool) -> str:
    """The rules that a coder is told of."""
    told = _TOLD_RULES[stage] if staged else _TOLD_AT_ONCE
    return (
        f"{rules_text(told, stage, edit=edit, with_tolerances=staged)}\n"
        "All else that held before is measured again; a finding explains its rule."
    )


@cache
def role_text(role: Role, *, edit: bool = False, verifier: bool = True) -> str:
    """What the role is, and how it works."""
    return _filled(
        _mode(f"{role}.md", edit=edit, verifier=verifier),
        stages="\n".join(f"- {stage_title(stage)}" for stage in STAGES),
    )


def team_text(*, edit: bool = False) -> str:
    """How one model is all roles, one after the other."""
    return _filled(_mode("team.md", edit=edit))


@cache
def stage_text(stage: Stage, *, edit: bool = False, verifier: bool = True) -> str:
    """What belongs into a stage, when it is done, what goes wrong in it, and which rules judge it."""
    text = _mode(f"stages/{stage}.md", edit=edit)
    if not verifier:
        return text
    return f"{text}\n\nRules that judge this stage: {format_stage_rules(stage, edit=edit)}."


def stage_title(stage: Stage) -> str:
    """A stage in a line: ``uv: coordinates for …``."""
    return _read(f"stages/{stage}.md").partition("\n")[0].removeprefix("# ")


@cache
def shapes_text(role: Role, *, edit: bool = False) -> str:
    """The shapes of what a role answers, without what the protocol's guide tells."""
    plans = (EditPlan if edit else ScenePlan,) if role == "planner" else ()
    before = protocol_text(edit=edit) if plans else ""
    told = shape_of(*plans, *_ANSWERS[role], before=before, without=_NO_EDITS if edit else ())
    return f"# Shapes of answers\n\nJSON. {HOW_TO_READ}\n\n```\n{told}\n```"


@cache
def protocol_text(*, edit: bool = False) -> str:
    """The words of the scene protocol: levels, tags, relations."""
    return guide(edit=edit)


def _mode(name: str, *, edit: bool, verifier: bool = True) -> str:
    """A file without the sections and lines of the other modes."""
    left_out = ("## Making:" if edit else "## Editing:", *(() if verifier else ("## Measuring:",)))
    text = "".join(one for one in _SECTION.split(_read(name)) if not one.startswith(left_out))
    mode = "Editing" if edit else "Making"
    return _LINE.sub(lambda line: f"{line[1]}{line[3]}" if line[2] == mode else "", text).strip()


@cache
def _read(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8").strip()


def _filled(text: str, **values: str) -> str:
    """``text`` with each ``{{name}}`` replaced. Raises KeyError for one that nothing is known of."""
    return _HOLE.sub(lambda hole: values[hole[1]], text).strip()
