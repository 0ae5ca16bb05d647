"""A keyword that a function or an operator does not take.

Blender refuses it with a TypeError before anything is done.

```python
bpy.ops.mesh.primitive_cube_add(radius=1)  # reported: size since 2.80
bpy.ops.mesh.primitive_cube_add(size=2)
```
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_check.rule import Rule
from kb_check.rules.lacking import lacking_finding

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.findings import Finding
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("keyword"):
        function = row.missing[0]
        symbol = script.api.symbols.symbol(function)
        names = [parameter.name for parameter in symbol.parameters] if symbol else []
        yield lacking_finding(script, RULE.id, row, script.names.parameter(function, row.value, names))


RULE = Rule("unknown-keyword", "error", "A keyword that the call does not take", _check)
