"""A comparison with a value that the enumeration never has.

Blender does not refuse it: the condition simply never holds (with ``!=`` it always does), so the branch behind it is
dead. Often the value was renamed.

```python
if context.mode == "WEIGHT_PAINT":  # reported: the mode is called PAINT_WEIGHT
    ...
if context.mode == "PAINT_WEIGHT":
    ...
```

An empty text is not reported: Blender gives one where a file holds a value that this version does not know.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kb_check.rule import Rule
from kb_check.rules.lacking import lacking_finding

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.findings import Finding
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("compared"):
        if row.value:
            owner = row.missing[0]
            lacking = script.names.value(owner, row.value, script.api.values_of(owner))
            lacking = replace(lacking, message=f"{lacking.message} The comparison never matches it.")
            yield lacking_finding(script, RULE.id, row, lacking, RULE.severity)


RULE = Rule("never-true", "warning", "A comparison with a value that the enumeration never has", _check)
