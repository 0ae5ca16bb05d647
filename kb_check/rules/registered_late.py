"""A class that is registered behind what needs it.

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

Not reported: orders that are not written out in one place, and operators, which may be registered first.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.findings import Finding
from kb_check.literals import lists_left_alone, times_bound, written
from kb_check.made_here import callee_path
from kb_check.own_classes import own_classes
from kb_check.rule import Rule
from kb_check.script import once_per_script
from kb_check.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.own_classes import OwnClass
    from kb_check.script import Script

_PROPS = "bpy.props."
_REGISTER, _FACTORY = "bpy.utils.register_class", "bpy.utils.register_classes_factory"
_AT_ONCE = frozenset({f"{T}PropertyGroup", f"{T}AddonPreferences"})
_PANEL = f"{T}Panel"


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a class is registered: the statement of a body, and the place in its list."""

    body: int
    statement: int
    item: int = 0

    def is_behind(self, other: _Place) -> bool:
        """Whether this surely comes later."""
        return self.body == other.body and (self.statement, self.item) > (other.statement, other.item)


def _check(script: Script) -> Iterator[Finding]:
    places = _places(script)
    own = {one.node.name: one for one in own_classes(script)}
    for name, one in own.items():
        if name not in places:
            continue
        for node, needed in _needs(script, one, own):
            if needed in places and places[needed].is_behind(places[name]) and not is_tried(script, node):
                yield _finding(script, node, needed, f"`{name}`, which needs it", one.path)
    for body, number, statement in _statements(script):
        node = _element(script, statement.value) if isinstance(statement, ast.Assign) else None
        name = node.id if isinstance(node, ast.Name) else ""
        is_late = name in own and name in places and places[name].is_behind(_Place(body, number))
        if node is not None and is_late and not is_tried(script, node):
            yield _finding(script, node, name, "this property, which needs it", own[name].path)


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
def _places(script: Script) -> dict[str, _Place]:
    """Name → where the class is registered, of those that are bound once and registered once."""
    found: dict[str, list[_Place]] = {}
    for body, number, statement in _statements(script):
        match statement:
            case ast.Expr(value=ast.Call(args=[ast.Name(id=name)]) as call) if _calls(
                script, call, _REGISTER
            ):
                found.setdefault(name, []).append(_Place(body, number))
            case ast.For(target=ast.Name(id=name), iter=several) if any(
                isinstance(inner, ast.Expr)
                and isinstance(inner.value, ast.Call)
                and _calls(script, inner.value, _REGISTER)
                and [ast.unparse(part) for part in inner.value.args] == [name]
                for inner in statement.body
            ):
                for place, listed in enumerate(_listed(script, several)):
                    found.setdefault(listed, []).append(_Place(body, number, place))
            case ast.Assign(value=ast.Call(args=[several]) as call) if _calls(script, call, _FACTORY):
                for place, listed in enumerate(_listed(script, several)):
                    found.setdefault(listed, []).append(_Place(id(call), number, place))
            case _:
                pass
    times = times_bound(script)
    return {name: places[0] for name, places in found.items() if len(places) == 1 and times[name] == 1}


def _calls(script: Script, call: ast.Call, path: str) -> bool:
    return callee_path(script, call) == path


def _listed(script: Script, node: ast.expr) -> list[str]:
    """The names in a list that is written out."""
    if isinstance(node, ast.Name):
        node = lists_left_alone(script).get(node.id) or written(script, node)
    parts = node.elts if isinstance(node, (ast.Tuple, ast.List)) else []
    names = [part.id for part in parts if isinstance(part, ast.Name)]
    return names if len(names) == len(parts) else []


@once_per_script
def _statements(script: Script) -> list[tuple[int, int, ast.stmt]]:
    """(body, number, statement) of the statements of the module and of its functions."""
    bodies = [script.tree.body, *(node.body for node in script.all(ast.FunctionDef))]
    return [
        (place, number, statement)
        for place, body in enumerate(bodies)
        for number, statement in enumerate(body)
    ]


RULE = Rule("registered-late", "error", "A class that is registered behind what needs it", _check)
