"""Every rule, in the order in which they are reported."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.rules import (
    arrangement,
    attachment,
    comoves,
    contact,
    containment,
    framing,
    grounding,
    inventory,
    layout,
    mechanism,
    motion,
    parents,
    penetration,
    plausibility,
    position,
    rest,
    shape,
    stage,
    support,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agents.protocol.rule import Rule

_FAMILIES = "CGVWRT"  # layout, parents, geometry, warnings, plan against scene, motion


def _place(rule: Rule) -> tuple[int, int]:
    return _FAMILIES.index(rule.id[0]), int(rule.id[1:])


RULES: tuple[Rule, ...] = tuple(
    sorted(
        (
            *layout.RULES,
            *parents.RULES,
            *contact.RULES,
            *penetration.RULES,
            *grounding.RULES,
            *stage.RULES,
            *inventory.RULES,
            *shape.RULES,
            *support.RULES,
            *attachment.RULES,
            *containment.RULES,
            *position.RULES,
            *arrangement.RULES,
            *framing.RULES,
            *comoves.RULES,
            *mechanism.RULES,
            *motion.RULES,
            *plausibility.RULES,
            *rest.RULES,
        ),
        key=_place,
    )
)
BY_ID = {rule.id: rule for rule in RULES}
assert len(BY_ID) == len(RULES), "a rule is listed twice"


def chosen(wanted: Iterable[str]) -> tuple[Rule, ...]:
    """Rules by id (``V1``) or family (``C``), in order. Raises KeyError, naming what there is not."""
    names = [name.strip().upper() for name in wanted if name.strip()]
    for name in names:
        if name not in BY_ID and not any(rule.id[0] == name for rule in RULES):
            raise KeyError(name)
    return tuple(rule for rule in RULES if rule.id in names or rule.id[0] in names)
