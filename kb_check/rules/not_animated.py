"""A slot of an action for a type of data-block that cannot be animated.

```python
action.slots.new("ACTION", "Slot")  # reported: id_type is what the slot animates, say 'OBJECT'
```
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.sites import calls
from kb_check.findings import Finding
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_NEW = f"{T}ActionSlots.new"


def _check(script: Script) -> Iterator[Finding]:
    for call in calls(script):
        for parameter, node in call.arguments() if call.callee.symbol.path == _NEW else ():
            if parameter.name != "id_type" or not isinstance(node, ast.Constant):
                continue
            cls = f"{T}{str(node.value).title()}"
            if script.api.is_class(cls) and script.api.member(cls, "animation_data") is None:
                yield Finding(
                    RULE.id, "warning", script.span(node),
                    f"`{cls}` has no animation data. `id_type` is the type of data-block that the slot animates: "
                    "'OBJECT', 'MATERIAL', 'KEY', …", _NEW,
                )  # fmt: skip


RULE = Rule("not-animated", "warning", "A slot for what cannot be animated", _check)
