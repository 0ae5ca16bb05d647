"""The five properties: what each is called and asks, and how it is proven of a scene on the desk."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.validity import file_properties
from bench.validity.counterfeits import rejection
from bench.validity.invariance import equal_scores
from bench.validity.mutations import detection

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from bench.validity.proof import Property, Row
    from bench.validity.variant_builder import Desk


@dataclass(frozen=True, slots=True)
class Asked:
    """``title`` and ``claim`` head a report; ``prove`` gives what was tried, and raises NotScored, CannotStart."""

    title: str
    claim: str
    prove: Callable[[Desk], Iterable[Row]]


ASKED: Mapping[Property, Asked] = {
    "satisfiable": Asked(
        "Satisfiable",
        "Each reference scene has MPR 1.0 and SPR 1.0, its actors are found for certain, its assertions hold.",
        file_properties.satisfiable,
    ),
    "twins": Asked(
        "It sees through fakes",
        "A twin of each scene in motion looks the same and has no physics: one moves by keys, one is played from "
        "files. Its MPR falls by at least the share that predicates of solvers have in it.",
        rejection.prove,
    ),
    "sabotages": Asked(
        "Every predicate matters",
        "Each check of each scene is broken in every way that there is: it fails, and with it only what follows by "
        "reason.",
        detection.prove,
    ),
    "fair": Asked(
        "Fair",
        f"Organised, named or measured otherwise, a scene scores the same within {equal_scores.TOLERANCE}.",
        equal_scores.prove,
    ),
    "deterministic": Asked(
        "Deterministic",
        "Another process, and one that has read other files before, give the same audit, byte for byte.",
        file_properties.deterministic,
    ),
}
