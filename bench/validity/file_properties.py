"""Proves the properties that need only the file: it meets its spec, and its audit is always the same."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.validity.proof import ProofRow

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.audit import Audit
    from bench.validity.variant_builder import VariantBuilder


def satisfiable(builder: VariantBuilder) -> Iterator[ProofRow]:
    """One row: MPR and SPR are 1, every actor is resolved, and the scene's assertions hold."""
    audit = builder.audited
    if audit.not_scored is not None:
        yield ProofRow(name="audit", holds=False, why=f"not scored: {audit.not_scored}")
        return
    faults = list(_faults(audit))
    values = {
        "mpr": audit.mpr,
        "spr": audit.spr,
        "actors": len(audit.actors),
        "checks": sum(len(actor.checks) for actor in audit.actors),
        "relations": len(audit.relations),
        "assertions": len(audit.assertions),
    }
    yield ProofRow(name="audit", holds=not faults, why=", ".join(faults), values=values)


def _faults(audit: Audit) -> Iterator[str]:
    for actor in audit.actors:
        if actor.outcome != "resolved":
            yield f"{actor.name} is {actor.outcome}"
        yield from (f"{actor.name}: {check.predicate}" for check in actor.checks if check.outcome == "failed")
    yield from (f"scene: {check.predicate}" for check in audit.assertions if check.outcome == "failed")
    yield from (
        f"{rel.a} {rel.type} {rel.b} {rel.outcome}" for rel in audit.relations if rel.outcome != "holds"
    )
    if not audit.relations:
        yield "there are no relations"


def deterministic(builder: VariantBuilder) -> Iterator[ProofRow]:
    """Two rows: another process, and one that has read other files before, give the same audit to the byte."""
    first = builder.audited.as_json()
    for name, other in (
        ("another process", builder.audit_alone(builder.blend)),
        ("a copy elsewhere, after other files", builder.audit(builder.original)),
    ):
        same = other.as_json() == first
        why = "" if same else "it gives another audit"
        yield ProofRow(name=name, holds=same, why=why, values={"bytes": len(first.encode())})
