"""Symbols of other versions that a base lacks, what replaces them, and since when it has the others."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, short_path
from kb_build.versions.replacements import find_replacements, is_asked_for

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_build.records import Symbol
    from kb_build.versions.history import ApiHistory


@dataclass(frozen=True, slots=True)
class RemovedSymbols:
    """Rows of the tables removed, removed_names, replacements and since (see schema.DDL)."""

    removed: tuple[tuple[str, str, str], ...] = ()
    names: tuple[tuple[str, str], ...] = ()
    replacements: tuple[tuple[str, str, float], ...] = ()
    since: tuple[tuple[str, str], ...] = ()


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
    items = Counter(path.partition(":")[2] for path, _, _ in history.removed_from(version))
    known = {symbol.path for symbol in symbols}
    removed = [row for row in history.removed_from(version) if row[0] not in known and is_asked_for(row[0])]
    since = history.since(version)
    return RemovedSymbols(
        removed=tuple(removed),
        names=tuple((spelled, path) for path, _, _ in removed for spelled in _keys(path, items)),
        replacements=tuple(find_replacements(symbols, history, version)),
        since=tuple((path, first) for path, first in since.items() if path in known),
    )
