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

Blender refuses each, since no view layer has the object; ``hide_set(True)`` too. A new collection that a script fills,
and gives to nothing, is a warning: what is in it shows nowhere.

Not reported: objects that the
statements between may have linked: those that name the object, or its collection, otherwise than to read from it, or
that link what they find or call what is not known; and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import SET_ACTIVE
from kb_build.flow.values.types import Instance
from kb_build.symbols.api_names import OBJECT
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path, member_path
from kb_check.calls.sites import calls_by_node
from kb_check.findings import Finding
from kb_check.modes.edit_bones import bound_in, names_of_others, surely_run
from kb_check.modes.keeping import is_harmless, run_in
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names, knows_all
from kb_check.running.tried import is_tried
from kb_check.scene.made_here import OBJECTS_NEW
from kb_check.script import once_per_script
from kb_check.syntax.bindings import bindings
from kb_check.syntax.bodies import bodies
from kb_check.syntax.words import asked_names, attributes, named_words

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kb_check.script import Script

_COPY, _UNLINK = f"{T}ID.copy", f"{T}CollectionObjects.unlink"
_COLLECTIONS_NEW = f"{T}BlendDataCollections.new"
_MAKING = frozenset({OBJECTS_NEW, _COLLECTIONS_NEW, _COPY})
# What needs the object in the view layer when it is given True.
_REFUSED = frozenset({f"{OBJECT}.select_set", f"{OBJECT}.hide_set"})


# What a script names that makes use of a collection which no scene has.
_USING = frozenset({"libraries", "asset_mark", "use_fake_user", "collection_instance_add"})
# Name of an object → the names of the collections that have it, which no scene has.
_Unlinked = dict[str, set[str]]


def _check(script: Script) -> Iterator[Finding]:
    if computes_names(script):
        return
    told: set[str] = set()  # collections
    for body in bodies(script):
        unlinked: _Unlinked = {}
        collections: set[str] = set()
        for statement in body:
            if unlinked:
                yield from _refused(script, statement, unlinked, told)
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
            if name := _makes(script, statement, _is_object) or unlinking:
                unlinked[name] = set()
            elif name := _makes(script, statement, _is_collection):
                collections.add(name)
    yield from _never_linked(script, told)


def _never_linked(script: Script, told: set[str]) -> Iterator[Finding]:
    """New collections that get objects, of which a script does nothing else than to read from them."""
    made = [
        (name, node)
        for node in script.all(ast.Assign)
        if (name := _makes(script, node, _is_collection)) and not _is_given(script, name)
    ]
    if not made or not knows_all(script) or not _USING.isdisjoint(named_words(script)):
        return
    if not _made_from(script).issuperset(attributes(script).get("collections", ())):  # some are looked up
        return
    for name, node in made:
        objects = [held for held, places in _linked(script).items() if f"{name}.objects" in places]
        is_alone = objects and all(
            len(_linked(script)[held]) == 1 and _is_new(script, held) for held in objects
        )
        if is_alone and name not in told:
            yield Finding(
                RULE.id, "warning", script.span(node.value),
                f"`{name}` is linked to no scene, so what is linked to it shows nowhere: "
                f"`bpy.context.scene.collection.children.link({name})` does.",
                _COLLECTIONS_NEW,
            )  # fmt: skip


def _is_given(script: Script, name: str) -> bool:
    """Whether a name is bound more than once, or used for more than to read from it."""
    return name in asked_names(script) or len(bindings(script).get(name, ())) != 1


@once_per_script
def _linked(script: Script) -> dict[str, set[str]]:
    """Name → what it is linked to, as that is written."""
    found: dict[str, set[str]] = {}
    for node in script.all(ast.Call):
        match node:
            case ast.Call(func=ast.Attribute(value=place, attr="link"), args=[ast.Name(id=name)]):
                found.setdefault(name, set()).add(ast.unparse(place))
            case _:
                pass
    return found


def _is_new(script: Script, name: str) -> bool:
    """Whether a name holds nothing but what is made for it alone."""
    return all(_is_made(script, value) for value in bindings(script).get(name, [None]))


def _made_from(script: Script) -> set[ast.expr]:
    """The places that name ``bpy.data.collections`` to make one."""
    return {
        node.func.value
        for node in script.all(ast.Call)
        if isinstance(node.func, ast.Attribute) and _is_collection(script, node)
    }


def _makes(script: Script, statement: ast.stmt, is_making: Callable[[Script, ast.Call], bool]) -> str:
    """The name that a statement gives to what a call makes; empty for none that is the script's own."""
    match statement:
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call) if is_making(script, call):
            return name if name not in names_of_others(script) else ""
        case _:
            return ""


def _is_object(script: Script, call: ast.Call) -> bool:
    """Whether a call makes an object."""
    path, kind = callee_path(script, call), script.type_of(call)
    is_copy = path == _COPY and isinstance(kind, Instance) and kind.sure and kind.cls == OBJECT
    return path == OBJECTS_NEW or is_copy


def _is_collection(script: Script, call: ast.Call) -> bool:
    """Whether a call makes a collection."""
    return callee_path(script, call) == _COLLECTIONS_NEW


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


def _refused(script: Script, statement: ast.stmt, unlinked: _Unlinked, told: set[str]) -> Iterator[Finding]:
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
            told.update(having)
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
            return not _is_new(script, name)
        case ast.Call(func=ast.Attribute(attr="link")):
            return True
        case _:
            return False


def _is_made(script: Script, value: ast.expr | None) -> bool:
    return isinstance(value, ast.Call) and callee_path(script, value) in _MAKING


RULE = Rule("unlinked-object", "error", "An object in no collection is selected or made active", _check)
