"""A class that is registered behind what needs it, or not at all.

Blender looks at what a class refers to when it registers the class: a group of properties in another group, the panel
that a panel lies in. So it does with a property that is given to one of its own classes.

```python
class Part(bpy.types.PropertyGroup): ...


class Settings(bpy.types.PropertyGroup):
    parts: bpy.props.CollectionProperty(type=Part)


classes = (Settings, Part)  # reported: Part, Settings
for cls in classes:
    bpy.utils.register_class(cls)
```

So is a group that another one, or a property of one of Blender's own classes, refers to, and that the script does not
register.

Not reported: orders that are not written out in one place, operators, which may be registered first, and groups that
the script names anywhere else than where they are referred to.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path
from kb_check.findings import Finding
from kb_check.registered.classes import own_classes
from kb_check.registered.left_out import is_named_only_in
from kb_check.registered.order import registrations, statements
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script
from kb_check.syntax.literals import times_bound, written

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.registered.classes import OwnClass
    from kb_check.registered.order import Registration
    from kb_check.script import Script

_PROPS = "bpy.props."
_AT_ONCE = frozenset({f"{T}PropertyGroup", f"{T}AddonPreferences"})
_GROUP, _PANEL = f"{T}PropertyGroup", f"{T}Panel"


def _check(script: Script) -> Iterator[Finding]:
    places = _places(script)
    own = {one.node.name: one for one in own_classes(script)}
    for name, one in own.items():
        if name not in places:
            continue
        for node, needed in _needs(script, one, own):
            if (
                own[needed].path == _GROUP
                and _is_left_out(script, own[needed])
                and not is_tried(script, node)
            ):
                told = f"`{needed}` is never registered, and `{name}` needs it: Blender refuses to register that."
                yield Finding(RULE.id, "error", script.span(node), told, own[needed].path)
                continue
            if (
                needed in places
                and places[needed].is_behind(places[name].place)
                and not is_tried(script, node)
            ):
                yield _finding(script, node, needed, f"`{name}`, which needs it", one.path)
    for body, number, statement in statements(script):
        node = _element(script, statement.value) if isinstance(statement, ast.Assign) else None
        name = node.id if isinstance(node, ast.Name) else ""
        is_late = name in own and name in places and places[name].is_behind((body, number, 0))
        if node is None or name not in own or is_tried(script, node):
            continue
        if is_late:
            yield _finding(script, node, name, "this property, which needs it", own[name].path)
        elif own[name].path == _GROUP and _is_left_out(script, own[name]):
            told = (
                f"`{name}` is never registered, and this property needs it: `register_class({name})` first."
            )
            yield Finding(RULE.id, "error", script.span(node), told, _GROUP)


def _is_left_out(script: Script, one: OwnClass) -> bool:
    """Whether nothing in a script names a class but what refers to it, nor finds classes by themselves."""
    return is_named_only_in(script, one, {_element(script, call) for call in script.all(ast.Call)})


def _finding(script: Script, node: ast.expr, name: str, before: str, path: str) -> Finding:
    told = f"`{name}` is registered behind {before}: Blender refuses that. Register `{name}` first."
    return Finding(RULE.id, "error", script.span(node), told, path)


def _needs(script: Script, one: OwnClass, own: dict[str, OwnClass]) -> Iterator[tuple[ast.expr, str]]:
    """What a class refers to, and the name of the class that this is."""
    if one.path in _AT_ONCE:
        for statement in one.node.body:
            node = _element(script, statement.annotation) if isinstance(statement, ast.AnnAssign) else None
            if isinstance(node, ast.Name) and node.id in own:
                yield node, node.id
    if one.path == _PANEL:
        above = _text(script, one, "bl_parent_id")
        for name, other in own.items():
            if (
                above
                and other.path == _PANEL
                and above[1] == (_text(script, other, "bl_idname") or (None, name))[1]
            ):
                yield above[0], name


def _text(script: Script, one: OwnClass, name: str) -> tuple[ast.expr, str] | None:
    node = one.value(name)
    value = written(script, node) if node is not None else None
    text = value.value if isinstance(value, ast.Constant) else None
    return (node, text) if node is not None and isinstance(text, str) else None


def _element(script: Script, node: ast.expr) -> ast.expr | None:
    """The class that a declaration is a pointer to, or a collection of."""
    if not isinstance(node, ast.Call) or not callee_path(script, node).startswith(_PROPS):
        return None
    return next((keyword.value for keyword in node.keywords if keyword.arg == "type"), None)


@once_per_script
def _places(script: Script) -> dict[str, Registration]:
    """Name → where the class is registered, of those that are bound once and registered once."""
    times = times_bound(script)
    found = registrations(script)
    return {name: places[0] for name, places in found.items() if len(places) == 1 and times[name] == 1}


RULE = Rule("registered-late", "error", "A class that is registered behind what needs it, or never", _check)
