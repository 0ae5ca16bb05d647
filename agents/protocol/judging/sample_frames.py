"""The frames at which a relation is checked: a plan says what relations there are, not when they hold."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.plan.part import owner_of

if TYPE_CHECKING:
    from agents.plan.relations import RelationPart
    from agents.protocol.rule import RuleContext


def sample_frames(context: RuleContext, *nodes: str) -> tuple[int | None, ...]:
    """Frames at which a relation of ``nodes`` is checked; it must hold at one of them.

    For nodes that stand still: the current one (None). For moving ones: the timeline's first and last frame, since a
    chair that is thrown over stands at first, and a ball that drops into a bowl is in it at last; the first alone as
    long as motion is not to be judged.
    """
    if any(moves(context, node) for node in nodes):
        facts = context.facts
        return (facts.frame_start, facts.frame_end) if context.judges_end else (facts.frame_start,)
    return (None,)


def relation_frames(context: RuleContext, relation: RelationPart) -> tuple[int | None, ...]:
    """The frames at which a relation of the plan is checked; none while it cannot hold yet.

    It must hold at one of them; at each, if it is to hold ``always``.
    """
    frames = sample_frames(context, *relation.nodes)
    if relation.when != "end":
        return frames
    if any(moves(context, node) for node in relation.nodes):
        return frames[1:]
    waits = any(_is_to_move(context, node) for node in relation.nodes)
    return () if waits else frames


def _is_to_move(context: RuleContext, node: str) -> bool:
    """Whether the plan has something move that does not move yet."""
    planned = context.plan.object(owner_of(node)) if context.plan else None
    return planned is not None and planned.mechanism[1] != "none"


def planned_pose_frame(context: RuleContext, node: str) -> int | None:
    """The frame at which a node must be where the plan puts it: for moving ones the first, else the current (None)."""
    return context.facts.frame_start if moves(context, node) else None


def moves(context: RuleContext, node: str) -> bool:
    """Whether anything may move or deform the objects of a node."""
    structure = context.structure
    obj = structure.logical_object_of(node)
    roots = [root.name for root in obj.roots] if obj else []
    return any(structure.can_move(name) for name in (*structure.surfaces_of(node), *roots))
