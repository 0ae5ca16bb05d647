"""What objects declare of their mechanism, by their tags or else by the plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.rule import NotApplicable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.scene import PlannedObject
    from agents.protocol.findings import Finding
    from agents.protocol.rule import Rule, RuleContext
    from agents.protocol.structure import LogicalObject


def declared_objects(context: RuleContext) -> list[tuple[LogicalObject, str | None, str | None]]:
    """(object, deformation_kind, motion_kind) of all that declare any. Raises NotApplicable."""
    kinds = [(obj, *_declared(context, obj)) for obj in context.structure.logical_objects]
    declared = [entry for entry in kinds if any(entry[1:])]
    if not declared:
        raise NotApplicable("no object declares how it is deformed or moved")
    return declared


def planned_object(context: RuleContext, obj: LogicalObject) -> PlannedObject | None:
    """What the plan says of an object."""
    return context.plan.object(obj.name) if context.plan else None


def _declared(context: RuleContext, obj: LogicalObject) -> tuple[str | None, str | None]:
    """(deformation_kind, motion_kind) of an object's tags, or of the plan where a tag is missing."""
    planned = planned_object(context, obj)
    deformation, motion = planned.mechanism if planned else (None, None)
    return obj.collection.deformation_kind or deformation, obj.collection.motion_kind or motion


def wrong_tag(
    rule: Rule, context: RuleContext, obj: LogicalObject, tag: str, declared: str | None
) -> Iterator[Finding]:
    """The finding for a tag, deformation_kind or motion_kind, that contradicts the plan."""
    planned = planned_object(context, obj)
    if planned is None:
        return
    wanted = planned.mechanism[tag == "motion_kind"]
    if declared != wanted:
        yield rule.finding(
            (obj.name,),
            f"{obj.name!r} is tagged {tag}={declared!r}, but its planned role {planned.role!r} needs {wanted!r}.",
            fix=f"Build the planned mechanism and tag the object {tag}={wanted!r}.",
        )
