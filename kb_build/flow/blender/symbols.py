"""Where symbols come from: a list of records, or a knowledge base, whose records are read when they are needed."""

from __future__ import annotations

from collections import defaultdict
from functools import lru_cache
from typing import TYPE_CHECKING, Protocol

from kb_build.schema import open_read_only, unpack
from kb_build.symbols.records import Symbol, symbol_from_json

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path


MOST_KEPT = 20_000


class Symbols(Protocol):
    """Look-ups among the symbols of one Blender."""

    def symbol(self, path: str) -> Symbol | None:
        """The symbol with this path."""
        ...

    def members(self, owner: str) -> Sequence[Symbol]:
        """What a class or module has itself, sockets included."""
        ...

    def subclasses(self, path: str) -> Sequence[str]:
        """The paths of the classes right below one."""
        ...


class SymbolList:
    """Symbols in memory."""

    def __init__(self, symbols: Iterable[Symbol]) -> None:
        self._by_path: dict[str, Symbol] = {}
        self._members: dict[str, list[Symbol]] = defaultdict(list)
        self._subclasses: dict[str, list[str]] = defaultdict(list)
        for symbol in symbols:
            self._by_path[symbol.path] = symbol
            self._members[symbol.owner].append(symbol)
            if symbol.base:
                self._subclasses[symbol.base].append(symbol.path)

    def symbol(self, path: str) -> Symbol | None:
        """See :class:`Symbols`."""
        return self._by_path.get(path)

    def members(self, owner: str) -> Sequence[Symbol]:
        """See :class:`Symbols`."""
        return self._members.get(owner, ())

    def subclasses(self, path: str) -> Sequence[str]:
        """See :class:`Symbols`."""
        return self._subclasses.get(path, ())


class BaseSymbols:
    """The symbols of a knowledge base, for one thread at a time. ``kept``: how many look-ups of a kind are kept.

    Raises FileNotFoundError and schema.NoBase when it cannot be opened.
    """

    def __init__(self, path: Path, kept: int = MOST_KEPT) -> None:
        self._connection = open_read_only(path, threads=True)
        self.symbol = lru_cache(maxsize=kept)(self._symbol)
        self.members = lru_cache(maxsize=kept)(self._owned)
        self.subclasses = lru_cache(maxsize=kept)(self._below)

    def close(self) -> None:
        """Closes the file."""
        self._connection.close()

    def _read(self, where: str, value: str) -> list[Symbol]:
        rows = self._connection.execute(f"SELECT record FROM symbols WHERE {where} = ?", (value,))  # noqa: S608
        return [symbol_from_json(unpack(row[0])) for row in rows]

    def _symbol(self, path: str) -> Symbol | None:
        return next(iter(self._read("path", path)), None)

    def _owned(self, owner: str) -> Sequence[Symbol]:
        return self._read("owner", owner)

    def _below(self, path: str) -> Sequence[str]:
        rows = self._connection.execute("SELECT path FROM symbols WHERE base = ? AND base != ''", (path,))
        return [row[0] for row in rows]
