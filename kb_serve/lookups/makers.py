"""Looks up how instances of classes are made."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.lookups.records import Creation

if TYPE_CHECKING:
    from collections.abc import Collection

    from kb_serve.lookups.symbols import SymbolLookups


class MakerLookups:
    """The calls in one base that make something."""

    def __init__(self, symbols: SymbolLookups) -> None:
        self._symbols = symbols

    def creations(self, paths: Collection[str]) -> dict[str, Creation]:
        """Class → how an instance is made, for those that have a call."""
        rows = self._symbols.rows_of("SELECT path, call, maker, choice FROM creation WHERE path", paths)
        return {row[0]: Creation(*row[1:]) for row in rows}

    def calls_of(self, maker: str) -> list[tuple[str, str]]:
        """(call, its choice) of all that a function makes."""
        return self._symbols.rows("SELECT call, choice FROM creation WHERE maker = ? ORDER BY path", maker)

    def made_by_call(self, call: str) -> str:
        """The class of which a call makes an instance; empty for none."""
        return next(
            (row[0] for row in self._symbols.rows("SELECT path FROM creation WHERE call = ?", call)), ""
        )

    def made_as(self, name: str) -> list[str]:
        """The classes of whose calls one gives a new instance this name."""
        return [
            row[0]
            for row in self._symbols.rows("SELECT path FROM creation WHERE instr(call, ?)", f'"{name}"')
        ]

    def made_by_choice(self, choice: str) -> list[tuple[str, str]]:
        """(class, what makes it) of the classes of which a call makes an instance with this choice."""
        return self._symbols.rows("SELECT path, maker FROM creation WHERE choice = ? ORDER BY path", choice)

    def class_made(self, function: str, result: str, choice: str) -> str:
        """The class of which a function makes an instance with a choice, or else another one that gives the same
        ``result``, a class, as bones take the constraints of objects; empty for none.
        """
        makers = self.made_by_choice(choice)
        own = next((cls for cls, maker in makers if maker == function), "")
        return own or next((cls for cls, _ in makers if result and self._symbols.descends(cls, result)), "")
