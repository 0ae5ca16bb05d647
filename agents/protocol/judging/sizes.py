"""Sizes of groups of objects, by the facts: what tolerances are scaled by. Metres."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING

from agents.protocol.facts import WorldBox

if TYPE_CHECKING:
    from agents.protocol.measures.requests import Names
    from agents.protocol.rule import RuleContext


def contact_gap(context: RuleContext, *groups: Names) -> float:
    """ε for contacts between some groups of meshes."""
    return context.tolerances.contact_gap(smallest_diagonal(context, *groups))


def smallest_diagonal(context: RuleContext, *groups: Names) -> float:
    """The diagonal of the smallest box around a mesh of the groups; 0 if there is none.

    Each mesh counts by itself: a table's leg must be as close to the floor however large the table is.
    """
    objects = context.structure.objects
    boxes = (objects[name].box for names in groups for name in names)
    return min((box.diagonal for box in boxes if box is not None), default=0.0)


def diagonal_around(context: RuleContext, names: Names) -> float:
    """The diagonal of the box around all of some meshes; 0 if there is none."""
    objects = context.structure.objects
    boxes = [box for name in names if (box := objects[name].box) is not None]
    return reduce(WorldBox.joined, boxes).diagonal if boxes else 0.0


def smallest_dimension(context: RuleContext, *groups: Names) -> float:
    """The smallest dimension of any object of the groups; 0 if none has one."""
    objects = context.structure.objects
    sizes = [
        size for names in groups for name in names for size in objects[name].dimensions or () if size > 0
    ]
    return min(sizes, default=0.0)
