"""How much a symbol counts among its like: how often scripts use it, and how much is said about it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Mapping

    from kb_build.symbols.records import Symbol
    from kb_build.usage.examples import Uses

_USED = 2.0
_ASKED = 0.5  # a phrase by which people look for it
_EXPLAINED = 1.0


def symbol_weights(
    symbols: Iterable[Symbol],
    passages: Container[str],
    expansions: Mapping[str, str],
    usage: Mapping[str, Uses],
) -> dict[str, float]:
    """Path → weight, for those that have one.

    ``passages``: symbols with a place of their own in the manual; ``expansions``: path → phrases by which people look
    for it; ``usage``: path → where Blender's own scripts use it. An operator that menus alone name counts once a
    file: who writes a script rarely wants it.
    """
    weights: dict[str, float] = {}
    for symbol in symbols:
        phrases = expansions.get(symbol.path, "")
        weight = _USED * math.log2(1 + _places(symbol, usage.get(symbol.path)))
        weight += _ASKED * (phrases.count(";") + 1 if phrases else 0)
        weight += _EXPLAINED * (symbol.path in passages)
        if weight:
            weights[symbol.path] = round(weight, 2)
    return weights


def _places(symbol: Symbol, uses: Uses | None) -> int:
    """In how many places scripts use a symbol."""
    if uses is None:
        return 0
    return uses.files if symbol.kind == "operator" and not uses.examples else uses.count
