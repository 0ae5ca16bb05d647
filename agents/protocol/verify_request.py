"""What a caller asks the verifier for: rules by their names, and the plan that they go by."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from agents.plan.check import read_plan
from agents.plan.faults import Fault
from agents.protocol.rules.catalogue import RULES, chosen
from agents.protocol.tolerances import TOLERANCES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.plan.scene import ScenePlan
    from agents.protocol.rule import Rule


def rules_named(names: Sequence[str] | None) -> tuple[Rule, ...]:
    """Rules by id (``V1``) or family (``C``); all of them for None. Raises ValueError, with a sentence."""
    if names is None:
        return RULES
    try:
        found = chosen(names)
    except KeyError as error:
        known = ", ".join(rule.id for rule in RULES)
        raise ValueError(f"There is no rule {error.args[0]!r}. There are: {known}.") from error
    if not found:
        raise ValueError("No rule is named.")
    return found


def plan_from(given: bytes | dict[str, Any]) -> tuple[ScenePlan | None, list[Fault]]:
    """A plan from JSON that rules can go by; None, and its faults, if it is none."""
    plan, faults = read_plan(given)
    if plan is not None:
        faults = [Fault("tolerances", f"{one}.") for one in TOLERANCES.tightened(plan.tolerances)[1]]
    return (None if faults else plan), faults
