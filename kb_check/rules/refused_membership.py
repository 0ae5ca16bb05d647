"""A test whether a thing is in a collection of Blender's: ``in`` takes names there, and nothing else.

```python
if material in bpy.data.materials:  # reported: TypeError
    ...
if material in bpy.data.materials.values():  # asks for this very material
    ...
if material.name in bpy.data.materials:  # asks for one of that name
    ...
```

Lists are no such collections: ``obj in context.selected_objects`` is right, and so is a vertex ``in bm.verts``. Not
reported: what may be a text, and what stands in a ``try`` that catches the TypeError.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Collection, Instance, NoneValue, Plain, members
from kb_build.symbols.api_names import COLLECTION
from kb_check.findings import Edit, Finding, Fix
from kb_check.rule import Rule
from kb_check.running.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Type
    from kb_check.script import Script

_ERROR = ("TypeError",)
_SHOWN = (ast.Name, ast.Attribute, ast.Subscript)
_CALLED = (*_SHOWN, ast.Call)  # what `.values()` can be written behind as it stands
_NAME = "name"


def _check(script: Script) -> Iterator[Finding]:
    for node in script.all(ast.Compare):
        match node:
            case ast.Compare(left=thing, ops=[ast.In() | ast.NotIn()], comparators=[collection]) if (
                isinstance(script.type_of(collection), Collection)
            ):
                kind = script.type_of(thing)
            case _:
                continue
        if kind is not None and all(map(_is_no_name, members(kind))) and not is_tried(script, node, _ERROR):
            yield _finding(script, thing, collection)


def _is_no_name(kind: Type) -> bool:
    match kind:
        case Instance(sure=sure):
            return sure
        case Plain(kind=plain):
            return plain in {"bool", "float", "int"}
        case _:
            return isinstance(kind, NoneValue)


def _finding(script: Script, thing: ast.expr, collection: ast.expr) -> Finding:
    told = "A collection of Blender's is asked for names, by texts: TypeError for anything else."
    if not isinstance(collection, _CALLED):
        return Finding(RULE.id, "error", script.span(thing), told, COLLECTION)
    cls = script.class_of(thing)
    behind = Edit.behind(script.span(collection), ".values()")
    fix = Fix("Ask for the thing", (behind,), sure=True) if cls else None
    if cls and isinstance(thing, _SHOWN):
        shown, items = ast.unparse(thing), ast.unparse(collection)
        by_name = (
            f", `{shown}.{_NAME} in {items}` for one of its name" if script.api.member(cls, _NAME) else ""
        )
        told += f" Write `{shown} in {items}.values()` for this very one{by_name}."
    return Finding(RULE.id, "error", script.span(thing), told, COLLECTION, fix=fix)


RULE = Rule("refused-membership", "error", "A thing that a collection is asked for as if by its name", _check)
