"""The first and the fifth property, which need nothing but the file: it meets its spec, and scores the same again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.validity.proof import Row

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.audit import Audit
    from bench.validity.variant_builder import Desk


def satisfiable(desk: Desk) -> Iterator[Row]:
    """One row: MPR and SPR are 1, every actor is found for certain, and the scene's assertions hold."""
    found = desk.audited
    if found.not_scored is not None:
        yield Row(name="audit", holds=False, why=f"not scored: {found.not_scored}")
        return
    wrong = list(_wrong(found))
    values = {
        "mpr": found.mpr,
        "spr": found.spr,
        "actors": len(found.actors),
        "checks": sum(len(actor.checks) for actor in found.actors),
        "relations": len(found.relations),
        "assertions": len(found.assertions),
    }
    yield Row(name="audit", holds=not wrong, why=", ".join(wrong), values=values)


def _wrong(found: Audit) -> Iterator[str]:
    for actor in found.actors:
        if actor.outcome != "resolved":
            yield f"{actor.name} is {actor.outcome}"
        yield from (f"{actor.name}: {check.predicate}" for check in actor.checks if check.outcome == "failed")
    yield from (f"scene: {check.predicate}" for check in found.assertions if check.outcome == "failed")
    yield from (
        f"{one.a} {one.type} {one.b} {one.outcome}" for one in found.relations if one.outcome != "holds"
    )
    if not found.relations:
        yield "there are no relations"


def deterministic(desk: Desk) -> Iterator[Row]:
    """Two rows: another process, and one that has read other files before, find the same to the byte."""
    first = desk.audited.as_json()
    for name, other in (
        ("another process", desk.audit_alone(desk.blend)),
        ("a copy elsewhere, after other files", desk.audit(desk.original)),
    ):
        same = other.as_json() == first
        why = "" if same else "it found something else"
        yield Row(name=name, holds=same, why=why, values={"bytes": len(first.encode())})
