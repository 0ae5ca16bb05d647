"""Symbols of other versions that a base lacks, what replaces them, and since when it has the others."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, short_path
from kb_build.versions.history import SHARED
from kb_build.versions.paths import split_path
from kb_build.versions.similar_names import find_similar_names

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_build.records import Symbol
    from kb_build.versions.history import ApiHistory


_TYPES = "bpy.types"
_INTERFACE = re.compile(r"[A-Z0-9_]+_(?:PT|MT|HT|OT|UL|AST|GGT|GT|FH|KSI|RE)_")
_EXTENDED = re.compile(r"[A-Z0-9_]+_(?:PT|MT|HT)_")

@dataclass(frozen=True, slots=True)
class RemovedSymbols:
    """Rows of the tables removed, removed_names, successors, similar_names and since (see schema.DDL)."""

    removed: tuple[tuple[str, str, str, str], ...] = ()
    names: tuple[tuple[str, str], ...] = ()
    successors: tuple[tuple[str, int, str, str, str, str], ...] = ()
    similar_names: tuple[tuple[str, str, float], ...] = ()
    since: tuple[tuple[str, str], ...] = ()


def is_asked_for(path: str, history: ApiHistory, version: str) -> bool:
    """Whether scripts use it: a class, member, operator or enum item; a parameter of a function that is still there.

    Of the interface only menus, panels and headers as such: scripts add to them.
    """
    if path.startswith(SHARED):
        return False
    above, mark, name = split_path(path)
    if mark == "(" or above.endswith(")"):
        return bool(history.exists(above, version))
    if above == _TYPES:
        return bool(_EXTENDED.match(name)) or not _INTERFACE.match(name)
    return not _INTERFACE.match(above.removeprefix(_TYPES + "."))


def _keys(path: str, items: Counter[str]) -> Iterator[str]:
    yield key(path)
    if (item := path.partition(":")[2]) and items[item] == 1:  # one that only one enumeration had
        yield key(item)
    if path.endswith('"]'):  # a socket is also asked for on a node whose class is not known
        yield key(path.partition('["')[0].rpartition(".")[2] + path.partition('["')[2])
    if (short := short_path(path)) != path:
        yield key(short)


def find_removed_symbols(symbols: Sequence[Symbol], history: ApiHistory, version: str) -> RemovedSymbols:
    """Compares ``symbols``, those of a (minor) version, with what the history knows of other versions.

    A symbol that extraction found is never called removed, whatever the history says.
    """
    known = {symbol.path for symbol in symbols}
    removed = [
        span for span in history.removed_from(version) if span.path not in known and is_asked_for(span.path, history, version)
    ]
    items = Counter(span.path.partition(":")[2] for span in removed)
    since = history.since(version)
    return RemovedSymbols(
        removed=tuple((span.path, span.first, span.last, span.gone) for span in removed),
        names=tuple((spelled, span.path) for span in removed for spelled in _keys(span.path, items)),
        similar_names=tuple(find_similar_names(symbols, history, version)),
        since=tuple((path, first) for path, first in since.items() if path in known),
    )
