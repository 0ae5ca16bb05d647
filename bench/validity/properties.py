"""The five properties: title and claim of each, and the function that proves it of a scene."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.validity import file_properties
from bench.validity.counterfeits import rejection
from bench.validity.invariance import equal_scores
from bench.validity.mutations import detection

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from bench.validity.proof import ProofRow, Property
    from bench.validity.variant_builder import VariantBuilder


@dataclass(frozen=True, slots=True)
class PropertyProof:
    """``title`` and ``claim`` head a report; ``prove`` gives what was tried, and raises NotScored, CannotStart."""

    title: str
    claim: str
    prove: Callable[[VariantBuilder], Iterable[ProofRow]]


PROPERTY_PROOFS: Mapping[Property, PropertyProof] = {
    "satisfiable": PropertyProof(
        "Satisfiable",
        "Each reference scene has MPR 1.0 and SPR 1.0, its actors are resolved, its assertions hold.",
        file_properties.satisfiable,
    ),
    "counterfeits": PropertyProof(
        "It rejects counterfeits",
        "Two counterfeits of each scene in motion look the same and have no physics: one moves by keys, one is played "
        "from files. MPR falls by at least the share that solver predicates have in it.",
        rejection.prove,
    ),
    "mutations": PropertyProof(
        "Every predicate matters",
        "Each check of each scene is broken in every way listed below: it fails, and others only for a stated reason.",
        detection.prove,
    ),
    "invariance": PropertyProof(
        "Invariant",
        f"A scene that is organised, named or measured in another way scores the same within {equal_scores.TOLERANCE}.",
        equal_scores.prove,
    ),
    "deterministic": PropertyProof(
        "Deterministic",
        "Another process, and one that has read other files before, give the same audit, byte for byte.",
        file_properties.deterministic,
    ),
}
