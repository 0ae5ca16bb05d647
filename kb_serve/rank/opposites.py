"""Puts what does the opposite of what a question says behind the rest: an exporter, for who imports; what makes an axis
of a quaternion, for who makes a quaternion from an axis.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import stem, stems_of, terms
from kb_build.symbols.api_names import OPERATORS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_serve.rank.ranked_id import RankedId

_PAIRS = (("import", "export"), ("pack", "unpack"))
_OPPOSITES = {stem(one): stem(other) for a, b in _PAIRS for one, other in ((a, b), (b, a))}
_CONVERSION = re.compile(r"(?P<result>.+?)\sfrom\s.+|.+?\sto\s(?P<wanted>.+)", re.I)
_TO = "to_"  # how methods begin that make something else of their own


def opposites_last(ranked: Sequence[RankedId], question: str) -> list[RankedId]:
    """The same ids, those that were found and do the opposite of what the question says behind the others."""
    said = set(terms(question))
    unwanted = {_OPPOSITES[word] for word in said & _OPPOSITES.keys()} - said
    conversion = _CONVERSION.fullmatch(question.strip())
    if not unwanted and conversion is None:
        return list(ranked)
    wanted = set(terms(conversion["result"] or conversion["wanted"])) if conversion else set[str]()
    return sorted(
        ranked,
        key=lambda row: (
            row.why == "found" and (_does_any(row.id, unwanted) or _converts_away(row.id, wanted))
        ),
    )


def _does_any(identifier: str, verbs: set[str]) -> bool:
    """Whether an operator's name has one of some verbs."""
    return identifier.startswith(OPERATORS) and not verbs.isdisjoint(stems_of(identifier))


def _converts_away(identifier: str, wanted: set[str]) -> bool:
    """Whether a method makes something else of its own class, which is wanted."""
    owner, _, name = identifier.rpartition(".")
    is_wanted = stems_of(owner.rpartition(".")[2]) <= wanted
    return name.startswith(_TO) and is_wanted and wanted.isdisjoint(stems_of(name.removeprefix(_TO)))
