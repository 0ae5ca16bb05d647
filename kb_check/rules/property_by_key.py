"""A registered property, read or set by its name in brackets.

Until Blender 4.5 a property of `bpy.props` was kept among the custom properties of its owner. Since 5.0 it has a place
of its own: brackets, `get` and `in` do not find it, and what they set is another thing. The same holds for the settings
of Cycles, which Blender's own add-on registers.

```python
bpy.types.Scene.count = bpy.props.IntProperty()
bpy.context.scene["count"] = 3  # reported: bpy.context.scene.count = 3
bpy.context.scene.get("count")  # reported
bpy.context.scene["cycles"]["samples"] = 64  # reported: bpy.context.scene.cycles.samples = 64
```

Not reported: properties with `get` or `set`, which keep their value where they like; and those of property groups.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, ClassObject, Instance, members
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path
from kb_check.findings import Finding, Fix
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_SINCE = 5, 0
_COMPUTED = frozenset({"get", "set", "get_transform", "set_transform"})
_GROUP = f"{T}PropertyGroup"


def _check(script: Script) -> Iterator[Finding]:
    if script.version < _SINCE:
        return
    for node in script.all(ast.Subscript, ast.Compare, ast.Call):
        for owner, key in _asked(node):
            name = key.value if isinstance(key, ast.Constant) else None
            if not isinstance(name, str):
                continue
            cls = _declared(script).get(name, "")
            is_own = bool(cls) and _is_of(script, owner, cls)
            cls = cls if is_own else _brought(script, owner, name)
            if not cls or is_tried(script, node):
                continue
            asks = isinstance(node, ast.Compare)
            advice = f"`{ast.unparse(owner)}.{name}`" if not asks else f"`is_property_set({name!r})`"
            whose = "that this script registers, which is" if is_own else "that an add-on registers, which is"
            yield Finding(
                RULE.id, "warning", script.span(node),
                f"`{name}` is a property of `{cls}` {whose} no custom property since Blender 5.0: write {advice}.",
                f"{cls}.{name}", (), _as_attribute(script, node, is_group=not is_own),
            )  # fmt: skip


@once_per_script
def _declared(script: Script) -> dict[str, str]:
    """Name → class, of the properties that the script gives to classes and that keep their values themselves."""
    found: dict[str, str] = {}
    for node in script.all(ast.Assign):
        call = node.value
        if not isinstance(call, ast.Call) or not callee_path(script, call).startswith("bpy.props."):
            continue
        for target in node.targets:
            kind = script.type_of(target.value) if isinstance(target, ast.Attribute) else None
            if isinstance(target, ast.Attribute) and isinstance(kind, ClassObject):
                computed = any(keyword.arg in _COMPUTED or keyword.arg is None for keyword in call.keywords)
                again = found.get(target.attr, kind.cls) != kind.cls
                is_kept = not computed and not again and not script.api.descends(kind.cls, _GROUP)
                found[target.attr] = kind.cls if is_kept else ""
    return found


def _asked(node: ast.Subscript | ast.Compare | ast.Call) -> Iterator[tuple[ast.expr, ast.expr]]:
    """(owner, key) where a node asks for a custom property."""
    match node:
        case ast.Subscript():
            yield node.value, node.slice
        case ast.Compare(left=key, ops=[ast.In() | ast.NotIn()], comparators=[owner]):
            yield owner, key
        case ast.Call(func=ast.Attribute(value=owner, attr="get"), args=[key, *_]):
            yield owner, key
        case _:
            pass


def _is_of(script: Script, node: ast.expr, cls: str) -> bool:
    kinds = members(script.type_of(node) or UNKNOWN)
    return all(isinstance(kind, Instance) and script.api.descends(kind.cls, cls) for kind in kinds)


def _brought(script: Script, owner: ast.expr, name: str) -> str:
    """The class of a value, if an add-on that Blender brings gives it a group of properties of this name."""
    cls = script.class_of(owner)
    kind = member.type if cls and (member := script.api.member(cls, name)) else None
    return cls if isinstance(kind, Instance) and script.api.descends(kind.cls, _GROUP) else ""


def _as_attribute(script: Script, node: ast.expr, *, is_group: bool) -> Fix | None:
    """Nothing is assigned to a group itself, and no attribute is deleted."""
    if (
        not isinstance(node, ast.Subscript)
        or not isinstance(node.slice, ast.Constant)
        or isinstance(node.ctx, (ast.Del, ast.Store) if is_group else ast.Del)
    ):
        return None
    name = str(node.slice.value)
    return Fix(f"Write .{name}", (script.as_attribute(node, name),))


RULE = Rule("property-by-key", "warning", "A registered property by its name in brackets", _check)
