"""An object that is linked to a collection which has it already: Blender refuses it.

```python
bpy.ops.mesh.primitive_cube_add()
cube = bpy.context.object
bpy.context.collection.objects.link(cube)  # reported: the operator has linked it
ball = bpy.data.objects.new("Ball", mesh)
props.objects.link(ball)
props.objects.link(ball)  # reported
```

Not reported: what follows statements that may unlink objects, scripts that make another collection the active one, and
what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path
from kb_check.findings import Finding
from kb_check.modes.edit_bones import bound_in, names_of_others
from kb_check.modes.keeping import is_harmless
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names
from kb_check.running.tried import is_tried
from kb_check.scene.active_object import making_operator, reads_active
from kb_check.syntax.bindings import alias
from kb_check.syntax.bodies import bodies
from kb_check.syntax.words import attributes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_LINK = f"{T}CollectionObjects.link"
_ACTIVE = "bpy.context.collection"
_SAME = frozenset(
    {_ACTIVE, "context.collection", "bpy.context.view_layer.active_layer_collection.collection"}
)
_UNLINKING = "unlink"
# What leads to another active collection where it is assigned.
_LEADING = ("active_layer_collection", "scene", "view_layer")

# (name of an object, collection as it is written) → what has linked it.
_Links = dict[tuple[str, str], str]


def _check(script: Script) -> Iterator[Finding]:
    if computes_names(script) or any(
        isinstance(node.ctx, ast.Store) for name in _LEADING for node in attributes(script).get(name, ())
    ):
        return
    for body in bodies(script):
        linked: _Links = {}
        maker = ""
        for statement in body:
            if (link := _link(script, statement)) and not is_tried(script, link[0]):
                call, name, collection = link
                if by := linked.get((name, collection)):
                    yield Finding(
                        RULE.id, "error", script.span(call),
                        f"`{name}` is in `{collection}` already: {by} has linked it, and Blender refuses to do so "
                        "again. Leave this out.",
                        _LINK,
                    )  # fmt: skip
                linked[name, collection] = f"line {statement.lineno}"
                continue
            made, name = making_operator(script, statement), _active(script, statement)
            linked = {} if not made and _may_unlink(script, statement) else _kept(statement, linked)
            if maker and name and name not in names_of_others(script):
                linked[name, _ACTIVE] = f"`{maker}`"
            maker = made or (maker if name else "")


def _link(script: Script, statement: ast.stmt) -> tuple[ast.Call, str, str] | None:
    """The call of a statement that links an object, with the name of the object and the collection."""
    match statement:
        case ast.Expr(
            value=ast.Call(
                func=ast.Attribute(value=ast.Attribute(value=collection, attr="objects"), attr="link"),
                args=[ast.Name(id=name)],
            ) as call
        ) if callee_path(script, call) == _LINK:
            text = ast.unparse(alias(script, collection))
            return call, name, _ACTIVE if text in _SAME else text
        case _:
            return None


def _active(script: Script, statement: ast.stmt) -> str:
    """The name that a statement gives the active object; empty for others."""
    match statement:
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Attribute() as value) if reads_active(
            script, value
        ):
            return name
        case _:
            return ""


def _may_unlink(script: Script, statement: ast.stmt) -> bool:
    return any(
        (isinstance(node, ast.Attribute) and node.attr == _UNLINKING)
        or (isinstance(node, ast.Call) and not is_harmless(script, node))
        for node in walk(statement)
    )


def _kept(statement: ast.stmt, linked: _Links) -> _Links:
    """The links that a statement leaves as they are: it binds no name of theirs."""
    if not linked:
        return linked
    bound = set(bound_in(statement))
    return {
        (name, collection): by
        for (name, collection), by in linked.items()
        if name not in bound and collection.partition(".")[0] not in bound
    }


RULE = Rule("linked-twice", "error", "An object that its collection has already is linked again", _check)
