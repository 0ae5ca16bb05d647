"""A class or function that a module of Blender's does not have.

Modules are those that Blender brings: ``bpy`` and what is below it, ``mathutils``, ``bmesh``, ``gpu``, ``bpy_extras``
and so on; an import counts as well as a use. Operators have a rule of their own.

```python
bpy.data.groups["Trees"]  # reported: collections since 2.80
from bpy_extras.io_utils import orientation_helper_factory
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
    for row in script.missing("attribute", "store", "name"):
        owner = row.missing[0]
        if owner.startswith("bpy.ops") or (row.kind != "name" and script.api.is_class(owner)):
            continue
        symbol = script.api.symbols.symbol(owner)
        if symbol is None or symbol.kind == "module" or row.kind == "name":
            yield lacking_finding(script, RULE.id, row, script.names.member(owner, row.value))


RULE = Rule("unknown-name", "error", "A class or function that the module does not have", _check)
