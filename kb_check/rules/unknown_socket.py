"""A socket that a node does not have.

Sockets are asked for by identifier or by the name that the node shows; what the running Blender still takes by a
former name is no finding.

```python
principled = nodes.new("ShaderNodeBsdfPrincipled")
principled.inputs["Specular"]  # reported since 4.0: Specular IOR Level
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
    for row in script.missing("item"):
        if any(_still_works(script, node, row.value) for node in row.missing):
            continue
        node = row.missing[0]
        names = [s.name for side in ("inputs", "outputs") for s in script.api.sockets(node, side)]
        yield lacking_finding(
            script, RULE.id, row, script.names.socket(node, row.value, dict.fromkeys(names))
        )


def _still_works(script: Script, node: str, name: str) -> bool:
    return any(script.names.still_works(f'{node}.{side}["{name}"]') for side in ("inputs", "outputs"))


RULE = Rule("unknown-socket", "error", "A socket that the node does not have", _check)
