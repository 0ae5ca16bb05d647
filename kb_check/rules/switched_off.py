"""A setting that Blender greys out as long as another is off, on something that the script has just made.

```python
camera = bpy.data.cameras.new("Camera")
camera.dof.focus_distance = 3  # reported: camera.dof.use_dof is off on a new camera, and stays off
```

Blender's own panels tell which settings have such a switch.

Not reported: things that the script did not make itself, which may have the switch on; scripts that name the switch
anywhere, or set settings by names that they compute; and values that a new thing has anyway.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.schema import TEST_ON
from kb_build.symbol_lines import fillers, usual_default
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.script import once_per_script

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.records import Symbol
    from kb_check.script import Script

_DEEPEST = 8
_ID = "bpy.types.ID"
_WORD = re.compile(r"\w+")
_COMPUTING = frozenset({"setattr", "exec", "eval"})
_OBJECTS_NEW = "bpy.types.BlendDataObjects.new"


def _check(script: Script) -> Iterator[Finding]:
    for row in script.resolutions("store"):
        node = row.node
        certain = row.sure and not row.guarded and not row.missing and len(row.symbols) == 1
        if not certain or not isinstance(node, ast.Attribute):
            continue
        gate = _switch(script, row.symbols[0])
        if gate is None or gate.name in _named(script) or _has_default(script, row.statement, row.symbols[0]):
            continue
        if not _computes_names(script) and _is_new(script, node.value):
            yield Finding(
                RULE.id, "note", script.name_span(node),
                f"Blender's panels grey `{row.symbols[0]}` out unless `{gate.name}` is on. A new one has it off, and "
                "this script does not turn it on.", gate.path, (gate.path,),
            )  # fmt: skip


def _switch(script: Script, path: str) -> Symbol | None:
    """The truth value of the same thing, off on every new one, that must be on before panels let a property be set."""
    reader = script.names.reader
    rows = reader.panel_tests(path)
    for row in rows:
        alone = sum(other.clause == row.clause for other in rows) == 1
        if not alone or row.hides or row.test != TEST_ON:
            continue
        gate = script.api.symbols.symbol(row.gate)
        if gate is None or not reader.descends(path.rpartition(".")[0], gate.owner):
            continue
        values = [new.value for new in gate.new_values] or [usual_default(gate)]
        if "compared" in gate.flags and all(value is False for value in values):
            return gate
    return None


def _has_default(script: Script, statement: ast.stmt | None, path: str) -> bool:
    """Whether a statement assigns what a new thing has, or something that is not one expression."""
    if not isinstance(statement, ast.Assign):
        return True
    symbol = script.api.symbols.symbol(path)
    try:
        value = ast.literal_eval(statement.value)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        return False
    default = usual_default(symbol) if symbol else None
    return value is None or value == (tuple(default) if isinstance(default, list) else default)


@once_per_script
def _named(script: Script) -> frozenset[str]:
    """Every word of the script that may name a setting."""
    found: set[str] = set()
    for node in script.nodes:
        match node:
            case ast.Attribute(attr=name) | ast.keyword(arg=str(name)):
                found.add(name)
            case ast.Constant(value=str(text)):
                found.update(_WORD.findall(text))
            case _:
                pass
    return frozenset(found)


@once_per_script
def _computes_names(script: Script) -> bool:
    """Whether something out of sight may set settings: computed names, or the files beside the script."""
    return any(
        (isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _COMPUTING)
        or (isinstance(node, ast.ImportFrom) and node.level > 0)
        for node in script.nodes
    )


def _is_new(script: Script, node: ast.expr, depth: int = _DEEPEST) -> bool:
    """Whether the script has surely made what an expression is, or what it belongs to."""
    if not depth:
        return False
    match node:
        case ast.Name():
            values = _bindings(script).get(node.id, [None])
            handed_on = node.id in _handed_on(script)
            return not handed_on and all(value and _is_new(script, value, depth - 1) for value in values)
        case ast.Call():
            return _callee(script, node).endswith(".new")
        case ast.Attribute():
            return _is_new_member(script, node, depth)
        case _:
            return False


def _is_new_member(script: Script, node: ast.Attribute, depth: int) -> bool:
    row = script.analysis.resolutions.get(node)
    symbol = script.api.symbols.symbol(row.symbols[0]) if row and len(row.symbols) == 1 else None
    if symbol is None or symbol.type != "pointer":
        return False
    if calls := fillers(symbol):
        return any(call.partition("(")[0] in _operators(script) for call in calls)
    if symbol.name == "data" and symbol.owner == "bpy.types.Object":
        return _is_new(script, node.value, depth - 1) and _has_new_data(script, node.value, depth - 1)
    points_elsewhere = script.names.reader.descends(f"bpy.types.{symbol.target}", _ID)
    return not points_elsewhere and _is_new(script, node.value, depth - 1)


def _has_new_data(script: Script, node: ast.expr, depth: int) -> bool:
    """Whether a new object was made with new data."""
    values = _bindings(script).get(node.id, []) if isinstance(node, ast.Name) else [node]
    return bool(values) and all(
        isinstance(value, ast.Call)
        and _callee(script, value) == _OBJECTS_NEW
        and len(value.args) > 1
        and _is_new(script, value.args[1], depth)
        for value in values
    )


def _callee(script: Script, call: ast.Call) -> str:
    row = script.analysis.resolutions.get(call)
    return row.symbols[0] if row and row.kind == "call" and len(row.symbols) == 1 and row.sure else ""


@once_per_script
def _operators(script: Script) -> frozenset[str]:
    """The operators that the script calls."""
    rows = script.resolutions("call", "attribute")
    return frozenset(path for row in rows for path in row.symbols if path.startswith("bpy.ops."))


@once_per_script
def _bindings(script: Script) -> dict[str, list[ast.expr | None]]:
    """Name → everything that it is bound to, None for what is no expression."""
    found: dict[str, list[ast.expr | None]] = {}
    assigned: set[ast.Name] = set()
    for node in script.nodes:
        match node:
            case ast.Assign(targets=[ast.Name() as name]) | ast.AnnAssign(target=ast.Name() as name):
                found.setdefault(name.id, []).append(node.value)
                assigned.add(name)
            case ast.arg(arg=name):
                found.setdefault(name, []).append(None)
            case _:
                pass
    for node in script.nodes:
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and node not in assigned:
            found.setdefault(node.id, []).append(None)
    return found


@once_per_script
def _handed_on(script: Script) -> frozenset[str]:
    """The names whose values are passed to functions that are neither the API's nor the script's own."""
    own = {node.name for node in script.nodes if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    found: set[str] = set()
    for node in script.nodes:
        if isinstance(node, ast.Call) and not _callee(script, node):
            function = node.func
            name = function.id if isinstance(function, ast.Name) else getattr(function, "attr", "")
            if name not in own:
                arguments = (*node.args, *(keyword.value for keyword in node.keywords))
                found.update(value.id for value in arguments if isinstance(value, ast.Name))
    return frozenset(found)


RULE = Rule("switched-off", "note", "A setting whose switch is off", _check)
