"""An argument that a call needs and does not have.

Blender refuses the call with a TypeError before anything is done.

```python
bpy.data.meshes.new()  # reported: name
bpy.data.meshes.new("Table")
```

Not reported: calls that unpack (``f(*args)``, ``f(**options)``), and modules whose reference shows one of several
signatures of a function.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_check.calls.missing_arguments import calls_with_too_little
from kb_check.findings import Finding
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for call, missing in calls_with_too_little(script):
        names = ", ".join(f"`{name}`" for name in missing)
        symbol = call.callee.symbol
        yield Finding(
            RULE.id, "error", script.span(call.node),
            f"`{symbol.path}` also needs {names}: `{symbol.signature}`.",
            f"{symbol.path}({missing[0]})",
        )  # fmt: skip


RULE = Rule("missing-argument", "error", "An argument that a call needs and does not have", _check)
