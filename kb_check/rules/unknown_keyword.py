"""A keyword that a function or an operator does not take.

Blender refuses it with a TypeError before anything is done.

```python
bpy.ops.mesh.primitive_cube_add(radius=1)  # reported: size since 2.80
bpy.ops.mesh.primitive_cube_add(size=2)
```
"""

from __future__ import annotations

import ast
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_check.rule import Rule
from kb_check.rules.lacking import lacking_finding

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.records import Parameter
    from kb_check.findings import Finding
    from kb_check.script import Script

_TAKES = {
    "boolean": {bool, int},
    "int": {bool, int},
    "float": {bool, int, float},
    "string": {str},
    "enum": {str},
}


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("keyword"):
        function = row.missing[0]
        symbol = script.api.symbols.symbol(function)
        parameters = {parameter.name: parameter for parameter in symbol.parameters} if symbol else {}
        lacking = script.names.parameter(function, row.value, parameters)
        named = parameters.get(lacking.replacement.rpartition("(")[2].removesuffix(")"))
        if named is not None and not _may_take(named, row.node):
            lacking = replace(lacking, replacement="", sure=False)
        yield lacking_finding(script, RULE.id, row, lacking)


def _may_take(parameter: Parameter, node: ast.AST) -> bool:
    """Whether a parameter may take the literal that is given: what was a switch may have become a choice."""
    value = node.value if isinstance(node, ast.keyword) else None
    if not isinstance(value, ast.Constant) or parameter.plain_type not in _TAKES:
        return True
    return type(value.value) in _TAKES[parameter.plain_type]


RULE = Rule("unknown-keyword", "error", "A keyword that the call does not take", _check)
