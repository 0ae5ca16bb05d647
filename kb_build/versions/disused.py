"""What a version lists without using it: settings of a render engine that is gone, operators for what is to come.

The table of successors tells of the settings: what took their place is in the release notes of a version before the one
that lost them. Of an operator that makes what this version has no class for, it tells what that takes the place of.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.symbols.records import BARE_DATA, Deprecation
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.symbols.records import Symbol
    from kb_build.versions.successors import Succession

_RELEASE_NOTES = re.compile(r"release notes (\d+\.\d+)\b")
_NO_EFFECT, _USE = "It has no effect.", "Use "


def without_effect(symbols: Iterable[Symbol], table: Iterable[Succession], version: str) -> list[Symbol]:
    """The symbols of a version (minor); properties that it has without using them say since when, and what to use."""
    symbols = list(symbols)
    known = {symbol.path for symbol in symbols}
    disused = {row.old: deprecation for row in table if (deprecation := _disuse(row, version, known))}
    return [
        replace(symbol, deprecation=disused[symbol.path])
        if symbol.kind == "property" and symbol.path in disused and symbol.deprecation is None
        else symbol
        for symbol in symbols
    ]


def with_present_ways(symbols: Iterable[Symbol], table: Iterable[Succession], version: str) -> list[Symbol]:
    """The symbols of a version (minor); operators that make data without a class say what is called here instead."""
    symbols = list(symbols)
    known = {symbol.path for symbol in symbols}
    later = {
        new: row.old
        for row in table
        for new in row.new
        if row.old in known and version_key(row.version) > version_key(version)
    }
    return [
        replace(
            symbol,
            flags=tuple(
                f"{flag}{later[symbol.path]}" if flag == BARE_DATA else flag for flag in symbol.flags
            ),
        )
        if BARE_DATA in symbol.flags and symbol.path in later
        else symbol
        for symbol in symbols
    ]


def _disuse(row: Succession, version: str, known: set[str]) -> Deprecation | None:
    """Since when what a row replaces is not used, where it is still there; None for all other rows."""
    said = _RELEASE_NOTES.match(row.source)
    if said is None or not version_key(said[1]) <= version_key(version) < version_key(row.version):
        return None
    instead = [path for path in row.new if path in known]
    use = f"{_USE}{', '.join(f'`{path}`' for path in instead)}." if instead else ""
    how = "" if use and row.how.startswith(_USE) else row.how
    note = " ".join(filter(None, (_NO_EFFECT, use, how)))
    return Deprecation(f"{note} ({row.source})", said[1], row.version)
