"""Something that is used after it was removed.

```python
bpy.data.objects.remove(ob)
print(ob.name)  # reported: keep the name before
bpy.ops.object.join()  # the active object takes in the other selected ones
other.name  # reported
bm.free()
bm.verts.ensure_lookup_table()  # reported
bm = bmesh.from_edit_mesh(mesh)
bpy.ops.object.mode_set(mode="OBJECT")
bm.verts  # reported: it goes with Edit Mode
vert = bm.verts[0]
layer = bm.verts.layers.float.new("weight")
vert[layer] = 1  # reported: a layer is made before elements are taken
instances = list(depsgraph.object_instances)
instances[0].object  # reported: [i.object.original for i in depsgraph.object_instances]
```

Blender refuses it with a ReferenceError (“StructRNA of type Object has been removed”); of parts that go with their
collection (`nodes.clear()`), it may read what has taken their place, or end. The items of `object_instances` are gone
as soon as the loop goes on.

Not reported: what is removed in a condition, a loop or a function and used behind it; names that are bound again; what
a list or an attribute holds; and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from collections import Counter
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Instance, Sequence, Tuple, Type
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import called_operators, member_path
from kb_check.calls.sites import calls_by_node
from kb_check.findings import Finding
from kb_check.modes.edit_bones import surely_run
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names
from kb_check.running.tried import is_tried
from kb_check.scene.held_objects import JOIN, HeldObjects
from kb_check.scene.removed import NEW_LAYER, Removal, Removed, may_remove
from kb_check.script import once_per_script
from kb_check.syntax.bodies import bodies
from kb_check.syntax.literals import times_bound

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_PASSING = f"{T}DepsgraphObjectInstance"
_OPERATORS = "bmesh.ops."
# What may be asked of a part of a BMesh, and of itself, that is gone.
_KEPT = frozenset({"is_valid", "free"})
_LISTS = frozenset({"list", "tuple", "set"})


def _check(script: Script) -> Iterator[Finding]:
    yield from _passed(script)
    joins = JOIN in called_operators(script)
    if computes_names(script) or not (joins or may_remove(script)):
        return
    for body in bodies(script):
        removed, objects = Removed(script), HeldObjects(script)
        for statement in body:
            if removed.gone:
                yield from _used(script, statement, removed)
            removed.pass_by(statement)
            if joins:
                objects.pass_by(statement)
            for held in objects.joined:
                removed.lose(objects.names(held), Removal(JOIN, statement.lineno))


def _used(script: Script, statement: ast.stmt, removed: Removed) -> Iterator[Finding]:
    for node in (statement, *surely_run(statement)):
        for name in _names_used(script, node):
            removal = removed.gone.get(name.id)
            if removal is None or (_is_kept(node) and not removal.path.startswith(T)):
                continue
            if not is_tried(script, name):
                del removed.gone[name.id]  # once is enough
                yield Finding(
                    RULE.id,
                    "error",
                    script.span(name),
                    f"`{name.id}` is gone: {_told(removal)}",
                    removal.path,
                )


def _told(removal: Removal) -> str:
    if removal.path == NEW_LAYER:
        return f"the layer that is made in line {removal.line} lays such elements anew. Make it before one is taken."
    return f"`{removal.path}` removed it in line {removal.line}. Take what is needed of it before."


def _names_used(script: Script, node: ast.AST) -> Iterator[ast.Name]:
    """The names whose things a part of a statement needs: by a member, an item, or as what a function is given."""
    match node:
        case ast.Attribute(value=ast.Name() as name) | ast.Subscript(value=ast.Name() as name):
            yield name
        case ast.Call():
            site = calls_by_node(script).get(node)
            if site is not None and (site.callee.is_rna or site.callee.symbol.path.startswith(_OPERATORS)):
                yield from (given for _, given in site.arguments() if isinstance(given, ast.Name))
        case ast.Assign(targets=[ast.Attribute() as target], value=ast.Name() as name):
            symbol = script.api.symbols.symbol(member_path(script, target))
            if symbol is not None and symbol.type == "pointer":
                yield name
        case _:
            pass


def _is_kept(node: ast.AST) -> bool:
    return isinstance(node, ast.Attribute) and node.attr in _KEPT


def _passed(script: Script) -> Iterator[Finding]:
    """What is asked of an instance that a list has kept."""
    reported: set[str] = set()
    for node in script.all(ast.Attribute):
        held = node.value
        is_passed = (
            _holds_passing(script.type_of(held.value))
            if isinstance(held, ast.Subscript) and not isinstance(held.slice, ast.Slice)
            else isinstance(held, ast.Name)
            and held.id in _looped(script)
            and _is_passing(script.type_of(held))
        )
        if is_passed and ast.unparse(held) not in reported and not is_tried(script, node):
            reported.add(ast.unparse(held))
            yield Finding(
                RULE.id, "error", script.span(node),
                "An item of `object_instances` is gone when the loop over them goes on, also if a list keeps it: take "
                "what is needed inside that loop, as `instance.object.original` or `instance.matrix_world.copy()`.",
                f"{T}Depsgraph.object_instances",
            )  # fmt: skip


@once_per_script
def _looped(script: Script) -> frozenset[str]:
    """The names that are bound by nothing but loops over lists of such instances."""
    loops = Counter(
        loop.target.id
        for loop in script.all(ast.For, ast.comprehension)
        if isinstance(loop.target, ast.Name) and _holds_passing(script.type_of(loop.iter))
    )
    return frozenset(name for name, count in loops.items() if times_bound(script)[name] == count)


def _holds_passing(kind: Type | None) -> bool:
    match kind:
        case Sequence(kind=held, element=element):
            return held in _LISTS and _is_passing(element)
        case Tuple(items=[first, *_]):
            return _is_passing(first)
        case _:
            return False


def _is_passing(kind: Type | None) -> bool:
    return isinstance(kind, Instance) and kind.sure and kind.cls == _PASSING


RULE = Rule("removed-data", "error", "Something that is used after it was removed", _check)
