"""What a version lists without using it: settings of a render engine that is gone, operators for what is to come,
modules of which a build has the names alone.

The table of successors tells of the settings: what took their place is in the release notes of a version before the one
that lost them. Of an operator that makes what this version has no class for, it tells what that takes the place of; of
a module, what takes its place later.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.symbols.flag_names import BARE_DATA, STUB
from kb_build.symbols.records import Deprecation
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


def with_later_ways(symbols: Iterable[Symbol], table: Iterable[Succession], version: str) -> list[Symbol]:
    """The symbols of a version (minor); modules of names alone say what takes their place in a version after it."""
    symbols = list(symbols)
    known = {symbol.path for symbol in symbols}
    modules = {symbol.owner for symbol in symbols if STUB in symbol.flags}
    later = {row.old: row for row in table if version_key(row.version or version) > version_key(version)}

    def told(symbol: Symbol) -> Symbol:
        module = next((one for one in (symbol.path, symbol.owner) if one in modules), "")
        row = (later.get(symbol.path) or later.get(module)) if module else None
        if row is None:
            return symbol
        return replace(symbol, deprecation=Deprecation(_instead(row, known), removal=row.version))

    return [told(symbol) for symbol in symbols]


def _instead(row: Succession, known: set[str], *before: str) -> str:
    """What a row says is to be used, of what is known, and where it says so."""
    paths = [path for path in row.new if path in known]
    use = f"{_USE}{', '.join(f'`{path}`' for path in paths)}." if paths else ""
    how = "" if use and row.how.startswith(_USE) else row.how
    return f"{' '.join(filter(None, (*before, use, how)))} ({row.source})"


def _disuse(row: Succession, version: str, known: set[str]) -> Deprecation | None:
    """Since when what a row replaces is not used, where it is still there; None for all other rows."""
    said = _RELEASE_NOTES.match(row.source)
    if said is None or not version_key(said[1]) <= version_key(version) < version_key(row.version):
        return None
    return Deprecation(_instead(row, known, _NO_EFFECT), said[1], row.version)
