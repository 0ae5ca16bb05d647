"""A class that is registered without what Blender demands of it, or with what it refuses.

```python
class Grow(bpy.types.Operator):  # reported: bl_label
    bl_idname = "object.grow"


bpy.utils.register_class(Grow)
```

Blender refuses to register it. An operator without `bl_idname` gets the name of its class, which has no dot and is
refused as well.

In editors with tools (`VIEW_3D`, `IMAGE_EDITOR`, `NODE_EDITOR`, `SEQUENCE_EDITOR`) only panels in region `UI` have a
category:

```python
class Tools(bpy.types.Panel):
    bl_label = "Tools"
    bl_space_type = "VIEW_3D"
    bl_region_type = "TOOLS"  # reported: "UI"
    bl_category = "Tools"
```

Not reported: classes that the script does not register itself, those with a base that is not known, and scripts that
set such attributes later or by names that they compute.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.findings import Finding, Fix
from kb_check.registered.blender_types import needs
from kb_check.registered.classes import own_classes
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.registered.classes import OwnClass
    from kb_check.script import Script

_PANEL = f"{T}Panel"
# The editors with tools: WM_TOOLSYSTEM_SPACE_MASK in Blender's code, and the region with categories in them.
_WITH_TOOLS = frozenset({"VIEW_3D", "IMAGE_EDITOR", "NODE_EDITOR", "SEQUENCE_EDITOR"})
_WITH_CATEGORIES = "UI"


def _check(script: Script) -> Iterator[Finding]:
    for own in own_classes(script):
        if not own.is_registered:
            continue
        missing = [name for name in needs(own.path, script.api) if own.lacks(name)]
        if missing:
            names = ", ".join(f"`{name}`" for name in missing)
            yield Finding(
                RULE.id, "error", script.name_span(own.node),
                f"`{own.node.name}` lacks {names}: Blender registers {own.label} only with it.",
                f"{own.path}.{missing[0]}", tuple(f"{own.path}.{name}" for name in missing),
            )  # fmt: skip
        elif own.path == _PANEL:
            yield from _refused_category(script, own)


def _refused_category(script: Script, own: OwnClass) -> Iterator[Finding]:
    """A panel with a category in a region that has none."""
    given = {
        name: value
        for name, value in own.attributes()
        if isinstance(value, ast.Constant) and isinstance(value.value, str)
    }
    names = ("bl_space_type", "bl_region_type", "bl_category")
    if not given.keys() >= set(names):
        return
    space, region, category = (given[name].value for name in names)
    if space not in _WITH_TOOLS or region == _WITH_CATEGORIES or not category:
        return
    node = given["bl_region_type"]
    is_inside = own.node.lineno <= node.lineno <= (own.node.end_lineno or 0)
    edit = script.renamed(node, _WITH_CATEGORIES) if is_inside else None
    yield Finding(
        RULE.id, "error", script.span(node) if is_inside else script.name_span(own.node),
        f"Blender refuses to register `{own.node.name}`: in {space!r} only panels in region {_WITH_CATEGORIES!r}, the "
        f"sidebar, have a `bl_category`, and this one is in {region!r}.",
        f"{_PANEL}.bl_category", (), Fix(f"Write {_WITH_CATEGORIES}", (edit,)) if edit else None,
    )  # fmt: skip


RULE = Rule("incomplete-class", "error", "A registered class that Blender refuses", _check)
