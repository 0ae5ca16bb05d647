"""Proves invariance: how a scene is organised, named and measured does not change its scores."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bench.audit.untrusted_blend import JobRefused, NotScored
from bench.validity.invariance.actor_names import actor_objects
from bench.validity.proof import ProofRow

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.audit import Audit
    from bench.validity.variant_builder import VariantBuilder

REWRITES = {
    "ungrouped": "hierarchies and collections dissolved",
    "grouped": "each actor's objects in a collection of its name, themselves without meaningful names",
    "renamed": "actors named by a synonym",
    "rescaled": "a hundred times as large, in hundredths of a metre",
    "instanced": "static actors shown as instances of collections outside of the scene",
    "joined": "static actors of several meshes joined",
}
TOLERANCE = 0.02
_DIGITS = 6


def prove(builder: VariantBuilder) -> Iterator[ProofRow]:
    """A row for each rewrite; where nothing can be rewritten, it does not apply."""
    before = builder.audit(builder.original)
    actors = actor_objects(builder.spec, builder.reading.scene, builder.reading.found)
    for rewrite in REWRITES:
        try:
            path, _ = builder.make(rewrite, "rewrite", kind=rewrite, actors=actors)
            after = builder.audit(path)
        except JobRefused as error:
            yield ProofRow(name=rewrite, holds=None, why=str(error))
        except NotScored as error:
            yield ProofRow(name=rewrite, holds=False, why=str(error))
        else:
            yield _row(rewrite, before, after)


def _row(rewrite: str, before: Audit, after: Audit) -> ProofRow:
    change: dict[str, float | None] = {
        "mpr": _difference(before.mpr, after.mpr),
        "spr": _difference(before.spr, after.spr),
    }
    values: dict[str, Any] = {"mpr": after.mpr, "spr": after.spr, "change": change}
    same = (before.mpr is None) == (after.mpr is None) and (before.spr is None) == (after.spr is None)
    holds = same and all(each is None or abs(each) <= TOLERANCE for each in change.values())
    return ProofRow(name=rewrite, holds=holds, why="" if holds else _describe_losses(after), values=values)


def _difference(before: float | None, after: float | None) -> float | None:
    return None if before is None or after is None else round(after - before, _DIGITS)


def _describe_losses(after: Audit) -> str:
    """What does not hold after a rewrite, in words."""
    checks = [
        f"{actor.name}: {check.predicate}"
        for actor in after.actors
        for check in actor.checks
        if check.outcome == "failed"
    ]
    relations = [f"{rel.a} {rel.type} {rel.b}" for rel in after.relations if rel.outcome != "holds"]
    return ", ".join([*checks, *relations]) or (after.not_scored or "")
