"""Proves that every predicate matters: each mutation of a scene fails the check that it is aimed at, and no other.

Each mutant is saved as a file, which is opened and read like any other. One of each scene is also audited by a Blender
of its own, which must give the same audit.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

from bench.audit.untrusted_blend import JobRefused, NotScored
from bench.validity.mutations.planning import MutationResult, checks_of, judge, planned_mutations
from bench.validity.proof import ProofRow

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from bench.validity.mutations.planning import CheckPlace, PlannedMutation
    from bench.validity.variant_builder import VariantBuilder


def prove(builder: VariantBuilder) -> Iterator[ProofRow]:
    """A row for each mutation of each check, one for each check that was not broken, one for the sample."""
    broken: set[CheckPlace] = set()
    files: list[Path] = []
    for number, planned in enumerate(planned_mutations(builder.reading.audit, builder.reading.found)):
        try:
            path, changed = builder.make(
                f"mutation-{number}",
                "mutate",
                change=planned.mutation.change,
                objects=list(planned.objects),
                options=dict(planned.options),
            )
            result = judge(planned, builder.reading, builder.read(path).audit, changed)
        except NotScored as error:
            skipped = planned.mutation.optional and isinstance(error, JobRefused)
            yield _row(planned, None if skipped else False, str(error))
            continue
        broken.add(planned.place)
        files.append(path)
        yield _row(planned, result.holds, _describe_faults(result), result)
    for place, check in checks_of(builder.reading.audit).items():
        if place not in broken and check.outcome == "passed":
            yield ProofRow(
                name=place.label,
                holds=False,
                why="no mutation broke it",
                values={"predicate": place.predicate},
            )
    if files:
        yield _sampled(builder, files)


def _row(
    planned: PlannedMutation, holds: bool | None, why: str, result: MutationResult | None = None
) -> ProofRow:
    values: dict[str, Any] = {
        "actor": planned.place.actor,
        "predicate": planned.place.predicate,
        "mutation": planned.mutation.label,
    }
    if result is not None:
        values["consequences"] = [place.label for place in result.expected]
    return ProofRow(name=planned.label, holds=holds, why=why, values=values)


def _describe_faults(result: MutationResult) -> str:
    faults = [] if result.detected else ["the check still passes"]
    if result.unexpected:
        faults.append(f"failed without a reason: {', '.join(place.label for place in result.unexpected)}")
    return "; ".join(faults)


def _sampled(builder: VariantBuilder, files: list[Path]) -> ProofRow:
    """Audits one of the files, chosen by a digest of the scene's name, in both ways: the bytes must be equal."""
    path = files[int(hashlib.sha256(builder.spec.id.encode()).hexdigest(), 16) % len(files)]
    alone, among = builder.audit_alone(path).as_json(), builder.audit(path).as_json()
    why = "" if alone == among else "a Blender of its own gives another audit"
    return ProofRow(name=f"{path.stem} audited alone", holds=alone == among, why=why)
