"""What an old bake shows is no fault of the scene: findings that were measured by playing one are not hard."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from agents.protocol.facts import CacheFacts
    from agents.protocol.findings import Finding
    from agents.protocol.rule import Rule, RuleContext

_JUDGE_BAKES = frozenset({"R19", "T1"})  # these say that a bake is old
_BODIES = "rigid_body"  # a kind of cache
_FIX = "Free it (blender_bake, free=true) or bake again (blender_bake), then judge again"


def as_played(rule: Rule, context: RuleContext, findings: Iterable[Finding]) -> Iterator[Finding]:
    """The findings of a rule: soft, with what to do first, where an old bake moved what they are about."""
    old = [cache for cache in context.facts.caches if cache.on and cache.baked and cache.outdated]
    for finding in findings:
        played = _played_in(rule, context, finding, old) if rule.id not in _JUDGE_BAKES else None
        if played is None:
            yield finding
        else:
            message = f"{finding.message} This was measured while an old bake is played: that of {played}."
            yield replace(finding, severity="soft", message=message, fix=f"{_FIX}. {finding.fix}".rstrip())


def _played_in(rule: Rule, context: RuleContext, finding: Finding, old: Iterable[CacheFacts]) -> str | None:
    """The old cache that moved one of a finding's objects before it was measured, in words; None for none."""
    facts = context.facts
    frame = facts.frame if finding.frame is None else finding.frame
    if frame == facts.frame_start and not rule.follows_motion:
        return None
    meshes = (mesh for name in finding.objects for mesh in (name, *context.structure.surfaces_of(name)))
    moved = {item.name: item for mesh in meshes for item in context.structure.dependencies(mesh)}
    for cache in old:
        if cache.kind == _BODIES and any(item.is_active_body for item in moved.values()):
            return "the rigid-body world"
        if cache.object in moved:
            return f"the {cache.kind.replace('_', ' ')} of {cache.object!r}"
    return None
