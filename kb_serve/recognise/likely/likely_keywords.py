"""Which arguments of a call may be meant by one that it does not take: by spelling, and by shared words."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

from kb_build.index.analysis import idf, stem, words
from kb_serve.recognise.likely.corrections import is_misspelling, nearest

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from kb_build.symbols.records import Symbol

# Words that say how a thing is used, and not what it is.
EMPTY_WORDS = frozenset({"use", "is", "has", "show", "do", "set", "get"})
_TEXT = re.compile(r"""(["'])([^"']+)\1""")
_MOST = 3
_LEAST = 0.3  # share of what two names say that both do
_LEAST_OF_BEST = 0.6
_BEGINNING = 4  # letters of a word that another one begins with: anim, of animation
_BEGINNING_OF_NAME = 3
_EXTENTS = frozenset({"depth", "diameter", "height", "length", "radius", "size", "width"})


def likely_parameters(symbol: Symbol, written: str, value: str = "") -> list[str]:
    """The parameters that may be meant by a keyword that a call does not take: those that are called alike, of which
    those that take the text that is written for it, or the only one that takes it.
    """
    alike = likely_keywords(written, {one.name: one.label for one in symbol.parameters})
    if (text := _TEXT.fullmatch(value)) is None:
        return alike
    taking = [
        one.name for one in symbol.parameters if text[2] in {item.identifier for item in one.enum_items}
    ]
    return [name for name in alike if name in taking] or (taking if len(taking) == 1 else alike)


def likely_keywords(written: str, labels: Mapping[str, str]) -> list[str]:
    """The arguments that a name may mean which a call does not take, best first; ``labels`` is argument → label.

    First those of the same words in another order, and those that it is a misspelling of; then those that say most of
    what it says and little else, ``bake_anim`` for ``use_anim``; then those that are spelt alike, or else begin alike;
    else, of an extent, the others: a cylinder's height is its depth.
    """
    found = [
        *(name for name in labels if sorted(words(name)) == sorted(words(written))),
        *(name for name, _ in nearest(written, labels) if is_misspelling(written, name)),
        *_of_same_meaning(written, labels),
        *(name for name, _ in nearest(written, labels)),
    ]
    found = found or [*_beginning_alike(written, labels)]
    found = found or [name for name in labels if {written, name} <= _EXTENTS]
    return list(dict.fromkeys(found))[:_MOST]


def _of_same_meaning(written: str, labels: Mapping[str, str]) -> Iterator[str]:
    """The arguments whose name or label shares enough with a name; words count that few of the arguments have."""
    mine = _meaning(written)
    said = {
        name: [meaning for text in (name, label) if (meaning := _meaning(text))]
        for name, label in labels.items()
    }
    having = Counter(word for name in labels for word in _meaning(name))

    def weight(these: Iterable[str]) -> float:
        return sum(idf(len(labels) + 1, having[word] or 1) for word in these)

    def share(theirs: Collection[str]) -> float:
        both = [word for word in theirs if any(_is_same(word, other) for other in mine)]
        alone = [word for word in mine if not any(_is_same(word, other) for other in theirs)]
        return weight(both) / (weight(theirs) + weight(alone))

    shares = {name: max(map(share, meanings), default=0.0) for name, meanings in said.items()}
    least = max(_LEAST, _LEAST_OF_BEST * max(shares.values(), default=0.0))
    likely = [name for name, value in shares.items() if value >= least]
    yield from sorted(likely, key=lambda name: (-shares[name], len(name), name))


def _is_same(word: str, other: str) -> bool:
    """Whether two stems are one word, or one of them a short form of the other."""
    shorter, longer = sorted((word, other), key=len)
    return shorter == longer or (len(shorter) >= _BEGINNING and longer.startswith(shorter))


def _beginning_alike(written: str, names: Iterable[str]) -> Iterator[str]:
    """The names that begin with the first letters of a name, unless these say nothing of what it is."""
    first = written[:_BEGINNING_OF_NAME]
    return (name for name in names if first not in EMPTY_WORDS and name.startswith(first))


def _meaning(text: str) -> set[str]:
    return {stem(word) for word in words(text) if word not in EMPTY_WORDS}
