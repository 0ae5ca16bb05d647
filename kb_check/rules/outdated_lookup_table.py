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

Reported in scripts that make a BMesh and never call ``ensure_lookup_table`` of such a sequence: each has a table of its
own. Not reported: BMeshes of edit mode, whose tables a tool may have left in order.
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
_MAKES = "bmesh.new"
_OF_EDIT_MODE, _ENSURES = "from_edit_mesh", "ensure_lookup_table"
_SEQUENCES = {
    "verts": "bmesh.types.BMVertSeq", "edges": "bmesh.types.BMEdgeSeq", "faces": _FACES,
}  # fmt: skip
_ENSURES_FACES = "bmesh.ops.recalc_face_normals"  # of all functions of bmesh the only one, as tried


def _check(script: Script) -> Iterator[Finding]:
    called = {row.value for row in script.resolutions("call")}
    named = {node.attr for node in script.all(ast.Attribute)}
    missing = frozenset(_SEQUENCES.values()) - _with_tables(script)
    if _MAKES not in called or _OF_EDIT_MODE in named or not missing:
        return
    for node in script.all(ast.Subscript):
        if isinstance(node.slice, ast.Slice):
            continue
        owner, key = script.type_of(node.value), script.type_of(node.slice)
        if not isinstance(owner, Instance) or owner.cls not in missing or not owner.sure:
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


def _with_tables(script: Script) -> frozenset[str]:
    """The classes of the sequences whose tables the script makes, whenever; all where it does not show which."""
    found: set[str] = set()
    for node in script.all(ast.Attribute):
        if node.attr == _ENSURES:
            name = node.value.attr if isinstance(node.value, ast.Attribute) else ""
            found.update([_SEQUENCES[name]] if name in _SEQUENCES else _SEQUENCES.values())
    return frozenset(found)


def _fix(script: Script, statement: ast.stmt | None, text: str) -> Fix | None:
    """The call, in a line of its own before the statement."""
    if "\n" in text or "(" in text:
        return None
    edit = script.line_before(statement, f"{text}.ensure_lookup_table()")
    return Fix("Make the table", (edit,), sure=True) if edit else None


RULE = Rule("outdated-lookup-table", "error", "An element of a BMesh by index, without the table", _check)
