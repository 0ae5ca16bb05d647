"""How much a symbol counts among its like: how often scripts use it, and how much is said about it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Mapping

    from kb_build.records import Symbol

_USED = 2.0
_ASKED = 0.5  # a phrase by which people look for it
_EXPLAINED = 1.0


def symbol_weights(
    symbols: Iterable[Symbol],
    passages: Container[str],
    expansions: Mapping[str, str],
    uses: Mapping[str, int],
) -> dict[str, float]:
    """Path → weight, for those that have one.

    ``passages``: symbols with a place of their own in the manual; ``expansions``: path → phrases by which people look
    for it; ``uses``: path → in how many places Blender's own scripts use it.
    """
    weights: dict[str, float] = {}
    for symbol in symbols:
        phrases = expansions.get(symbol.path, "")
        weight = _USED * math.log2(1 + uses.get(symbol.path, 0))
        weight += _ASKED * (phrases.count(";") + 1 if phrases else 0)
        weight += _EXPLAINED * (symbol.path in passages)
        if weight:
            weights[symbol.path] = round(weight, 2)
    return weights
