"""Which rules judge which stage: those whose subject is built by then. What holds once must go on to hold."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.plan.part import STAGES
from agents.protocol.rules.catalogue import RULES

if TYPE_CHECKING:
    from agents.plan.part import Stage
    from agents.protocol.rule import Rule

# Rule, or family → the stage that builds what it judges; all others judge from the first stage on.
FROM: dict[str, Stage] = {"R15": "motion", "R18": "motion", "T": "motion", "R14": "camera"}
LAYOUT = frozenset("CG")  # the families that hold of a whole file that is built by the protocol


def begins(rule: Rule) -> Stage:
    """The first stage that a rule judges."""
    return FROM.get(rule.id) or FROM.get(rule.id[0]) or STAGES[0]


def rules_of(stage: Stage, *, edit: bool = False, tagged: bool = True) -> tuple[Rule, ...]:
    """The rules by which the scene is judged at the end of a stage, in the catalogue's order.

    ``edit``: a file that is edited has no scene plan, so the rules that compare with one have nothing to judge. If it
    is not ``tagged`` (does not follow the protocol), those of its layout stay out too: an edit may tag what it sets
    in motion, which does not make the whole file a scene of the protocol.
    """
    built = STAGES[: STAGES.index(stage) + 1]
    out = LAYOUT if edit and not tagged else frozenset[str]()
    return tuple(
        rule
        for rule in RULES
        if begins(rule) in built and rule.id[0] not in out and not (edit and rule.needs_plan)
    )
