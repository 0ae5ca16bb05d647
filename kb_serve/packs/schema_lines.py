"""Lines of a pack that tell schemas: real defaults, sockets of nodes, the members of classes that scripts use most."""

from __future__ import annotations

from collections import defaultdict
from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import NODE, SIDES, TYPES
from kb_build.symbols.flags import usual_default
from kb_build.symbols.lines import literal
from kb_serve.packs.section import fitting, is_for_users, short

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kb_build.symbols.records import Symbol
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_MEMBERS = 14  # of a class, the heaviest
_LEAST = 1.0  # the weight of a member that is told of
# Interface and registration, which scripts of add-ons use most, and models know.
_WELL_KNOWN = frozenset(
    {
        "Context",
        "ID",
        "Operator",
        "OperatorProperties",
        "Panel",
        "PropertyGroup",
        "UILayout",
        "bpy_prop_array",
    }
)
_PLAIN = ("rna_type", "bl_rna", "name")


class SchemaLines:
    """What a base knows of the schemas that count most."""

    def __init__(self, reader: BaseReader, concerns: Callable[[str], bool] | None = None) -> None:
        """``concerns`` says of a class whether it is wanted; by default all that belong to scenes are."""
        self._reader = reader
        self._concerns = concerns

    @cached_property
    def _classes(self) -> list[Symbol]:
        """The classes that are wanted, those that scripts use most first."""
        paths = [path for path, _ in self._reader.names.data_classes if path.startswith(TYPES)]
        weights = self._reader.usage.weights(paths)
        heaviest = sorted(
            (path for path in paths if self._counts(path, weights)), key=lambda path: -weights.get(path, 0)
        )
        symbols = (self._reader.symbol(path) for path in heaviest)
        return [
            symbol
            for symbol in symbols
            if symbol is not None and (self._concerns or not is_for_users(symbol))
        ]

    def _counts(self, path: str, weights: dict[str, float]) -> bool:
        return self._concerns(path) if self._concerns else path in weights

    # Defaults

    def defaults(self, budget: int) -> list[str]:
        """Lines of the properties of which new things have another value than the schema says."""
        owners = {symbol.path for symbol in self._classes if symbol.reached or self._concerns}
        weighed = self._reader.rows(
            "SELECT symbols.path, owner FROM symbols LEFT JOIN weights USING (path) "
            "WHERE kind = 'property' AND owner GLOB 'bpy.types.*' ORDER BY COALESCE(weight, 0) DESC, symbols.path"
        )
        differing: dict[str, list[str]] = defaultdict(list)
        for path, owner in weighed:
            if owner in owners and (text := self._other_default(path)):
                differing[owner].append(text)
        return fitting(
            (f"- {short(owner)}: {', '.join(texts)}" for owner, texts in differing.items()), budget
        )

    def _other_default(self, path: str) -> str:
        symbol = self._reader.symbol(path)
        if symbol is None or not symbol.new_values or symbol.default is None:
            return ""
        usual = usual_default(symbol)
        if usual == symbol.default or isinstance(usual, list):
            return ""
        return f"`{symbol.name}` = {literal(usual, symbol.type)}, not {literal(symbol.default, symbol.type)}"

    # Sockets

    def sockets(self, budget: int) -> list[str]:
        """Lines of nodes with their sockets and what these begin with."""
        nodes = (symbol for symbol in self._classes if self._reader.descends(symbol.path, NODE))
        return fitting((line for node in nodes if (line := self._node_line(node.path))), budget)

    def _node_line(self, path: str) -> str:
        members = self._reader.members(path)
        sides = {
            side: [_socket(name, entry) for name, entry in members.items() if name.startswith(f"{side}[")]
            for side in SIDES
        }
        told = "; ".join(f"{side} {', '.join(sockets)}" for side, sockets in sides.items() if sockets)
        return f"- `{short(path)}`: {told}" if told else ""

    # Classes

    def members(self, budget: int) -> list[str]:
        """Lines of classes with their most used members, their defaults and their values."""
        plain = (
            symbol
            for symbol in self._classes
            if symbol.name not in _WELL_KNOWN and not self._reader.descends(symbol.path, NODE)
        )
        return fitting((line for symbol in plain if (line := self._class_line(symbol))), budget)

    def _class_line(self, symbol: Symbol) -> str:
        members = self._heaviest(self._reader.members(symbol.path).values())[:_MEMBERS]
        if not members:
            return ""
        reached = f" (`{symbol.reached}`)" if symbol.reached else ""
        return f"- `{short(symbol.path)}`{reached}: " + ", ".join(member.head for member in members)

    def _heaviest(self, entries: Iterable[SymbolEntry]) -> list[SymbolEntry]:
        kept = (
            entry for entry in entries if entry.kind in {"property", "function"} and entry.name not in _PLAIN
        )
        return self._reader.usage.heaviest(kept, 0.0 if self._concerns else _LEAST)


def _socket(name: str, entry: SymbolEntry) -> str:
    """``"Base Color"`` = (0.8, 0.8, 0.8, 1)."""
    _, equals, default = entry.head.partition(" = ")
    return name.partition("[")[2].removesuffix("]") + (f" = {default}" if equals else "")
