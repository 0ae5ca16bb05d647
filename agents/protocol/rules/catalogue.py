"""All rules, in the order in which they are reported."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.rules.motion import baking, comoves, matter, mechanism, plausibility, settle, timing
from agents.protocol.rules.planned import (
    arrangement,
    attachment,
    containment,
    framing,
    inventory,
    position,
    shape,
    support,
)
from agents.protocol.rules.scene import (
    collection_layout,
    contact,
    grounding,
    lights_and_cameras,
    parents,
    penetration,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agents.protocol.rule import Rule

_FAMILIES = "CGVWRT"  # layout, parents, geometry, warnings, plan against scene, motion
_SCENE = (collection_layout, parents, contact, penetration, grounding, lights_and_cameras)
_PLANNED = (inventory, shape, support, attachment, containment, position, arrangement, framing)
_MOTION = (comoves, mechanism, baking, timing, plausibility, settle, matter)


def _order(rule: Rule) -> tuple[int, int]:
    return _FAMILIES.index(rule.id[0]), int(rule.id[1:])


RULES: tuple[Rule, ...] = tuple(
    sorted((rule for module in (*_SCENE, *_PLANNED, *_MOTION) for rule in module.RULES), key=_order)
)
BY_ID = {rule.id: rule for rule in RULES}
assert len(BY_ID) == len(RULES), "two rules have the same id"


def select_rules(wanted: Iterable[str]) -> tuple[Rule, ...]:
    """Rules by id (``V1``) or family (``C``), in order. Raises KeyError with the name of a rule that does not exist."""
    names = [name.strip().upper() for name in wanted if name.strip()]
    for name in names:
        if name not in BY_ID and not any(rule.id[0] == name for rule in RULES):
            raise KeyError(name)
    return tuple(rule for rule in RULES if rule.id in names or rule.id[0] in names)
