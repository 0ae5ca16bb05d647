"""Which things of its class a pointer takes, and which names a text, as tried (see ``kb_build/blender/inside``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.flag_names import ACCEPTS

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol

ITSELF = "itself"
TAKES, LEAVES, REFUSES, CRASHES = OUTCOMES = ("takes", "leaves", "refuses", "crashes")
_TREE = "NodeTree"
_WORDS = {LEAVES: "left out without an error", REFUSES: "refused"}


def accepted(symbol: Symbol) -> dict[str, str]:
    """Type of an object, kind of a tree, or ``itself`` → what becomes of it; empty where all of them are taken."""
    pairs = (flag.split(":") for flag in symbol.flagged(ACCEPTS))
    return {kind: outcome for outcome, kind in pairs}


def accepted_text(symbol: Symbol) -> str:
    """Which things of its class a pointer does not take, and how that shows; empty where that is its type alone."""
    kinds = _by_outcome(symbol)
    others = [*kinds[LEAVES], *kinds[REFUSES]]
    shown = " or ".join(told for outcome, told in _WORDS.items() if kinds[outcome])
    if not others:
        return ""
    if kinds[TAKES] == [symbol.target]:
        return f"any other {noun(symbol)} is {shown}" if kinds[LEAVES] else ""
    if len(kinds[TAKES]) <= len(others):
        return f"takes {noun(symbol)}s of type {' or '.join(kinds[TAKES])} alone: any other is {shown}"
    return f"takes no {noun(symbol)} of type {' or '.join(others)}: {shown}"


def fatal_kinds(symbol: Symbol) -> str:
    """``a tree of type ShaderNodeTree``: what crashes Blender where a pointer is given it; empty for most."""
    kinds = _by_outcome(symbol)[CRASHES]
    return f"a {noun(symbol)} of type {' or '.join(kinds)}" if kinds else ""


def part_text(part: str) -> str:
    """What is told of a text that is left out but where it names a part of its object."""
    return f"names a {part} that the object has by then: else it stays empty, without an error"


def noun(symbol: Symbol) -> str:
    """What a pointer leads to, in a word."""
    return "tree" if symbol.target.endswith(_TREE) else "object"


def _by_outcome(symbol: Symbol) -> dict[str, list[str]]:
    kinds: dict[str, list[str]] = {outcome: [] for outcome in OUTCOMES}
    for kind, outcome in accepted(symbol).items():
        if kind != ITSELF:
            kinds[outcome].append(kind)
    return kinds
