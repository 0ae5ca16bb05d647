"""A keyword that a function or an operator does not take.

Blender refuses it with a TypeError before anything is done.

```python
bpy.ops.mesh.primitive_cube_add(radius=1)  # reported: size since 2.80
bpy.ops.mesh.primitive_cube_add(size=2)
bpy.ops.object.duplicate_move(TRANSFORM_OT_translate={"proportional": "DISABLED"})  # reported
layout.operator("object.delete").use_gobal = True  # reported: use_global
```
"""

from __future__ import annotations

import ast
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, Function, members
from kb_build.symbols.paths import argument_of
from kb_check.names.lacking import lacking_finding
from kb_check.names.renaming import may_take
from kb_check.rule import Rule
from kb_check.values.given import assigned

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Resolution
    from kb_check.findings import Finding
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("keyword"):
        function = _function_that_took(script, row)
        symbol = script.api.symbols.symbol(function)
        parameters = {parameter.name: parameter for parameter in symbol.parameters} if symbol else {}
        value = _given(script, row)
        text = ast.unparse(value) if isinstance(value, ast.Constant) else ""
        lacking = script.names.parameter(function, row.value, parameters, text)
        named = parameters.get(argument_of(lacking.replacement))
        if named is not None and value is not None and not may_take(script, named, value):
            lacking = replace(lacking, replacement="", sure=False)
        yield lacking_finding(script, RULE.id, row, lacking)


def _function_that_took(script: Script, row: Resolution) -> str:
    """The function that is called; of those of several types that it may be, the one that took the keyword once."""
    call = next((one for one in script.all(ast.Call) if row.node in one.keywords), None)
    kinds = members(script.type_of(call.func) or UNKNOWN) if call else ()
    paths = [kind.path for kind in kinds if isinstance(kind, Function)]
    once = (
        (path for path in paths if script.names.path(f"{path}({row.value})")) if len(paths) > 1 else iter(())
    )
    return next(once, row.missing[0])


def _given(script: Script, row: Resolution) -> ast.expr | None:
    """What is given by a keyword, by a button's setting or by a key of a dictionary; None for nothing."""
    match row.node:
        case ast.keyword(value=value):
            return value
        case ast.Attribute():
            return assigned(row.statement, row.node)
        case _:
            pairs = (
                pair for node in script.all(ast.Dict) for pair in zip(node.keys, node.values, strict=True)
            )
            return next((value for key, value in pairs if key is row.node), None)


RULE = Rule("unknown-keyword", "error", "A keyword that the call does not take", _check)
