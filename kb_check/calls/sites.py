"""The calls of a script: what is called, and which parameter each argument goes to."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.values.types import ClassObject, Function, NoneValue, Operator, members
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import RETURNS_NONE
from kb_check.findings import Edit, Span
from kb_check.script import once_for_each, once_per_script
from kb_check.syntax.bindings import bindings
from kb_check.syntax.literals import times_bound
from kb_serve.signatures import signature_arguments

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Type
    from kb_build.symbols.records import Parameter, Symbol
    from kb_check.script import Script

_RNA_TYPE = re.compile(r"(boolean|int|float|string|enum|set\[enum\])(\[\d+\])*|list of \w+|[A-Z]\w*")
# Methods in C or Python whose reference spells the types of their parameters as RNA's.
_NOT_RNA = frozenset(
    {
        "bpy.types.Context.path_resolve", "bpy.types.Gizmo.target_get_value", "bpy.types.Gizmo.target_set_value",
        "bpy.types.Macro.define",
    }
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Callee:
    """What a call can give. ``positional`` are the names that take a place, ``keyword_only`` those that do not.

    ``place_only`` are those of the first that take no name.

    ``is_open`` is True where other keywords are taken or the signature does not tell, ``is_variadic`` where more may be
    given by place.
    """

    symbol: Symbol
    positional: tuple[str, ...]
    keyword_only: tuple[str, ...]
    is_open: bool
    is_rna: bool
    is_variadic: bool = False
    place_only: tuple[str, ...] = ()

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """What is known of each of them."""
        return self.symbol.parameters


@dataclass(frozen=True, slots=True)
class CallSite:
    """One call of one of the API's operators, functions or classes."""

    node: ast.Call
    callee: Callee
    has_unpacking: bool

    @property
    def given(self) -> set[str]:
        """The names of the parameters that are given."""
        return {parameter.name for parameter, _ in self.arguments()}

    def argument(self, name: str) -> ast.expr | None:
        """What is given for a parameter."""
        return next((node for parameter, node in self.arguments() if parameter.name == name), None)

    def arguments(self) -> Iterator[tuple[Parameter, ast.expr]]:
        """The arguments whose parameter is known."""
        by_name = {parameter.name: parameter for parameter in self.callee.parameters}
        for name, argument in zip(self.callee.positional, self.node.args, strict=False):
            if isinstance(argument, ast.Starred):
                break
            yield by_name[name], argument
        for keyword in self.node.keywords:
            if keyword.arg and (parameter := by_name.get(keyword.arg)):
                yield parameter, keyword.value


def _sure_calls(script: Script, errors: tuple[str, ...] = ()) -> Iterator[tuple[ast.Call, tuple[Type, ...]]]:
    """The calls that surely are of the API, each with the types of all that may be called; without those where the
    script is ready for one of the errors, of any where none is named.
    """
    for row in script.resolutions("call"):
        if isinstance(row.node, ast.Call) and row.sure and not row.is_ready_for(*errors):
            yield row.node, members(script.type_of(row.node.func) or NoneValue())


def calls(script: Script) -> list[CallSite]:
    """The calls that surely are of one thing of the API, in the order in which they stand.

    What receives it may be one of several: ``object.data.materials.append`` is the same of meshes and curves.
    """
    return calls_not_ready_for(script, ())


@once_for_each
def calls_not_ready_for(script: Script, errors: tuple[str, ...]) -> list[CallSite]:
    """The same, also where the script is ready for other errors than those, which are the names of their classes."""
    if errors and not _has_guarded_calls(script):
        return calls(script)
    found: list[CallSite] = []
    for node, called in _sure_calls(script, errors):
        kinds = [kind for kind in called if kind != NoneValue()]
        symbols = [_called(script, kind) for kind in kinds]
        if symbols and (symbol := symbols[0]) and all(other == symbol for other in symbols):
            found.append(_site(node, symbol))
    return found


@once_per_script
def _has_guarded_calls(script: Script) -> bool:
    """Whether any call is where the script is ready for some error."""
    return any(row.guarded for row in script.resolutions("call"))


@once_per_script
def calls_of_several(script: Script) -> list[CallSite]:
    """The calls that surely are of one of several functions with one signature: of the weightiest class."""
    found: list[CallSite] = []
    for node, kinds in _sure_calls(script):
        symbols = [symbol for kind in kinds if (symbol := _called(script, kind))]
        signatures = {symbol.signature for symbol in symbols}
        paths = {symbol.path for symbol in symbols}
        if len(kinds) == len(symbols) and len(paths) > 1 and len(signatures) == 1 and all(signatures):
            weights = script.names.reader.usage.weights([symbol.owner for symbol in symbols])
            found.append(_site(node, max(symbols, key=lambda symbol: weights.get(symbol.owner, 0.0))))
    return found


