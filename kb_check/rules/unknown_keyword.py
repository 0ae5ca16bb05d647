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

from kb_build.symbols.paths import argument_of
from kb_check.rule import Rule
from kb_check.rules.lacking import lacking_finding
from kb_check.rules.renaming import may_take

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.findings import Finding
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("keyword"):
        function = row.missing[0]
        symbol = script.api.symbols.symbol(function)
        parameters = {parameter.name: parameter for parameter in symbol.parameters} if symbol else {}
        lacking = script.names.parameter(function, row.value, parameters)
        named = parameters.get(argument_of(lacking.replacement))
        value = row.node.value if isinstance(row.node, ast.keyword) else row.node
        if named is not None and isinstance(value, ast.expr) and not may_take(script, named, value):
            lacking = replace(lacking, replacement="", sure=False)
        yield lacking_finding(script, RULE.id, row, lacking)


RULE = Rule("unknown-keyword", "error", "A keyword that the call does not take", _check)
