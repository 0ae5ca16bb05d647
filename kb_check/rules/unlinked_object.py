"""An object that is selected, hidden or made active while it is in no collection of the scene.

```python
cube = bpy.data.objects.new("Cube", mesh)
cube.select_set(True)  # reported: bpy.context.collection.objects.link(cube) comes before
bpy.context.view_layer.objects.active = cube  # so it does for this
props = bpy.data.collections.new("Props")
props.objects.link(cube)
cube.select_set(True)  # reported: bpy.context.scene.collection.children.link(props) comes before
for collection in ball.users_collection:
    collection.objects.unlink(ball)
ball.select_set(True)  # reported: it is in no collection any more
```

Blender refuses each, since no view layer has the object; ``hide_set(True)`` too. Not reported: objects that the
statements between may have linked: those that name the object, or its collection, otherwise than to read from it, or
that link what they find or call what is not known; and what stands in a ``try``.
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

_COPY, _UNLINK = f"{T}ID.copy", f"{T}CollectionObjects.unlink"
_COLLECTIONS_NEW = f"{T}BlendDataCollections.new"
_MAKING = frozenset({OBJECTS_NEW, _COLLECTIONS_NEW, _COPY})
# What needs the object in the view layer when it is given True.
_REFUSED = frozenset({f"{OBJECT}.select_set", f"{OBJECT}.hide_set"})


# Name of an object → the names of the collections that have it, which no scene has.
_Unlinked = dict[str, set[str]]


def _check(script: Script) -> Iterator[Finding]:
    if computes_names(script):
        return
    for body in bodies(script):
        unlinked: _Unlinked = {}
        collections: set[str] = set()
        for statement in body:
            if unlinked:
                yield from _refused(script, statement, unlinked)
            if (link := _link(statement)) and link[0] in collections and link[1] in unlinked:
                unlinked[link[1]].add(link[0])
                continue
            unlinking = _unlinks(script, statement)
            if unlinked or collections:
                known = set[str]() if unlinking else {*unlinked, *collections}
                taken = _taken(script, statement, known) | set(bound_in(statement))
                collections -= taken
                unlinked = {
                    name: having
                    for name, having in unlinked.items()
                    if name not in taken and having.isdisjoint(taken)
                }
            if name := _makes(script, statement) or unlinking:
                unlinked[name] = set()
            elif name := _makes_collection(script, statement):
                collections.add(name)


def _makes(script: Script, statement: ast.stmt) -> str:
    """The name of the new object that a statement makes; empty for none."""
    match statement:
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call):
            path, kind = callee_path(script, call), script.type_of(call)
            is_copy = path == _COPY and isinstance(kind, Instance) and kind.sure and kind.cls == OBJECT
            return name if (path == OBJECTS_NEW or is_copy) and name not in names_of_others(script) else ""
        case _:
            return ""


def _makes_collection(script: Script, statement: ast.stmt) -> str:
    """The name of the new collection that a statement makes; empty for none."""
    match statement:
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call):
            is_new = callee_path(script, call) == _COLLECTIONS_NEW
            return name if is_new and name not in names_of_others(script) else ""
        case _:
            return ""


def _unlinks(script: Script, statement: ast.stmt) -> str:
    """The name of the object that a loop takes out of all its collections; empty for none."""
    match statement:
        case ast.For(
            target=ast.Name(id=collection),
            iter=ast.Attribute(value=ast.Name(id=name), attr="users_collection")
            | ast.Call(
                func=ast.Name(id="list" | "tuple"),
                args=[ast.Attribute(value=ast.Name(id=name), attr="users_collection")],
            ),
            body=[
                ast.Expr(
                    value=ast.Call(
                        func=ast.Attribute(value=ast.Attribute(value=ast.Name(id=unlinked))),
                        args=[ast.Name(id=given)],
                    ) as call
                )
            ],
        ) if (unlinked, given) == (collection, name) and callee_path(script, call) == _UNLINK:
            return name if name not in names_of_others(script) else ""
        case _:
            return ""


def _link(statement: ast.stmt) -> tuple[str, str] | None:
    """The collection and the object, by their names, that a statement links."""
    match statement:
        case ast.Expr(
            value=ast.Call(
                func=ast.Attribute(
                    value=ast.Attribute(value=ast.Name(id=collection), attr="objects"), attr="link"
                ),
                args=[ast.Name(id=name)],
            )
        ):
            return collection, name
        case _:
            return None


def _refused(script: Script, statement: ast.stmt, unlinked: _Unlinked) -> Iterator[Finding]:
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
            having = sorted(unlinked.pop(name))  # once is enough
            where = f"only in `{having[0]}`, which no scene has" if having else "in no collection"
            linking = (
                f"`bpy.context.scene.collection.children.link({having[0]})`"
                if having
                else f"`bpy.context.collection.objects.link({name})`"
            )
            yield Finding(
                RULE.id, "error", script.span(place),
                f"`{name}` is {where}, so no view layer has it, and Blender refuses `{what}`: {linking} comes before.",
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
    """Whether a call links something that may be any object: not one that a name holds which is made for it alone."""
    match call:
        case ast.Call(func=ast.Attribute(attr="link"), args=[ast.Name(id=name)], keywords=[]):
            return not all(_is_made(script, value) for value in bindings(script).get(name, [None]))
        case ast.Call(func=ast.Attribute(attr="link")):
            return True
        case _:
            return False


def _is_made(script: Script, value: ast.expr | None) -> bool:
    return isinstance(value, ast.Call) and callee_path(script, value) in _MAKING


RULE = Rule("unlinked-object", "error", "An object in no collection is selected or made active", _check)
