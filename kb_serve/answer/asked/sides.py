"""Takes apart a question that compares things: ``lattice vs mesh deform modifier``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import stem, terms
from kb_build.symbols.paths import last_name

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from kb_serve.rank.merging import Ranking
    from kb_serve.rank.ranked_id import RankedId
    from kb_serve.reader import BaseReader

_BETWEEN = re.compile(r",?\s+(?:vs\.?|versus|compared (?:to|with)|as opposed to)\s+", re.I)
_DIFFERENCE = re.compile(r"(?:.*\s)?differences? between (.+?) and (.+)", re.I)
CODE = frozenset("()[]{}=\"'")
_MOST_SIDES = 3
_LONGEST = 5  # words of a side
# What things are, which the last of them says for all.
_KINDS = frozenset(
    map(stem, ("brush", "constraint", "input", "light", "modifier", "node", "operator", "texture"))
)
_ASIDE = frozenset({"default", "valu", "python"})
_NEAR, _FARTHEST = 1, 99
_FIRST = 8  # of what is found for a side, among which is what it means


class Side(NamedTuple):
    """One of the things that are compared, with the words of what kind it is, and what the others have around it."""

    text: str
    around: str


def sides_of(question: str) -> list[Side]:
    """What a question compares, in its order; none where it compares nothing."""
    if not CODE.isdisjoint(question):
        return []
    text = question.strip(" .?!")
    found = _DIFFERENCE.fullmatch(text)
    parts = [*found.groups()] if found else _BETWEEN.split(text)
    if not 1 < len(parts) <= _MOST_SIDES or any(not 0 < len(part.split()) <= _LONGEST for part in parts):
        return []
    said = [part.split() for part in parts]
    kinds = [word for word in said[-1] if stem(word.lower()) in _KINDS]
    named = [[*own, *(word for word in kinds if word not in own)] for own in said]
    return [
        Side(" ".join(own), " ".join(word for other in named if other is not own for word in other))
        for own in named
    ]


def are_told(sides: Iterable[Side], paths: Iterable[str]) -> bool:
    """Whether the names of some symbols have all words of all sides."""
    told = frozenset(word for path in paths for word in terms(path))
    return all(_own_words(side) <= told for side in sides)


def meant_by(
    sides: Sequence[Side], rank: Callable[[str, str], Ranking], reader: BaseReader
) -> list[RankedId]:
    """The symbol that each side means, another one for each; empty where that is not clear."""
    found: dict[str, RankedId] = {}
    for side in sides:
        own = _own_words(side)
        ranked = rank(side.text, side.around).ranked[:_FIRST]
        rows = [row for row in ranked if row.id not in found and not reader.manual.is_page(row.id)]
        best = min(rows, key=lambda row: _far(row.id, own, reader), default=None)
        if best is not None and _far(best.id, own, reader) > _NEAR:
            best = None
        if best is None:
            return []
        found[best.id] = best
    return [*found.values()]


def _own_words(side: Side) -> frozenset[str]:
    """The words by which a side calls a thing, but for its kind."""
    return frozenset(terms(side.text)) - _KINDS - _ASIDE


def _far(path: str, own: frozenset[str], reader: BaseReader) -> int:
    """How many words a symbol is called by besides those that a side has for it; many if it is not called by all of
    these: a class or an operator by its name or label, a member by its owner's name and its own.
    """
    entry = reader.entry(path)
    if entry is None or not own:
        return _FARTHEST
    name = frozenset(terms(last_name(path)))
    if entry.kind == "class" or (entry.kind == "operator" and len(own) > 1):
        called = (frozenset(terms(entry.label)) - _KINDS, name - _KINDS)
        return min((len(one - own) for one in called if own <= one), default=_FARTHEST)
    is_member = name <= own <= name | frozenset(terms(entry.owner)) and len(own) > 1
    return 0 if is_member else _FARTHEST
