"""What a caller gives the verifier: names of rules, and a plan."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from agents.plan.check import read_plan
from agents.plan.faults import Fault
from agents.protocol.rules.catalogue import RULES, select_rules
from agents.protocol.tolerances import TOLERANCES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.plan.scene import ScenePlan
    from agents.protocol.rule import Rule


def rules_named(names: Sequence[str] | None) -> tuple[Rule, ...]:
    """Rules by id (``V1``) or family (``C``); all rules for None. Raises ValueError with a sentence."""
    if names is None:
        return RULES
    try:
        rules = select_rules(names)
    except KeyError as error:
        known = ", ".join(rule.id for rule in RULES)
        raise ValueError(f"There is no rule {error.args[0]!r}. The rules are: {known}.") from error
    if not rules:
        raise ValueError("No rule is named. Name rules (V1) or families (C).")
    return rules


def plan_from(data: bytes | dict[str, Any]) -> tuple[ScenePlan | None, list[Fault]]:
    """A plan from JSON, with tolerances that the rules accept; (None, faults) if it has faults."""
    plan, faults = read_plan(data)
    if plan is not None:
        faults = [Fault("tolerances", f"{reason}.") for reason in TOLERANCES.tightened(plan.tolerances)[1]]
    return (None if faults else plan), faults
