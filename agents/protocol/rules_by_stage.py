"""The rules that judge each stage: those whose subject is built by then. What held once must keep holding."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.plan.part import STAGES
from agents.protocol.rules.catalogue import RULES

if TYPE_CHECKING:
    from agents.plan.part import Stage
    from agents.protocol.rule import Rule

# Rule or family → the stage that builds what it judges. All others judge from the first stage on.
FIRST_STAGES: dict[str, Stage] = {
    "R15": "deformation_setup",
    "R18": "motion",
    "R19": "motion",
    "T": "motion",
    "R14": "camera",
    "W4": "camera",
    "W6": "camera",
    "W5": "light",
}
_LAYOUT_FAMILIES = frozenset("CG")  # they hold only for files that follow the protocol throughout


def first_stage(rule: Rule) -> Stage:
    """The first stage that a rule judges."""
    return FIRST_STAGES.get(rule.id) or FIRST_STAGES.get(rule.id[0]) or STAGES[0]


def rules_of(stage: Stage, *, edit: bool = False, tagged: bool = True) -> tuple[Rule, ...]:
    """The rules by which the scene is judged at the end of a stage, in the catalogue's order.

    ``edit``: the file is edited; there is no scene plan, so the rules that need one are left out. If the file is not
    ``tagged`` (does not follow the protocol), the layout rules are left out too: an edit may tag what it animates,
    which does not make the whole file a protocol scene.
    """
    built = STAGES[: STAGES.index(stage) + 1]
    left_out = _LAYOUT_FAMILIES if edit and not tagged else frozenset[str]()
    return tuple(
        rule
        for rule in RULES
        if first_stage(rule) in built and rule.id[0] not in left_out and not (edit and rule.needs_plan)
    )
