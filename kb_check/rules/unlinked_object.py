"""A new object that is selected, hidden or made active before it is in a collection.

```python
cube = bpy.data.objects.new("Cube", mesh)
cube.select_set(True)  # reported: bpy.context.collection.objects.link(cube) comes before
bpy.context.view_layer.objects.active = cube  # so it does for this
```

Blender refuses each, since no view layer has the object; ``hide_set(True)`` too. Not reported: objects that the
statements between may have linked: those that name the object otherwise than to read from it, or that link what they
find or call what is not known; and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.facts import SET_ACTIVE
from kb_build.flow.types import Instance
from kb_build.symbols.api_names import OBJECT
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path, member_path
from kb_check.calls.sites import calls_by_node
from kb_check.findings import Finding
from kb_check.modes.edit_bones import bound_in, names_of_others, surely_run
from kb_check.modes.keeping import is_harmless, run_in
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names
from kb_check.running.tried import is_tried
from kb_check.scene.made_here import OBJECTS_NEW
from kb_check.syntax.bindings import bindings
from kb_check.syntax.bodies import bodies

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_COPY = f"{T}ID.copy"
# What needs the object in the view layer when it is given True.
_REFUSED = frozenset({f"{OBJECT}.select_set", f"{OBJECT}.hide_set"})


def _check(script: Script) -> Iterator[Finding]:
    if computes_names(script):
        return
    for body in bodies(script):
        unlinked: set[str] = set()
        for statement in body:
            if unlinked:
                yield from _refused(script, statement, unlinked)
                unlinked -= _taken(script, statement, unlinked)
                unlinked -= set(bound_in(statement))
            if name := _makes(script, statement):
                unlinked.add(name)


def _makes(script: Script, statement: ast.stmt) -> str:
    """The name of the new object that a statement makes; empty for none."""
    match statement:
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call):
            path, kind = callee_path(script, call), script.type_of(call)
            is_copy = path == _COPY and isinstance(kind, Instance) and kind.sure and kind.cls == OBJECT
            return name if (path == OBJECTS_NEW or is_copy) and name not in names_of_others(script) else ""
        case _:
            return ""


def _refused(script: Script, statement: ast.stmt, unlinked: set[str]) -> Iterator[Finding]:
    for node in (statement, *surely_run(statement)):
        match node:
            case ast.Call(func=ast.Attribute(value=ast.Name(id=name), attr=what)):
                path, place = callee_path(script, node), node
                site = calls_by_node(script).get(node)
                given = site.argument("state") if site else None
                is_refused = path in _REFUSED and isinstance(given, ast.Constant) and given.value is True
            case ast.Assign(targets=[ast.Attribute() as target], value=ast.Name(id=name)):
                path, place, what = member_path(script, target), target, "active"
                is_refused = path == SET_ACTIVE
            case _:
                continue
        if is_refused and name in unlinked and not is_tried(script, place):
            unlinked.discard(name)  # once is enough
            yield Finding(
                RULE.id, "error", script.span(place),
                f"`{name}` is in no collection yet, so no view layer has it, and Blender refuses `{what}`: "
                f"`bpy.context.collection.objects.link({name})` comes before.",
                path,
            )  # fmt: skip


def _taken(script: Script, statement: ast.stmt, unlinked: set[str]) -> set[str]:
    """The names whose objects a statement may link: all of them where it calls what is not known."""
    read = {node.value for node in run_in(statement) if isinstance(node, ast.Attribute)}
    match statement:
        case ast.Assign(targets=[ast.Attribute() as target], value=value) if _is_pointer(script, target):
            read.add(value)  # ``child.parent = cube``
        case _:
            pass
    found: set[str] = set()
    for node in run_in(statement):
        match node:
            case ast.Name(id=name) if node not in read:
                found.add(name)
            case ast.Call() if not is_harmless(script, node) or _links_unknown(script, node):
                return unlinked
            case _:
                pass
    return found


def _is_pointer(script: Script, target: ast.Attribute) -> bool:
    symbol = script.api.symbols.symbol(member_path(script, target))
    return symbol is not None and symbol.type == "pointer"


def _links_unknown(script: Script, call: ast.Call) -> bool:
    """Whether a call links something that may be any object: not one that a name holds which calls alone have given."""
    match call:
        case ast.Call(func=ast.Attribute(attr="link"), args=[ast.Name(id=name)], keywords=[]):
            return not all(isinstance(value, ast.Call) for value in bindings(script).get(name, [None]))
        case ast.Call(func=ast.Attribute(attr="link")):
            return True
        case _:
            return False


RULE = Rule("unlinked-object", "error", "An object in no collection is selected or made active", _check)
