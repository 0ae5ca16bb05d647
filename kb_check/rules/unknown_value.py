"""A value that an enumeration does not have.

Looked at where a literal is assigned or given to a call; a comparison is the rule ``never-true``'s. Enumerations whose
values Blender puts together while it runs (images, installed engines) are left out.

```python
scene.render.engine = "BLENDER_EEVEE_NEXT"  # reported in 5.0: BLENDER_EEVEE
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
    for row in script.missing("value"):
        owner = row.missing[0]
        values = script.api.values_of(owner)
        yield lacking_finding(script, RULE.id, row, script.names.value(owner, row.value, values))


RULE = Rule("unknown-value", "error", "A value that the enumeration does not have", _check)
