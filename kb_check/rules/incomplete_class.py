"""A class that is registered without what Blender demands of it.

```python
class Grow(bpy.types.Operator):  # reported: bl_label
    bl_idname = "object.grow"


bpy.utils.register_class(Grow)
```

Blender refuses to register it. An operator without `bl_idname` gets the name of its class, which has no dot and is
refused as well.

Not reported: classes that the script does not register itself, those with a base that is not known, and scripts that
set such attributes later or by names that they compute.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_check.findings import Finding
from kb_check.own_classes import own_classes
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for own in own_classes(script):
        if not own.is_registered:
            continue
        known = [name for name in own.type.needs if script.api.member(own.path, name)]
        missing = [name for name in known if own.lacks(name)]
        if missing:
            names = ", ".join(f"`{name}`" for name in missing)
            yield Finding(
                RULE.id, "error", script.name_span(own.node),
                f"`{own.node.name}` lacks {names}: Blender registers {own.label} only with it.",
                f"{own.path}.{missing[0]}", tuple(f"{own.path}.{name}" for name in missing),
            )  # fmt: skip


RULE = Rule("incomplete-class", "error", "A registered class without what Blender demands", _check)
