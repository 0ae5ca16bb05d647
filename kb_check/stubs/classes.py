"""Classes as the definitions of a stub."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import COLLECTION, STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_check.stubs.annotations import ANY
from kb_check.stubs.names import docstring, is_writable
from kb_check.stubs.properties import open_class_body
from kb_check.stubs.python_protocols import GENERIC, body

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kb_build.symbols.records import Symbol
    from kb_check.stubs.annotations import Annotations
    from kb_check.stubs.families import Members
    from kb_check.stubs.functions import Functions
    from kb_check.stubs.overloads import Overloads
    from kb_check.stubs.properties import Properties
    from kb_check.stubs.sockets import Sockets

_DEFINED = re.compile(r"^(?:def )?(\w+)(?=[(:])")


# What makes an instance of a class in C whose documentation does not say it.
_UNTOLD = f"def __init__(self, *args: {ANY}, **kwargs: {ANY}) -> None: ..."


class Classes:
    """Writes classes."""

    def __init__(  # noqa: PLR0913, PLR0917 - one for each kind of member
        self,
        annotations: Annotations,
        properties: Properties,
        functions: Functions,
        overloads: Overloads,
        sockets: Sockets,
        symbols: Iterable[Symbol],
    ) -> None:
        self._annotations = annotations
        self._api = annotations.api
        self._properties = properties
        self._functions = functions
        self._overloads = overloads
        self._sockets = sockets
        self._elements: dict[str, str] = {}
        for symbol in symbols:
            if symbol.type == "collection" and symbol.collection:
                self._elements.setdefault(f"{T}{symbol.collection}", f"{T}{symbol.target}")
        self.left_out: list[str] = []

    def members(self, cls: str) -> Members:
        """What a class declares itself: name → declaration, in full names."""
        found: Members = {}
        spelled = _methods(body(cls))
        for name, symbol in sorted(self._api.own(cls).items()):
            if not is_writable(name):
                self.left_out.append(symbol.path)
            elif name not in spelled and not self._is_inherited(symbol, cls):
                found[name] = self._declare(symbol, cls)
        found |= self._sockets.declare(cls)
        if items := self._overloads.items(self._elements.get(cls, "")):
            found["__getitem__"] = items
        symbol = self._api.symbols.symbol(cls)
        if symbol and "__init__" not in spelled and "__init__" not in found:
            if symbol.parameters:
                text = self._functions.signature(symbol).text("self")
                found["__init__"] = f"def __init__({text}) -> None: ..."
            elif not symbol.signature and not cls.startswith(T):
                found["__init__"] = _UNTOLD
        if extra := open_class_body(cls):
            found["__getattr__"] = extra
        return found | spelled

    def _declare(self, symbol: Symbol, cls: str) -> str:
        if symbol.kind == "function":
            return self._overloads.define(symbol, cls)
        if symbol.kind in {"property", "context"}:
            return self._properties.declare(symbol)
        return f"{symbol.name}: {self._annotations.text(symbol.type, symbol.path) if symbol.type else ANY}"

    def _is_inherited(self, symbol: Symbol, cls: str) -> bool:
        """Whether a base has the very same."""
        bases = self._api.lineage(cls)[1:]
        if symbol.name.startswith("bl_rna_get_subclass") and (cls != STRUCT):
            return cls not in {COLLECTION} or not bases
        return symbol.same_as.rpartition(".")[0] in bases

    def bases(self, cls: str) -> str:
        """The bases of a class as they stand between the brackets."""
        symbol = self._api.symbols.symbol(cls)
        base = symbol.base if symbol and self._api.is_class(symbol.base) else ""
        parts: list[str] = []
        if element := self._elements.get(cls):
            parts.append(f"{COLLECTION}[{self._annotations.instance(element)}]")
        elif base in GENERIC and "bpy._typing.T]" in GENERIC[base] and "metaclass" not in GENERIC[base]:
            base = f"{base}[{ANY}]"
        if base:
            parts.append(base)
        if cls in GENERIC:
            if "Generic" not in GENERIC[cls] and "metaclass" not in GENERIC[cls]:
                return GENERIC[cls]
            parts.append(GENERIC[cls])
        return ", ".join(parts)

    def doc(self, cls: str, *, with_docs: bool) -> str:
        """The docstring of a class; empty for none."""
        symbol = self._api.symbols.symbol(cls)
        return docstring(symbol.label, symbol.description) if with_docs and symbol else ""


def lines_of(name: str, bases: str, members: Mapping[str, str], doc: str) -> list[str]:
    """The lines of a class."""
    head = f"class {name}({bases}):" if bases else f"class {name}:"
    rows = [doc] if doc else []
    # Properties come first: a method must not hide the decorator that one needs behind it.
    for declaration in members.values():
        rows += declaration.splitlines()
    return [head, *(f"    {row}" for row in rows)] if rows else [f"{head} ..."]


def _methods(text: str) -> dict[str, str]:
    """The members that a body spells: name → its whole text, overloads together."""
    found: dict[str, list[str]] = {}
    block: list[str] = []
    for line in text.splitlines():
        block.append(line)
        if not line.startswith((" ", "@", ")")) or line.startswith(")"):
            is_open = line.count("(") > line.count(")")
            if is_open:
                continue
            name = next((m[1] for row in block if (m := _DEFINED.match(row))), "")
            found.setdefault(name, []).extend(block)
            block = []
    return {name: "\n".join(rows) for name, rows in found.items() if name}
