"""Every module of Blender's API as the text of a stub."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.flow.blender.api import Api
from kb_build.flow.blender.symbols import SymbolList
from kb_build.flow.values.types import Instance
from kb_build.symbols.api_names import TYPES as T
from kb_check.stubs import enums, families, sockets
from kb_check.stubs.annotations import ANY, Annotations
from kb_check.stubs.classes import Classes, lines_of
from kb_check.stubs.enums import Enums
from kb_check.stubs.families import Families
from kb_check.stubs.functions import BMESH_OPERATORS, Functions
from kb_check.stubs.names import docstring, hidden_names, imports_of, is_writable, shorten
from kb_check.stubs.overloads import Overloads
from kb_check.stubs.properties import Properties
from kb_check.stubs.python_protocols import TYPING
from kb_check.stubs.sockets import Sockets

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kb_build.symbols.records import Symbol

TYPING_MODULE = "bpy._typing"
# Multiple inheritance and Blender's own overriding do not keep to the rules that are made for scripts.
MARK = "# Written by simworlds from Blender's own description of its API."
_HEAD = (
    f"{MARK}\n# pyright: reportIncompatibleVariableOverride=false, reportIncompatibleMethodOverride=false, "
    "reportOverlappingOverload=false, reportInconsistentOverload=false, reportPrivateUsage=false"
)


@dataclass(slots=True)
class Stubs:
    """The stubs of one Blender: module → text, which modules hold others, and what could not be written."""

    modules: dict[str, str] = field(default_factory=dict[str, str])
    packages: set[str] = field(default_factory=set[str])
    left_out: list[str] = field(default_factory=list[str])


def write_modules(symbols: Sequence[Symbol], *, with_docs: bool = False) -> Stubs:
    """The stubs of what ``symbols`` tell; ``with_docs``: with a sentence about each."""
    return _Writer(symbols, with_docs=with_docs).write()


class _Writer:
    def __init__(self, symbols: Sequence[Symbol], *, with_docs: bool) -> None:
        self._with_docs = with_docs
        self._symbols = symbols
        self._api = Api(SymbolList(symbols))
        self._enums = Enums(symbols)
        self._families = Families(self._api)
        self._annotations = Annotations(self._api, self._enums, self._families)
        self._functions = Functions(self._annotations, with_docs=with_docs)
        self._sockets = Sockets(self._api, self._families)
        overloads = Overloads(self._annotations, self._functions)
        properties = Properties(self._annotations, with_docs=with_docs)
        self._classes = Classes(
            self._annotations, properties, self._functions, overloads, self._sockets, symbols
        )
        self._stubs = Stubs()
        self._modules: set[str] = set()
        self._declared: dict[str, families.Members] = {}

    def write(self) -> Stubs:
        modules = sorted(symbol.path for symbol in self._symbols if symbol.kind == "module")
        self._modules = {*modules, families.MODULE, sockets.MODULE, enums.MODULE, TYPING_MODULE}
        self._stubs.packages = {module.rpartition(".")[0] for module in modules if "." in module}
        for symbol in self._symbols:
            if symbol.kind == "class":
                self._declared[symbol.path] = self._classes.members(symbol.path)
        for module in modules:
            if all(is_writable(part) for part in module.split(".")):
                self._stubs.modules[module] = self._module(module)
            else:
                self._stubs.left_out.append(module)
        self._stubs.left_out = sorted(self._stubs.left_out + self._classes.left_out)
        own = self._stubs.modules
        own[families.MODULE] = self._text(families.MODULE, self._families.lines(self._declared))
        own[sockets.MODULE] = self._text(sockets.MODULE, self._sockets.lines())
        own[enums.MODULE] = self._text(enums.MODULE, self._enums.lines())
        own[TYPING_MODULE] = self._text(TYPING_MODULE, TYPING.strip("\n").splitlines())
        return self._stubs

    def _module(self, module: str) -> str:
        members = self._api.own(module)
        rows: list[str] = []
        said = self._api.symbols.symbol(module)
        if self._with_docs and said and (text := docstring(said.description)):
            rows.append(text)
        inner: list[str] = []
        for name, symbol in sorted(members.items()):
            if symbol.kind == "module":
                inner.append(f"from . import {name} as {name}")
            elif symbol.kind == "enum":
                continue
            elif not is_writable(name):
                self._stubs.left_out.append(symbol.path)
            else:
                rows += self._member(symbol, hidden_names(members))
        return self._text(module, rows, inner)

    def _member(self, symbol: Symbol, hidden: frozenset[str]) -> list[str]:
        module = symbol.owner
        match symbol.kind:
            case "class":
                return self._class(symbol.path, module)
            case "function":
                text = self._functions.define(symbol)
                if module == BMESH_OPERATORS and symbol.returns:
                    text = f"{self._functions.operator_result(symbol)}\n{text}"
            case "operator":
                text = self._functions.operator(symbol)
            case _:
                member = self._api.member(module, symbol.name)
                kind = member.type if member else None
                if isinstance(kind, Instance) and kind.cls.startswith(T) and symbol.target:
                    text = f"{symbol.name}: {kind.cls}"
                else:
                    text = f"{symbol.name}: {self._annotations.text(symbol.type, symbol.path) if symbol.type else ANY}"
        return shorten(text, module, hidden).splitlines()

    def _class(self, cls: str, module: str) -> list[str]:
        members = self._declared[cls]
        hidden = hidden_names(members)
        written = {name: shorten(text, module, hidden) for name, text in members.items()}
        bases = shorten(self._classes.bases(cls), module)
        doc = self._classes.doc(cls, with_docs=self._with_docs)
        return lines_of(cls.rpartition(".")[2], bases, written, doc)

    def _text(self, module: str, rows: Iterable[str], inner: Iterable[str] = ()) -> str:
        body = "\n".join(rows)
        imports = imports_of(body, module, self._modules)
        return "\n".join([_HEAD, *sorted(set(imports)), *inner, "", body, ""])
