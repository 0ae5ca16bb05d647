"""A member of ``bpy.context`` that no editor gives.

The context has what every editor has, and what some editors add to it (``selected_nodes`` in the node editor). A name
that none of them gives is reported.

```python
bpy.context.selected_meshes  # reported
bpy.context.selected_objects
```
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import CONTEXT
from kb_check.names.lacking import lacking_finding
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.findings import Finding
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("attribute", "store"):
        if row.missing[0] == CONTEXT:
            yield lacking_finding(script, RULE.id, row, script.names.member(CONTEXT, row.value))


RULE = Rule("unknown-context-member", "error", "A member that the context does not have", _check)
