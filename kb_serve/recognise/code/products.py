"""Products of matrices, vectors and quaternions that are written with ``*``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import words

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_serve.recognise.chains.chains import Chain
    from kb_serve.recognise.resolver import Resolver

CLASSES = ("mathutils.Matrix", "mathutils.Vector", "mathutils.Quaternion")
WITH_AT = (
    "Since Blender 2.80 the product of matrices, vectors and quaternions is `a @ b`. `a * b` multiplies element by "
    "element: a TypeError for a matrix and a vector, a wrong result without an error for two matrices or quaternions."
)
_IN_A_MESSAGE = re.compile(
    r"\b(?:matrix|vector)1? \* (?:matrix|vector)2?:"
)  # in which Blender speaks of ``@``
_MATRIX, _VECTOR, _QUATERNION = CLASSES
_TIMES = frozenset({"*", "*(", "*=", "*=("})
_WORDS = {
    _MATRIX: frozenset({"mat", "matrix", "mtx", "mx"}),
    _VECTOR: frozenset(
        {"vec", "vector", "co", "loc", "location", "v", "point", "pos", "direction", "normal"}
    ),
    _QUATERNION: frozenset({"quat", "quaternion", "q"}),
}


class Products:
    """Finds products with the wrong operator in code."""

    def __init__(self, resolver: Resolver) -> None:
        self._resolver = resolver

    def wrong(self, text: str, chains: Sequence[Chain]) -> Iterator[tuple[str, str]]:
        """(the right product, the class of its left factor) of each that ``*`` does not give."""
        if _IN_A_MESSAGE.search(text):
            return
        end, before = 0, None
        for chain in chains:
            start = text.find(chain.source, end)
            if start < 0:
                return
            operator = "".join(text[end:start].split())
            if before is not None and operator in _TIMES:
                left, right = self._class(before), self._class(chain)
                if left and right and {left, right} != {_VECTOR}:  # of vectors it may be meant so
                    factor = "(…)" if "(" in operator else chain.source.strip()
                    yield f"{before.source.strip()} @ {factor}", left
            before, end = chain, start + len(chain.source)

    def _class(self, chain: Chain) -> str:
        """The class of a factor, by what it resolves to or by its name; empty where that is another or unknown."""
        last = chain.attributes[-1] if chain.attributes else chain.root
        made = f"mathutils.{last}"
        if made in CLASSES:
            return made
        if chain.steps:
            reading = next(iter(self._resolver.resolve(chain)), None)
            if reading and reading.complete and reading.cls:
                return reading.cls if reading.cls in CLASSES else ""
        named = words(last)
        return next((cls for cls, known in _WORDS.items() if named and not known.isdisjoint(named)), "")
