"""A modifier or a constraint by a name that Blender does not give to new ones.

```python
bpy.ops.object.modifier_add(type="NODES")
ob.modifiers["Geometry Nodes"]  # a warning: it is called "GeometryNodes"
ob.constraints.new("TRACK_TO")
ob.constraints["TrackTo"]  # a warning: it is called "Track To"
```

The key of an action's slot is its identifier, which begins with two letters for the type of data:

```python
action.slots.new(id_type="OBJECT", name="Cube")
action.slots["Cube"]  # an error: its key is "OBCube"
```

The others are warnings, since the file may have one that is called so. Not reported: names that stand anywhere else in
the script, types of which the script adds none without a name, scripts that compute names, and what stands in a
``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Collection, Instance
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.sites import calls
from kb_check.findings import Edit, Finding, Fix
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names
from kb_check.running.raised import LACKS_KEY
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script
from kb_check.syntax.words import texts_but_keys

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_SLOT = Instance(f"{T}ActionSlot")
# What adds one of some type without a name → the members that hold what it adds.
_ADDING = {
    "bpy.ops.object.modifier_add": "modifiers",
    "bpy.ops.object.constraint_add": "constraints",
    "bpy.ops.pose.constraint_add": "constraints",
    f"{T}ObjectConstraints.new": "constraints",
    f"{T}PoseBoneConstraints.new": "constraints",
}


def _check(script: Script) -> Iterator[Finding]:
    if computes_names(script):
        return
    for node in script.all(ast.Subscript):
        match node:
            case ast.Subscript(
                value=ast.Attribute(attr="modifiers" | "constraints" | "slots" as holder) as items,
                slice=ast.Constant(value=str(asked)) as key,
            ) if isinstance(kind := script.type_of(items), Collection):
                pass
            case _:
                continue
        if kind.element == _SLOT and asked in _slots(script) and not is_tried(script, node, LACKS_KEY):
            yield Finding(
                RULE.id, "error", script.span(key),
                f"The key of a slot is its `identifier`, two letters for the type of data and the name: that of the "
                f"slot {asked!r} of an object is {'OB' + asked!r}.",
                f"{T}ActionSlot.identifier",
            )  # fmt: skip
        meant = script.names.names_of_new.meant(holder, asked)
        makers = _makers(script).get((holder, meant.choice)) if meant else None
        if meant and makers and asked not in texts_but_keys(script) and not is_tried(script, node, LACKS_KEY):
            yield Finding(
                RULE.id, "warning", script.span(key),
                f"What `{makers}` adds with {meant.choice!r} is called {meant.name!r}, and nothing here is called "
                f"{asked!r}. Better keep what `{holder}.new` returns.",
                makers, (), Fix(f"Write {meant.name!r}", (Edit(script.span(key), repr(meant.name)),)),
            )  # fmt: skip


@once_per_script
def _slots(script: Script) -> frozenset[str]:
    """The names that the script gives new slots of actions."""
    made = (
        call.argument("name") for call in calls(script) if call.callee.symbol.path == f"{T}ActionSlots.new"
    )
    return frozenset(
        name.value for name in made if isinstance(name, ast.Constant) and isinstance(name.value, str)
    )


@once_per_script
def _makers(script: Script) -> dict[tuple[str, str], str]:
    """(member that holds them, type) → the path of what the script adds such with, without a name."""
    found: dict[tuple[str, str], str] = {}
    for call in calls(script):
        path = call.callee.symbol.path
        kind = call.argument("type") if path in _ADDING else None
        if isinstance(kind, ast.Constant) and isinstance(kind.value, str):
            found[_ADDING[path], kind.value] = path
    return found


RULE = Rule("default-name", "warning", "A modifier or constraint by a name that new ones do not have", _check)
