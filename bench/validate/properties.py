"""The five properties: what each is called and asks, and how it is proven of a scene on the desk."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.guises import guises
from bench.sabotage import sabotages
from bench.twins import twins
from bench.validate import files

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from bench.validate.desk import Desk
    from bench.validate.proof import Property, Row


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
        files.satisfiable,
    ),
    "twins": Asked(
        "It sees through fakes",
        "A twin of each scene in motion looks the same and has no physics: one moves by keys, one is played from "
        "files. Its MPR falls by at least the share that predicates of solvers have in it.",
        twins.prove,
    ),
    "sabotages": Asked(
        "Every predicate matters",
        "Each check of each scene is broken in every way that there is: it fails, and with it only what follows by "
        "reason.",
        sabotages.prove,
    ),
    "fair": Asked(
        "Fair",
        f"Organised, named or measured otherwise, a scene scores the same within {guises.TOLERANCE}.",
        guises.prove,
    ),
    "deterministic": Asked(
        "Deterministic",
        "Another process, and one that has read other files before, give the same audit, byte for byte.",
        files.deterministic,
    ),
}
