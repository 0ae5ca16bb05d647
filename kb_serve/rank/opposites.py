"""Puts operators that do the opposite of what a question says behind the rest: an exporter, for who imports."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import stem, stems_of, terms
from kb_build.symbols.api_names import OPERATORS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_serve.rank.ranked_id import RankedId

_PAIRS = (("import", "export"), ("pack", "unpack"))
_OPPOSITES = {stem(one): stem(other) for a, b in _PAIRS for one, other in ((a, b), (b, a))}


def opposites_last(ranked: Sequence[RankedId], question: str) -> list[RankedId]:
    """The same ids, those that were found and do the opposite of what the question says behind the others."""
    said = set(terms(question))
    unwanted = {_OPPOSITES[word] for word in said & _OPPOSITES.keys()} - said
    if not unwanted:
        return list(ranked)
    return sorted(ranked, key=lambda row: row.why == "found" and _does_any(row.id, unwanted))


def _does_any(identifier: str, verbs: set[str]) -> bool:
    """Whether an operator's name has one of some verbs."""
    return identifier.startswith(OPERATORS) and not verbs.isdisjoint(stems_of(identifier))
