"""Finds places in Blender's scripts where a mistake can be planted that anybody who knows Blender would see.

A place counts as knowable by rules that are written here, beside the checker and without its analysis:

- ``bpy.context``, ``bpy.data``, ``bpy.ops`` and what RNA says of their members, one pointer after the other;
- ``context`` in the methods of operators, panels, menus and headers, and ``self.layout`` there, as Blender calls them;
- what a function of RNA returns (``layout.row()``, ``bpy.data.meshes.new(…)``), and the class that the literal in
  ``nodes.new("ShaderNodeMath")`` names;
- a name that its function binds once, to one of these or by a loop over a collection, and a collection's items;
- for enumerations also: a literal that is assigned to an attribute which only one property of the API is called like,
  wherever the owner's class can be told.

Code that is ready for mistakes is left out: in ``try``, beside ``hasattr``, for one version only.
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.blender.symbols import Symbols
    from kb_build.symbols.records import Parameter, Symbol

_T = "bpy.types."
_CALLED_BY_BLENDER = {
    "Operator": {"poll", "invoke", "execute", "modal", "draw", "check", "cancel"},
    "Panel": {"poll", "draw", "draw_header"},
    "Menu": {"poll", "draw"},
    "Header": {"draw"},
}
_CLASS = re.compile(r"^(?:bpy\.types\.)?(\w+)(?: \| None)?$")
_READY = re.compile(r"\bhasattr\(|\bgetattr\(|app\.version|build_options")
_HOLDS_CLASS = ("nodes",)


@dataclass(frozen=True, slots=True)
class Owner:
    """What an expression is known to be: an instance of a class (``path`` of the class) or a module.

    ``element`` is the class of what a collection holds.
    """

    path: str
    element: str = ""


@dataclass(frozen=True, slots=True)
class Place:
    """A part of a script that stands for something known.

    ``node`` is an attribute, a call, a keyword, a text; ``owner`` the path of the class, module, operator or function
    that it belongs to, ``symbol`` what it stands for.
    """

    kind: str  # attribute, operator, call, keyword, value, socket
    node: ast.AST
    owner: str
    symbol: Symbol
    statement: ast.stmt
    parameter: Parameter | None = None


@dataclass(slots=True)
class _Names:
    """What the names of one function are known to be."""

    known: dict[str, Owner] = field(default_factory=dict[str, Owner])
    layouts: bool = False  # whether ``self.layout`` is one
    contexts: bool = False


class Places:
    """Finds the places of scripts, by the symbols of one base."""

    def __init__(self, symbols: Symbols) -> None:
        self._symbols = symbols

    def lineage(self, path: str) -> Iterator[str]:
        """A class and its bases."""
        while path and (symbol := self._symbols.symbol(path)):
            yield path
            path = symbol.base

    def member(self, owner: str, name: str) -> Symbol | None:
        """A member of a class, inherited ones included, or of a module."""
        for path in list(self.lineage(owner)) or [owner]:
            for symbol in self._symbols.members(path):
                if symbol.name == name and symbol.kind != "socket":
                    return symbol
        return None

    def members(self, owner: str) -> list[Symbol]:
        """All members of a class, inherited ones included."""
        return [symbol for path in self.lineage(owner) for symbol in self._symbols.members(path)]

    def below(self, owner: str) -> Iterator[str]:
        """The classes below a class."""
        for path in self._symbols.subclasses(owner):
            yield path
            yield from self.below(path)

    def of(self, tree: ast.Module) -> Iterator[Place]:
        """Every place of a script."""
        if not _is_ready(tree.body):
            yield from self._of_body(tree.body, _Names())
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                bases = {
                    base.attr if isinstance(base, ast.Attribute) else getattr(base, "id", "")
                    for base in node.bases
                }
                for function in node.body:
                    if isinstance(function, ast.FunctionDef):
                        yield from self._of_function(function, bases)
            elif isinstance(node, ast.Module):
                for function in node.body:
                    if isinstance(function, ast.FunctionDef):
                        yield from self._of_function(function, set())

    def _of_function(self, function: ast.FunctionDef, bases: set[str]) -> Iterator[Place]:
        if _is_ready([function]):
            return
        names = _Names()
        called = any(function.name in _CALLED_BY_BLENDER.get(base, ()) for base in bases)
        parameters = [argument.arg for argument in function.args.args]
        if called and parameters[1:2] == ["context"]:
            names.known["context"] = Owner(f"{_T}Context")
            names.layouts = bool(bases & {"Panel", "Menu", "Header", "Operator"})
        yield from self._of_body(function.body, names)

    def _of_body(self, body: list[ast.stmt], names: _Names) -> Iterator[Place]:
        statements = list(_statements(body))
        bound = _bindings(body)
        for name in list(names.known):
            if name in bound:
                del names.known[name]
        for _ in range(3):  # a name may be bound by another one
            for statement in statements:
                match statement:
                    case ast.Assign(targets=[ast.Name(id=name)]) if bound.get(name) == 1:
                        if owner := self._known(statement.value, names):
                            names.known[name] = owner
                    case ast.For(target=ast.Name(id=name)) if bound.get(name) == 1:
                        if (owner := self._known(statement.iter, names)) and owner.element:
                            names.known[name] = Owner(owner.element)
                    case _:
                        pass
        for statement in statements:
            for node in _own_nodes(statement):
                yield from self._at(node, statement, names)

    def _known(self, node: ast.expr, names: _Names) -> Owner | None:  # noqa: PLR0911 - one return a form
        match node:
            case ast.Name(id="bpy"):
                return Owner("bpy")
            case ast.Name(id=name):
                return names.known.get(name)
            case ast.Attribute(value=ast.Name(id="self"), attr="layout") if names.layouts:
                return Owner(f"{_T}UILayout")
            case ast.Attribute():
                owner = self._known(node.value, names)
                return self._held(owner, node.attr) if owner else None
            case ast.Subscript(value=value, slice=key) if not isinstance(key, ast.Slice):
                owner = self._known(value, names)
                return Owner(owner.element) if owner and owner.element else None
            case ast.Call(func=ast.Attribute()):
                return self._made(node, names)
            case _:
                return None

    def _held(self, owner: Owner, name: str) -> Owner | None:
        path = f"{owner.path}.{name}"
        if path in {"bpy.context", "bpy.data"}:
            return Owner(f"{_T}{'Context' if name == 'context' else 'BlendData'}")
        symbol = self.member(owner.path, name)
        if symbol is None or (owner.path == "bpy" and name == "types"):
            return None
        if symbol.kind == "module":
            return Owner(symbol.path)
        if symbol.type == "pointer" and self._symbols.symbol(_T + symbol.target):
            return Owner(_T + symbol.target)
        if symbol.type == "collection":
            container = symbol.collection or "bpy_prop_collection"
            return Owner(_T + container, _T + symbol.target if symbol.target else "")
        return None

    def _made(self, call: ast.Call, names: _Names) -> Owner | None:
        assert isinstance(call.func, ast.Attribute)
        owner = self._known(call.func.value, names)
        # ``tree.nodes.new("ShaderNodeMath")``: the text is the class, whatever the tree is.
        if call.func.attr == "new" and isinstance(call.func.value, (ast.Name, ast.Attribute)):
            held = call.func.value.attr if isinstance(call.func.value, ast.Attribute) else call.func.value.id
            texts = [*call.args, *(word.value for word in call.keywords)]
            text = texts[0].value if texts and isinstance(texts[0], ast.Constant) else None
            if held in _HOLDS_CLASS and isinstance(text, str):
                if f"{_T}Node" in self.lineage(f"{_T}{text}"):
                    return Owner(f"{_T}{text}")
                return None
        if owner is None or not owner.path.startswith(_T):
            return None
        symbol = self.member(owner.path, call.func.attr)
        if symbol is None or symbol.kind != "function" or len(symbol.returns) != 1:
            return None
        found = _CLASS.match(symbol.returns[0].type)
        path = _T + found[1] if found else ""
        return Owner(path) if self._symbols.symbol(path) else None

    def _at(self, node: ast.AST, statement: ast.stmt, names: _Names) -> Iterator[Place]:  # noqa: PLR0912
        match node:
            case ast.Attribute(value=value, attr=name):
                if (owner := self._known(value, names)) and owner.path.startswith(_T):
                    symbol = self.member(owner.path, name)
                    if symbol:
                        yield Place("attribute", node, owner.path, symbol, statement)
                        if isinstance(node.ctx, ast.Store) and symbol.type == "enum":
                            assigned = statement.value if isinstance(statement, ast.Assign) else None
                            if isinstance(assigned, ast.Constant) and isinstance(assigned.value, str):
                                yield Place("value", assigned, symbol.path, symbol, statement)
            case ast.Call(func=ast.Attribute(value=value, attr=name)):
                owner = self._known(value, names)
                symbol = self.member(owner.path, name) if owner else None
                if symbol is None or symbol.kind not in {"operator", "function"}:
                    return
                if symbol.kind == "operator":
                    yield Place("operator", node.func, symbol.owner, symbol, statement)
                yield Place("call", node, symbol.path, symbol, statement)
                for keyword in node.keywords:
                    parameter = next((p for p in symbol.parameters if p.name == keyword.arg), None)
                    if parameter is None:
                        continue
                    yield Place("keyword", keyword, symbol.path, symbol, statement, parameter)
                    if parameter.enum_items and _is_text(keyword.value):
                        yield Place("value", keyword.value, symbol.path, symbol, statement, parameter)
            case ast.Subscript(
                value=ast.Attribute(value=value, attr="inputs" | "outputs" as side), slice=key
            ):
                owner = self._known(value, names)
                if owner and isinstance(key, ast.Constant) and isinstance(key.value, str):
                    found = [
                        symbol for symbol in self.members(owner.path)
                        if symbol.kind == "socket" and f".{side}[" in symbol.path
                    ]  # fmt: skip
                    for symbol in found:
                        if key.value in {symbol.name, symbol.label}:
                            yield Place("socket", key, owner.path, symbol, statement)
                            break
            case _:
                pass


def _is_text(node: ast.expr | None) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _is_ready(body: list[ast.stmt]) -> bool:
    """Whether a function asks what there is before it uses it."""
    return any(
        _READY.search(ast.unparse(statement)) for statement in body if not isinstance(statement, ast.ClassDef)
    )


def _statements(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """The statements of a function that run in it, outside of ``try``."""
    for statement in body:
        yield statement
        if isinstance(statement, (ast.Try, ast.FunctionDef, ast.ClassDef, ast.AsyncFunctionDef)):
            continue
        for field_name in ("body", "orelse", "finalbody"):
            yield from _statements(getattr(statement, field_name, []))


def _own_nodes(statement: ast.stmt) -> Iterator[ast.AST]:
    """The nodes of a statement without those of the statements in it, and of what has names of its own."""
    if isinstance(statement, (ast.Try, ast.FunctionDef, ast.ClassDef, ast.AsyncFunctionDef, ast.Delete)):
        return
    queue: list[ast.AST] = [statement]
    while queue:
        node = queue.pop()
        yield node
        queue.extend(
            child for child in ast.iter_child_nodes(node)
            if not isinstance(child, (ast.stmt, ast.Lambda, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp))
        )  # fmt: skip


def _bindings(body: list[ast.stmt]) -> dict[str, int]:
    """How often each name is bound."""
    found: dict[str, int] = {}
    for statement in body:
        for node in ast.walk(statement):
            bound = isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load)
            name = getattr(node, "id" if bound else "name", None)
            if isinstance(name, str):
                found[name] = found.get(name, 0) + 1
    return found
