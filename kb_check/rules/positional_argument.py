"""An argument without its name where Blender takes none, or with it where it takes no names.

Functions of Blender's classes take by place only what they need; since 2.80 the rest is given by name. Operators take
by place nothing but an execution context and whether to push an undo step; until 3.6 a dictionary before them set the
context, since 4.0 that is ``with bpy.context.temp_override(...)``. The classes of mathutils take one sequence.
Functions written in C often take no names, or none for what comes first: those of ``bmesh.utils``, and of vertices,
edges and faces of a BMesh.

```python
ob.shape_key_add("Smile")  # reported
ob.shape_key_add(name="Smile")
bpy.ops.object.select_all("SELECT")  # reported
bpy.ops.object.select_all(action="SELECT")
bpy.ops.mesh.primitive_cube_add(
    4
)  # reported: Blender takes the number for a truth value, and makes the usual cube
bpy.ops.mesh.primitive_cube_add(size=4)
vert.select_set(select=True)  # reported: vert.select_set(True)
bm.verts.new(co=(0, 0, 1))  # reported: bm.verts.new((0, 0, 1))
Vector(0, 0, 1)  # reported
Vector((0, 0, 1))
```
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.values.types import (
    NONE,
    UNKNOWN,
    Mapping,
    NoneValue,
    Plain,
    Sequence,
    Tuple,
    literal_text,
    members,
)
from kb_check.calls.sites import calls
from kb_check.findings import Edit, Finding, Fix
from kb_check.rule import Rule
from kb_check.syntax.bindings import bindings
from kb_check.text.brackets import bracketed
from kb_check.values.conversions import misfit
from kb_check.values.given import parameter_taker
from simworlds.counting import counted

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Parameter
    from kb_check.calls.sites import Callee, CallSite
    from kb_check.script import Script

_EXECUTION_CONTEXTS = frozenset(
    f"{how}_{where}"
    for how in ("INVOKE", "EXEC")
    for where in ("DEFAULT", "REGION_WIN", "REGION_CHANNELS", "REGION_PREVIEW", "AREA", "SCREEN")
)
_NO_CONTEXT = re.compile(r"[^A-Z_]")  # in no execution context's name
_FORMAT = re.compile(r"%(\(\w*\))?[-+ #0-9.*]*\w")
_FIELD = re.compile(r"\{[^{}]*\}")
_PATHS = frozenset(
    {"os.path.join", "os.path.abspath", "bpy.path.abspath"}
)  # what these return has a separator
_NO_DICTIONARY_SINCE = (4, 0)
# Where the reference shows one of several signatures, or leaves an argument out.
_UNRELIABLE = ("aud.", "freestyle.", "bpy.types.Gizmo.target_set_value", "mathutils.geometry.normal")


def _check(script: Script) -> Iterator[Finding]:
    for call in calls(script):
        if call.callee.symbol.kind == "operator":
            yield from _of_operator(script, call)
        elif _takes_places(call.callee):
            yield from _of_function(script, call)


def _takes_places(callee: Callee) -> bool:
    """Whether it is a function, or a class of which it is known how it takes what is given."""
    return callee.symbol.kind == "function" or callee.symbol.owner == "mathutils" or bool(callee.place_only)


def _of_operator(script: Script, call: CallSite) -> Iterator[Finding]:
    path = call.callee.symbol.path
    arguments = call.node.args
    if not arguments or any(isinstance(argument, ast.Starred) for argument in arguments):
        return
    # One that is filled in a loop is one of several.
    kinds = [kind for kind in members(script.type_of(arguments[0]) or UNKNOWN) if kind != NONE]
    dictionary = bool(kinds) and all(isinstance(kind, Mapping) for kind in kinds)
    if dictionary and script.version < _NO_DICTIONARY_SINCE:
        arguments = arguments[1:]
        dictionary = False
    if dictionary:
        yield Finding(
            RULE.id, "error", script.span(arguments[0]),
            f"`{path}` takes no dictionary with a context since Blender 4.0: call it inside "
            "`with bpy.context.temp_override(...)`.",
            path, ("bpy.types.Context.temp_override",),
        )  # fmt: skip
        return
    for place, argument in enumerate(arguments):
        if place < 2 and not _is_wrong(script, argument):
            continue
        parameter = _meant(call, script, argument) if len(arguments) == 1 else None
        yield Finding(
            RULE.id, "error", script.span(argument),
            f"`{path}` takes no properties by place, only an execution context (`'INVOKE_DEFAULT'`, "
            f"`'EXEC_DEFAULT'` …) and whether to push an undo step: {_advice(parameter)}",
            path, (f"{path}({parameter.name})",) if parameter else (),
            _naming(script, call, argument, parameter) if parameter else None,
        )  # fmt: skip
        return


def _is_wrong(script: Script, argument: ast.expr) -> bool:
    """Whether an argument is surely neither an execution context nor a truth value."""
    kind = script.type_of(argument)
    text = literal_text(kind) if kind is not None else None
    if text is not None:
        return text not in _EXECUTION_CONTEXTS
    if _is_number(argument):
        return True
    values = bindings(script).get(argument.id, []) if isinstance(argument, ast.Name) else [argument]
    if len(values) == 1 and values[0] and any(map(_NO_CONTEXT.search, _texts(values[0]))):
        return True
    return isinstance(kind, (NoneValue, Tuple, Sequence)) or (
        isinstance(kind, Plain) and kind.kind == "float"
    )


def _is_number(node: ast.expr) -> bool:
    """Whether an argument is written as a number that nobody writes for a truth value."""
    value = node
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        value = node.operand
    return (
        isinstance(value, ast.Constant)
        and isinstance(value.value, int)
        and not isinstance(value.value, bool)
        and (value is not node or value.value > 1)
    )


def _texts(node: ast.expr) -> Iterator[str]:
    """What is surely in a text that is put together: ``.obj`` of ``f"{name}.obj"`` and ``"%s.obj" % name``, a separator
    of a path.
    """
    match node:
        case ast.Constant(value=str(text)):
            yield text
        case ast.JoinedStr(values=parts):
            for part in parts:
                yield from _texts(part)
        case ast.BinOp(op=ast.Mod(), left=ast.Constant(value=str(text))):
            yield _FORMAT.sub("", text)
        case ast.Call(func=ast.Attribute(value=ast.Constant(value=str(text)), attr="format")):
            yield _FIELD.sub("", text)
        case ast.Call(func=ast.Attribute() as function) if ast.unparse(function) in _PATHS:
            yield "/"
        case ast.BinOp(op=ast.Add(), left=left, right=right):
            yield from _texts(left)
            yield from _texts(right)
        case _:
            pass


def _meant(call: CallSite, script: Script, argument: ast.expr) -> Parameter | None:
    """The one parameter that a text can be a value of."""
    kind = script.type_of(argument)
    text = literal_text(kind) if kind is not None else None
    taking = [p for p in call.callee.parameters if any(item.identifier == text for item in p.enum_items)]
    free = [parameter for parameter in taking if parameter.name not in call.given]
    return free[0] if len(free) == 1 else None


def _advice(parameter: Parameter | None) -> str:
    return f"write `{parameter.name}=`." if parameter else "give them by name."


def _of_function(script: Script, call: CallSite) -> Iterator[Finding]:
    callee = call.callee
    path = callee.symbol.path
    arguments = call.node.args
    named = next((keyword for keyword in call.node.keywords if keyword.arg in callee.place_only), None)
    if named is not None:
        yield Finding(
            RULE.id, "error", script.span(named),
            f"`{path}` takes `{named.arg}` by place only: `{callee.symbol.signature}`.", path,
            (), _by_place(script, call),
        )  # fmt: skip
        return
    starred = any(isinstance(argument, ast.Starred) for argument in arguments)
    if (
        starred
        or callee.is_variadic
        or path.startswith(_UNRELIABLE)
        or len(arguments) <= len(callee.positional)
    ):
        return
    if not callee.parameters and not callee.symbol.has_empty_signature:
        return
    extra = arguments[len(callee.positional)]
    by_name = {parameter.name: parameter for parameter in callee.parameters}
    rest = [name for name in callee.keyword_only if name not in call.given]
    gone = script.names.changed_parameters(path)
    if not rest:
        count = len(callee.positional)
        takes = "no arguments" if not callee.parameters else f"{counted(count, 'argument')} by place"
        advice = " Its numbers are one sequence." if callee.symbol.kind == "class" else ""
        # As many as are too many are what is given.
        advice += "".join(f" {one.message}" for one in gone if len(gone) == len(arguments) - count)
        yield Finding(
            RULE.id, "error", script.span(extra),
            f"`{path}` takes {takes}: `{callee.symbol.signature}`.{advice}", path,
        )  # fmt: skip
        return
    # RNA's functions took all by place once: the order is that of the parameters, unless some are gone.
    parameter = by_name[rest[0]] if callee.is_rna and len(arguments) == len(callee.positional) + 1 else None
    gone = gone if callee.is_rna else ()
    if gone or (parameter and _takes_other_things(script, call, parameter, extra)):
        parameter = None
    yield Finding(
        RULE.id, "error", script.span(extra),
        f"`{path}` takes {', '.join(f'`{name}`' for name in rest[:8])} by name only: "
        + (f"write `{parameter.name}=`." if parameter else f"`{callee.symbol.signature}`.")
        + "".join(f" {lacking.message}" for lacking in gone),
        path, (f"{path}({rest[0]})",),
        _naming(script, call, extra, parameter) if parameter else None,
    )  # fmt: skip


def _takes_other_things(script: Script, call: CallSite, parameter: Parameter, value: ast.expr) -> bool:
    """Whether a parameter takes what a value surely is not: what is given was meant of another."""
    taker = parameter_taker(script, call.callee.symbol, parameter, is_rna=call.callee.is_rna)
    # One item of a set of several becomes a set by the fix.
    return taker.kind != "set" and misfit(script, taker, value) is not None


def _by_place(script: Script, call: CallSite) -> Fix | None:
    """The arguments without the names that are not taken, where they stand in their places already."""
    places = call.callee.place_only[len(call.node.args) :]
    named = [keyword for keyword in call.node.keywords if keyword.arg in places]
    in_places = [keyword.arg for keyword in named] == list(places[: len(named)])
    if not in_places or named != call.node.keywords[: len(named)]:
        return None
    edits = tuple(Edit(script.span(keyword), ast.unparse(keyword.value)) for keyword in named)
    return Fix("Leave out the names", edits, sure=True)


def _naming(script: Script, call: CallSite, argument: ast.expr, parameter: Parameter) -> Fix:
    """An argument with the name of a parameter."""
    place = call.node.args.index(argument)
    span = bracketed(script, argument, call.node.args[place - 1] if place else call.node.func)
    is_set = parameter.type == "enum" and isinstance(parameter.default, list)
    if is_set and isinstance(argument, ast.Constant):  # one item of several that may be given
        edit = Edit(span, f"{parameter.name}={{{argument.value!r}}}")
    else:
        edit = Edit.before(span, f"{parameter.name}=")
    return Fix(f"Write {parameter.name}=", (edit,), sure=True)


RULE = Rule("positional-argument", "error", "An argument without its name where Blender takes none", _check)
