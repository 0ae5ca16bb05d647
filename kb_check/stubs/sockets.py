"""The sockets of each node as a class of its own: ``inputs["Base Color"]`` is a NodeSocketColor, a wrong name wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import NODES_WITH_SOCKETS_OF_THEIR_OWN
from kb_build.flow.values.types import Instance
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import NEVER_BY_IDENTIFIER

if TYPE_CHECKING:
    from kb_build.flow.blender.api import Api
    from kb_check.stubs.families import Families

MODULE = "bpy._sockets"
SIDES = {"inputs": "NodeInputs", "outputs": "NodeOutputs"}


class Sockets:
    """The sockets of one Blender's nodes."""

    def __init__(self, api: Api, families: Families) -> None:
        self._api = api
        self._any = f"{families.name(f'{T}NodeSocket')} | typing.Any"
        self._rows: dict[str, list[str]] = {}

    def declare(self, cls: str) -> dict[str, str]:
        """``inputs`` and ``outputs`` of a node's class, where they are its own."""
        if cls.rpartition("Node")[2] in NODES_WITH_SOCKETS_OF_THEIR_OWN:
            return {}
        found: dict[str, str] = {}
        for side, container in SIDES.items():
            own = any(
                symbol.kind == "socket" and symbol.path.startswith(f"{cls}.{side}[")
                for symbol in self._api.symbols.members(cls)
            )
            if own and self._api.is_class(T + container):
                name = f"{cls.rpartition('.')[2]}{side.title()}"
                self._rows[name] = self._class(cls, side, name, container)
                found[side] = f"@property\ndef {side}(self) -> {MODULE}.{name}: ..."
        return found

    def _class(self, cls: str, side: str, name: str, container: str) -> list[str]:
        types: dict[str | int, set[str]] = {}
        for symbol in self._api.sockets(cls, side):
            kind = self._api.socket_type(symbol)
            text = kind.cls if isinstance(kind, Instance) else self._any
            keys = {
                *symbol.socket_names,
                *(() if NEVER_BY_IDENTIFIER in symbol.flags else (symbol.identifier,)),
                *(_subscript(written, side) for written in symbol.subscripts),
            }
            for one in keys - {"", None}:
                if one is not None:
                    types.setdefault(one, set()).add(text)
        by_type: dict[str, list[str | int]] = {}
        for key, texts in types.items():
            by_type.setdefault(next(iter(texts)) if len(texts) == 1 else self._any, []).append(key)
        rows = [f"class {name}({T}{container}):"]
        for text, keys in sorted(by_type.items()):
            literal = ", ".join(map(repr, sorted(keys, key=str)))
            rows += [
                "    @typing.overload",
                f"    def __getitem__(self, key: typing.Literal[{literal}], /) -> {text}: ...",
            ]
        return [
            *rows,
            "    @typing.overload",
            "    def __getitem__(self, key: typing_extensions.LiteralString, /) -> bpy._typing.NoSuchSocket: ...",
            "    @typing.overload",
            f"    def __getitem__(self, key: int | str, /) -> {self._any}: ...",
            "    @typing.overload",
            f"    def __getitem__(self, key: slice, /) -> list[{self._any}]: ...",
        ]

    def lines(self) -> list[str]:
        """The stub of the sockets' classes."""
        return [line for _, rows in sorted(self._rows.items()) for line in rows]


def _subscript(written: str, side: str) -> str | int | None:
    """The key of ``inputs[0]`` or ``inputs["Base Color"]``."""
    key = written.removeprefix(f"{side}[").removesuffix("]")
    if key.isdigit():
        return int(key)
    return key[1:-1] if key[:1] == '"' == key[-1:] else None
