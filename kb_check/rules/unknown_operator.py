"""An operator that does not exist.

``bpy.ops`` finds an operator only when it is called, so a wrong name is an error late. Operators that the files of the
same folder register are known; those of other add-ons cannot be, so a script that calls them says so in a comment
(``# simworlds: ignore[unknown-operator]``), or enables the add-on: then what no Blender has is a note. Those of the
add-ons that Blender brings, as Rigify, are known: a warning where no file enables theirs.

```python
bpy.ops.object.select_pattern_by_name()  # reported
bpy.ops.object.select_pattern(pattern="Cube*")
```
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS
from kb_check.names.lacking import lacking_finding
from kb_check.rule import Rule
from kb_check.syntax.words import members_taken

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Resolution
    from kb_check.findings import Finding
    from kb_check.names.known import Lacking
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("attribute", "button"):
        owner = row.missing[0]
        if owner.startswith("bpy.ops"):
            name = row.value.removeprefix(OPERATORS) if row.kind == "button" else row.value
            lacking = _of_lost_module(script, row) or script.names.member(owner, name)
            yield lacking_finding(script, RULE.id, row, lacking)


def _of_lost_module(script: Script, row: Resolution) -> Lacking | None:
    """What became of an operator whose module is gone, or what is like one of a module that never was."""
    name = members_taken(script).get(row.node) if isinstance(row.node, ast.expr) else None
    if not name:
        return None
    module = f"{row.missing[0]}.{row.value}"
    lacking = script.names.path(f"{module}.{name}") or script.names.member(module, name)
    return lacking if lacking.removed or lacking.instead else None


RULE = Rule("unknown-operator", "error", "An operator that does not exist", _check)