def _site(node: ast.Call, symbol: Symbol) -> CallSite:
    unpacking = any(isinstance(argument, ast.Starred) for argument in node.args) or any(
        keyword.arg is None for keyword in node.keywords
    )
    return CallSite(node, callee_of(symbol), unpacking)


def nothing_from(script: Script, node: ast.expr) -> str:
    """The function whose call a value surely is, where that returns nothing: ``mesh.vertices.add(3)``; or empty.

    RNA tells of its own functions; those without parameters may be Python's. Of mathutils' methods it was tried.
    """
    value = _once_held(script).get(node.id) if isinstance(node, ast.Name) else node
    call = calls_by_node(script).get(value) if isinstance(value, ast.Call) else None
    if call is not None and RETURNS_NONE in call.callee.symbol.flags:
        return call.callee.symbol.path
    if call is None or not call.callee.is_rna or call.callee.symbol.kind != "function":
        return ""
    return "" if call.callee.symbol.returns or not call.callee.parameters else call.callee.symbol.path


def other_way(script: Script, path: str) -> str:
    """Which method returns what another one makes of its value in place, as a further sentence; empty for none."""
    owner, _, name = path.rpartition(".")
    copying = next((other for end in ("d", "ed") if script.api.member(owner, other := name + end)), "")
    return f" `{copying}()` returns another one." if copying else ""


@once_per_script
def _once_held(script: Script) -> dict[str, ast.expr]:
    """Name → what it is bound to, of those that are bound once and used for nothing but to read from them, and to
    compute with them.
    """
    owners: set[ast.expr] = {node.value for node in script.all(ast.Attribute, ast.Subscript)}
    for node in script.all(ast.BinOp):
        owners |= {node.left, node.right}
    asked = {
        node.id for node in script.all(ast.Name) if isinstance(node.ctx, ast.Load) and node not in owners
    }
    times = times_bound(script)
    held = {name: values[0] for name, values in bindings(script).items() if times[name] == 1}
    return {name: value for name, value in held.items() if value is not None and name not in asked}


def giving(script: Script, call: ast.Call, argument: str) -> Edit | None:
    """The edit that gives a call one argument more; None where a comma or a comment stands behind the last."""
    whole = script.span(call)
    given = [*call.args, *(keyword.value for keyword in call.keywords)]
    if not given:
        place = Span(whole.end_line, whole.end_column - 1, whole.end_line, whole.end_column - 1)
        return Edit(place, argument)
    last = script.span(given[-1])
    behind = Span(last.end_line, last.end_column, whole.end_line, whole.end_column)
    return Edit.behind(last, f", {argument}") if script.text(behind) == ")" else None


@once_per_script
def calls_by_node(script: Script) -> dict[ast.Call, CallSite]:
    """The calls that surely are of one thing of the API, by where they stand."""
    return {call.node: call for call in calls(script)}


def _called(script: Script, kind: Type) -> Symbol | None:
    """The symbol that is called; None where a method is called by its class, which takes the instance first."""
    match kind:
        case Operator():
            return script.api.symbols.symbol(kind.path)
        case Function():
            symbol = script.api.symbols.symbol(kind.path)
            bound = not isinstance(kind.receiver, ClassObject)
            return symbol if symbol and (bound or {"classmethod", "static"} & set(symbol.flags)) else None
        case ClassObject():
            return script.api.symbols.symbol(kind.cls)
        case _:
            return None


def callee_of(symbol: Symbol) -> Callee:
    """What calls of an operator, a function or a class can give."""
    names = tuple(parameter.name for parameter in symbol.parameters)
    if symbol.kind == "operator":
        return Callee(symbol, (), names, is_open=False, is_rna=True)
    arguments = signature_arguments(symbol.signature)
    is_open = (
        arguments is None
        or arguments.vararg is not None
        or arguments.kwarg is not None
        or any(name.startswith("*") for name in names)
    )
    only = tuple(argument.arg for argument in arguments.kwonlyargs) if arguments else ()
    placed = (argument.arg for argument in (*arguments.posonlyargs, *arguments.args)) if arguments else names
    positional = tuple(name for name in placed if name in names)
    is_variadic = is_open and (arguments is None or arguments.kwarg is None or arguments.vararg is not None)
    is_rna = _is_rna(symbol)
    place_only = tuple(argument.arg for argument in arguments.posonlyargs) if arguments else ()
    return Callee(symbol, positional, only, is_open, is_rna, is_variadic, place_only)


def _is_rna(symbol: Symbol) -> bool:
    """Whether a function is RNA's own: only those spell the types of their parameters so."""
    owner = symbol.owner.removeprefix(TYPES)
    if (
        symbol.owner == owner
        or owner.startswith("bpy_")
        or symbol.kind != "function"
        or symbol.path in _NOT_RNA
    ):
        return False
    return "/" not in symbol.signature and all(
        _RNA_TYPE.fullmatch(parameter.plain_type) for parameter in symbol.parameters
    )
