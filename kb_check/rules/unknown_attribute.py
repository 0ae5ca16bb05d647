"""An attribute that a class of Blender's does not have.

Reported where the type of what stands before the dot is known, and no class that it can be has the name: neither
Blender's own, nor what the files of the same folder register (``bpy.types.Scene.my_settings = …``). Names in
``keyframe_insert("…")``, ``layout.prop(…, "…")`` and the like count too.

```python
bpy.context.object.draw_type = "WIRE"  # reported: display_type since 2.80
bpy.context.object.display_type = "WIRE"
```

Not reported: what stands behind ``hasattr``, in a ``try`` that catches AttributeError, or in a branch for another
version (``if bpy.app.version < (2, 80, 0)``).
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.facts import OBJECT_DATA
from kb_check.rule import Rule
from kb_check.rules.lacking import lacking_finding

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.types import Resolution
    from kb_check.findings import Finding
    from kb_check.script import Script

_CONTEXT = "bpy.types.Context"
_LET_PASS = frozenset({"driver_remove"})
# Before, what is assigned to an unknown name of a property group is lost, and no error.
_OF_SCRIPTS, _REFUSED = "bpy.types.PropertyGroup", (5, 0)


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("attribute", "store", "text", "button"):
        owner = _class_of(script, row.missing[0])
        if row.kind == "store" and script.version < _REFUSED and script.api.descends(owner, _OF_SCRIPTS):
            continue
        if not owner.startswith("bpy.ops") and script.api.is_class(owner) and owner != _CONTEXT:
            had = _owner_that_had(script, row, owner)
            lacking = script.names.member(had, row.value, reading=row.kind != "store")
            yield lacking_finding(script, RULE.id, row, lacking, "warning" if _is_let_pass(row) else "error")


def _is_let_pass(row: Resolution) -> bool:
    """Whether Blender does nothing, and raises no error: ``driver_remove`` of an unknown path returns False."""
    calls = (node for node in ast.walk(row.statement or row.node) if isinstance(node, ast.Call))
    functions = (call.func for call in calls if row.kind == "text" and row.node in call.args)
    return any(isinstance(function, ast.Attribute) and function.attr in _LET_PASS for function in functions)


def _owner_that_had(script: Script, row: Resolution, owner: str) -> str:
    """Of an object's data, which is of a class for each type of object, the class that had the name; or the owner."""
    read = script.analysis.resolutions.get(row.node.value) if isinstance(row.node, ast.Attribute) else None
    if read is None or read.symbols != ("bpy.types.Object.data",):
        return owner
    kinds = (f"bpy.types.{name}" for name in OBJECT_DATA.values())
    return next((kind for kind in kinds if script.names.had(kind, row.value)), owner)


def _class_of(script: Script, owner: str) -> str:
    """The class of a collection that is given by its property; any other owner as it is."""
    symbol = script.api.symbols.symbol(owner)
    if symbol is None or symbol.kind != "property" or symbol.type != "collection":
        return owner
    return f"bpy.types.{symbol.collection or 'bpy_prop_collection'}"


RULE = Rule("unknown-attribute", "error", "An attribute that the class does not have", _check)
