"""A thing that is no collection, looped over, unpacked or counted.

One of Blender's structures holds collections, and is none itself: Python refuses it with a TypeError.

```python
for node in material.node_tree:  # reported: material.node_tree.nodes
    ...
len(mesh)  # reported
x, y, z = bpy.context.object  # reported
for key in ob.keys():
    ...
for value in ob.values:  # reported: a method, which is called
    ...
```

A warning where the thing is annotated so: either the annotation or the use is wrong. Not reported: classes of the
script that can be looped over, what the script asks for `__iter__`, and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, Function, Instance, members, without_none
from kb_build.symbols.api_names import STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import builtin_called
from kb_check.findings import Edit, Finding, Fix
from kb_check.registered.classes import own_classes
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.script import once_for_each, once_per_script
from kb_check.syntax.annotated import ONE_IS_WRONG, annotated

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Type
    from kb_check.script import Script

_ERRORS = ("TypeError",)
_ITERATES, _COUNTS = "__iter__", "__len__"
# What of Python's own loops over what it is given, and which of its arguments that is from on.
_LOOPING = {
    **dict.fromkeys(
        ("all", "any", "enumerate", "frozenset", "iter", "list", "reversed", "set", "sorted", "sum", "tuple"), 0
    ),
    "zip": 0, "filter": 1, "map": 1,
}  # fmt: skip
_ONE = frozenset({"enumerate", "reversed", "sorted", "sum"})  # whose other arguments are none to loop over
_ALONE = frozenset({"max", "min"})  # which loop over one argument, and compare several
# Not Blender's structures, and no collections either.
_OTHERS = frozenset(
    {
        "bmesh.types.BMEdge", "bmesh.types.BMFace", "bmesh.types.BMLoop", "bmesh.types.BMVert", "bmesh.types.BMesh",
        "mathutils.bvhtree.BVHTree", "mathutils.kdtree.KDTree",
    }
)  # fmt: skip


def _check(script: Script) -> Iterator[Finding]:
    for node, method, target in _asked(script):
        refused = _refused(script, node, method)
        if refused is None or is_tried(script, node, _ERRORS) or ast.unparse(node) in _asked_whether(script):
            continue
        if isinstance(refused, Function):
            edit = Edit.behind(script.span(node), "()")
            told = f"`{refused.path}` is a method, which gives nothing to loop over before it is called."
            yield Finding(
                RULE.id, "error", script.span(node), told, refused.path, (), Fix("Call it", (edit,))
            )
            continue
        said = annotated(script, node, refused.cls)
        does = "has no length" if method == _COUNTS else "cannot be looped over"
        told = f"`{refused.cls}` is no collection: it {does}.{_held(script, refused.cls, target)}"
        if said:
            told = f"{said}, which is no collection and {does}: {ONE_IS_WRONG}."
        yield Finding(RULE.id, "warning" if said else "error", script.span(node), told, refused.cls)


def _asked(script: Script) -> Iterator[tuple[ast.expr, str, ast.expr | None]]:
    """What is looped over or counted, the method that Python needs for it, and what each item is called."""
    for loop in script.all(ast.For, ast.comprehension):
        yield loop.iter, _ITERATES, loop.target
    for starred in script.all(ast.Starred):
        if isinstance(starred.ctx, ast.Load):
            yield starred.value, _ITERATES, None
    for assigned in script.all(ast.Assign):
        if any(isinstance(target, (ast.Tuple, ast.List)) for target in assigned.targets):
            yield assigned.value, _ITERATES, None
    for call in script.all(ast.Call):
        name = builtin_called(script, call)
        if name == "len" and len(call.args) == 1:
            yield call.args[0], _COUNTS, None
        elif name in _LOOPING or (name in _ALONE and len(call.args) == 1):
            given = call.args[_LOOPING.get(name, 0) :][: 1 if name in _ONE else None]
            yield from ((node, _ITERATES, None) for node in given if not isinstance(node, ast.Starred))


@once_per_script
def _asked_whether(script: Script) -> frozenset[str]:
    """What the script asks for the methods of collections, as it is written: it is ready for what has none."""
    return frozenset(
        ast.unparse(call.args[0])
        for call in script.all(ast.Call)
        if builtin_called(script, call) in {"hasattr", "getattr"} and len(call.args) > 1
        and isinstance(call.args[1], ast.Constant) and str(call.args[1].value).startswith("__")
    )  # fmt: skip


def _refused(script: Script, node: ast.expr, method: str) -> Instance | Function | None:
    """The type of a value that surely has no items; None for others."""
    kinds = members(without_none(script.type_of(node) or UNKNOWN))
    found = [kind for kind in kinds if _has_no_items(script, kind, method)]
    first = found[0] if len(found) == len(kinds) else None
    return first if isinstance(first, (Instance, Function)) else None


def _has_no_items(script: Script, kind: Type, method: str) -> bool:
    match kind:
        case Function():
            return True
        case Instance(cls=cls, sure=True):
            return cls in _OTHERS or (
                script.api.descends(cls, STRUCT) and not _has_items(script, (cls, method))
            )
        case _:
            return False


@once_for_each
def _has_items(script: Script, class_and_method: tuple[str, str]) -> bool:
    """Whether a class is that of a collection, or one of the script's below it can be looped over."""
    cls, method = class_and_method
    sql = "SELECT 1 FROM symbols WHERE collection = ? LIMIT 1"
    if script.names.reader.rows(sql, cls.removeprefix(T)):
        return True
    return any(not own.lacks(method) for own in own_classes(script) if script.api.descends(own.path, cls))


def _held(script: Script, cls: str, target: ast.expr | None) -> str:
    """A sentence about the collection of a class that items are called after: ``nodes`` of ``for node in tree``."""
    name = f"{target.id}s" if isinstance(target, ast.Name) else ""
    member = script.api.member(cls, name) if name else None
    return f" Its `{name}` can." if member and member.symbol.type == "collection" else ""


RULE = Rule(
    "not-iterable", "error", "A thing that is no collection, looped over, unpacked or counted", _check
)
