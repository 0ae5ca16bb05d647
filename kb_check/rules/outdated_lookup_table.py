"""An element of a BMesh that is asked for by index, without the table that finds it.

A new BMesh has no such tables, and whatever adds or removes elements outdates them: an IndexError. Loops and slices
need none.

```python
bm = bmesh.new()
bm.from_mesh(mesh)
bm.verts[0].co.z = 1  # reported
bm.verts.ensure_lookup_table()
bm.verts[0].co.z = 1
```

Reported in scripts that make a BMesh and never call ``ensure_lookup_table``. Not reported: BMeshes of edit mode, whose
tables a tool may have left in order.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Instance, Plain
from kb_check.findings import Finding, Fix
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_FACES = "bmesh.types.BMFaceSeq"
_TABLES = frozenset({"bmesh.types.BMVertSeq", "bmesh.types.BMEdgeSeq", _FACES})
_MAKES = "bmesh.new"
_ENSURES = frozenset({"ensure_lookup_table", "from_edit_mesh"})
_ENSURES_FACES = "bmesh.ops.recalc_face_normals"  # of all functions of bmesh the only one, as tried


def _check(script: Script) -> Iterator[Finding]:
    called = {row.value for row in script.resolutions("call")}
    named = {node.attr for node in script.all(ast.Attribute)}
    if _MAKES not in called or named & _ENSURES:
        return
    for node in script.all(ast.Subscript):
        if isinstance(node.slice, ast.Slice):
            continue
        owner, key = script.type_of(node.value), script.type_of(node.slice)
        if not isinstance(owner, Instance) or owner.cls not in _TABLES or not owner.sure:
            continue
        row = script.analysis.resolutions.get(node.value)
        by_index = isinstance(key, Plain) and key.kind == "int"
        if not by_index or row is None or row.guarded or not row.sure:
            continue
        if owner.cls == _FACES and _ENSURES_FACES in called:
            continue
        text = script.text(script.span(node.value))
        yield Finding(
            RULE.id,
            "error",
            script.span(node),
            f"`{text}[...]` needs a table that is not made: call `{text}.ensure_lookup_table()` first, and again after "
            "elements were added or removed.",
            owner.cls,
            (f"{owner.cls}.ensure_lookup_table",),
            _fix(script, row.statement, text),
        )


def _fix(script: Script, statement: ast.stmt | None, text: str) -> Fix | None:
    """The call, in a line of its own before the statement."""
    if "\n" in text or "(" in text:
        return None
    edit = script.line_before(statement, f"{text}.ensure_lookup_table()")
    return Fix("Make the table", (edit,), sure=True) if edit else None


RULE = Rule("outdated-lookup-table", "error", "An element of a BMesh by index, without the table", _check)
