"""A statement that does nothing.

```python
vector.normalized()  # reported: returns another vector; vector.normalize() changes this one
ob.location.xy.x = 1  # reported: location.xy is a copy
ob.matrix_world.to_euler().x = 1  # reported: likewise
bpy.context.selected_objects.append(ob)  # reported: each reading makes a new list
bpy.context.view_layer.objects.active == ob  # reported: compares; = assigns
mesh.vertices.foreach_set("normal", normals)  # reported: read-only, and foreach_set says nothing
```

Not reported: what changes the thing itself (``ob.location.x = 1``, ``ob.matrix_world.translation.x = 1``), attributes
that are only named, as notebooks do, and sizes of faces (``loop_total``) beside the ``loop_start`` that decides them.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Builtin, Function, Instance, Plain, Sequence
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import READ_ONLY
from kb_build.symbols.python_values import on_changing
from kb_check.findings import Edit, Finding, Fix
from kb_check.rule import Rule
from kb_check.syntax.words import named_words
from kb_serve.recognise.changed_by import changed_by

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

_MATH = "mathutils."
# Older Blenders ask for both, and scripts for all of them give both.
_FACE_SIZE, _FACE_START = f"{T}MeshPolygon.loop_total", "loop_start"
_SWIZZLE = re.compile(r"[xyzw]{2,4}")
_RETURNS_ITSELF = frozenset(
    {"freeze"}
)  # of what returns something in mathutils, all else leaves its owner as it is


def _check(script: Script) -> Iterator[Finding]:
    for node in script.all(ast.Expr, ast.Assign, ast.AugAssign):
        match node:
            case ast.Expr(value=ast.Call() as call):
                yield from _thrown_away(script, call)
                yield from _fills_read_only(script, call)
            case ast.Expr(value=ast.Compare(ops=[ast.Eq()]) as compared):
                yield from _compared(script, compared)
            case ast.Assign(targets=targets):
                for target in targets:
                    yield from _stored_in_copy(script, target)
            case ast.AugAssign(target=target):
                yield from _stored_in_copy(script, target)
            case _:
                pass


def _symbol_at(script: Script, node: ast.AST) -> Symbol | None:
    """The one symbol that a node surely stands for."""
    row = script.analysis.resolutions.get(node)
    if row is None or len(row.symbols) != 1 or row.missing or row.possible or not row.sure or row.guarded:
        return None
    return script.api.symbols.symbol(row.symbols[0])


def _thrown_away(script: Script, call: ast.Call) -> Iterator[Finding]:
    kind = script.type_of(call.func)
    if isinstance(kind, Function) and isinstance(kind.receiver, Instance):
        symbol = _symbol_at(script, call)
        if symbol is not None and _is_pure(symbol):
            yield _pure(script, call, symbol)
    elif isinstance(kind, Builtin) and isinstance(call.func, ast.Attribute):
        held = _symbol_at(script, call.func.value)
        if held is None:
            return
        if isinstance(kind.receiver, Plain) and kind.receiver.kind == "str":
            yield Finding(
                RULE.id, "warning", script.span(call),
                f"`{call.func.attr}` returns a new text and leaves `{held.path}` as it is: assign what it returns.",
                held.path,
            )  # fmt: skip
        elif isinstance(kind.receiver, Sequence) and (told := on_changing(held, call.func.attr)):
            yield Finding(RULE.id, "warning", script.span(call), told, held.path)


def _is_pure(symbol: Symbol) -> bool:
    return symbol.owner.startswith(_MATH) and bool(symbol.returns) and symbol.name not in _RETURNS_ITSELF


def _pure(script: Script, call: ast.Call, symbol: Symbol) -> Finding:
    in_place = next(
        (name for end in ("d", "ed") if (name := symbol.name.removesuffix(end)) != symbol.name
         and script.api.member(symbol.owner, name)), "",
    )  # fmt: skip
    told = f"`{symbol.path}` returns its result and changes nothing, and the result is not used."
    if not in_place or not isinstance(call.func, ast.Attribute):
        return Finding(RULE.id, "warning", script.span(call), told, symbol.path)
    path = f"{symbol.owner}.{in_place}"
    fix = Fix(f"Write {in_place}", (Edit(script.name_span(call.func), in_place),))
    return Finding(
        RULE.id,
        "warning",
        script.span(call),
        f"{told} `{in_place}` works in place.",
        symbol.path,
        (path,),
        fix,
    )


def _fills_read_only(script: Script, call: ast.Call) -> Iterator[Finding]:
    """A ``foreach_set`` of what is read-only, which Blender passes over in silence."""
    match call:
        case ast.Call(func=ast.Attribute(attr="foreach_set"), args=[ast.Constant() as name, *_]):
            symbol = _symbol_at(script, name)
        case _:
            return
    if symbol is None or READ_ONLY not in symbol.flags:
        return
    if symbol.path == _FACE_SIZE and _FACE_START in named_words(script):
        return
    told = f"`{symbol.path}` is read-only: `foreach_set` leaves it as it is, without an error."
    yield Finding(
        RULE.id, "warning", script.span(name), f"{told} {changed_by(symbol.path)[1]}".rstrip(), symbol.path
    )  # fmt: skip


def _compared(script: Script, node: ast.Compare) -> Iterator[Finding]:
    symbol = _symbol_at(script, node.left)
    if symbol is None or symbol.kind != "property" or READ_ONLY in symbol.flags:
        return
    left, right = script.span(node.left), script.span(node.comparators[0])
    between = type(left)(left.end_line, left.end_column, right.line, right.column)
    plain = script.text(between).strip() == "=="
    fix = Fix("Write =", (Edit(between, " = "),)) if plain else None
    yield Finding(
        RULE.id, "warning", script.span(node),
        f"This compares `{symbol.path}` and throws the answer away; `=` assigns.", symbol.path, (), fix,
    )  # fmt: skip


def _stored_in_copy(script: Script, target: ast.expr) -> Iterator[Finding]:
    if not isinstance(target, (ast.Attribute, ast.Subscript)):
        return
    node = target.value
    while _is_math(script, node):
        if isinstance(node, ast.Call):
            symbol = _symbol_at(script, node)
            if symbol is not None and symbol.kind == "function" and _is_pure(symbol):
                yield _copy_finding(script, target, f"What `{symbol.path}` returns")
            return
        if not isinstance(node, (ast.Attribute, ast.Subscript)):
            return
        if isinstance(node, ast.Attribute) and _is_math(script, node.value) and _SWIZZLE.fullmatch(node.attr):
            yield _copy_finding(script, target, f"`{node.attr}` of a vector")
            return
        node = node.value


def _copy_finding(script: Script, target: ast.expr, what: str) -> Finding:
    return Finding(
        RULE.id, "warning", script.span(target),
        f"{what} is a copy: the assignment changes nothing else. Assign to the property itself.",
    )  # fmt: skip


def _is_math(script: Script, node: ast.expr) -> bool:
    kind = script.type_of(node)
    return isinstance(kind, Instance) and kind.cls.startswith(_MATH)


RULE = Rule("no-effect", "warning", "A statement that does nothing", _check)
