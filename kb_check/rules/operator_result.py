"""What an operator returns is used as if it were the object that it makes.

```python
cube = bpy.ops.mesh.primitive_cube_add()
cube.location = (0, 0, 1)  # reported: operators return a set, {'FINISHED'}
bpy.ops.mesh.primitive_cube_add()
cube = bpy.context.object
cube.location = (0, 0, 1)
```

Each name is reported once. Not reported: names that are bound again, and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import made_by
from kb_check.calls.sites import calls_by_node
from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.rule import Rule
from kb_check.running.raised import LACKS
from kb_check.running.tried import is_tried
from kb_check.syntax.bindings import assignments, once_bound
from kb_check.syntax.literals import times_bound

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_ACTIVE = "bpy.context.object"


def _check(script: Script) -> Iterator[Finding]:
    told: set[str] = set()
    for node in script.all(ast.Attribute):
        name = node.value.id if isinstance(node.value, ast.Name) else ""
        if name and (name in told or times_bound(script)[name] != 1):
            continue
        call = once_bound(script, node.value)
        site = calls_by_node(script).get(call) if isinstance(call, ast.Call) else None
        if site is None or site.callee.symbol.kind != "operator" or hasattr(set, node.attr):
            continue
        if is_tried(script, node, LACKS):
            continue
        if name:
            told.add(name)
        path = site.callee.symbol.path
        made = f" What it makes is `{_ACTIVE}` then." if made_by(path) else ""
        yield Finding(
            RULE.id, "error", script.name_span(node),
            f"`{path}` returns a set, {{'FINISHED'}}: there is no `{node.attr}`.{made}", path, (),
            _active_then(script, name, site.node) if made else None,
        )  # fmt: skip


def _active_then(script: Script, name: str, call: ast.Call) -> Fix | None:
    """The fix that gives a name the active object behind the operator that makes it."""
    statement = assignments(script).get(call)
    if statement is None or not name or len(statement.targets) > 1:
        return None
    whole, value = script.span(statement), script.span(call)
    indent = script.lines[whole.line - 1][: whole.column]
    if indent.strip() or script.lines[whole.end_line - 1][whole.end_column :].strip():
        return None
    bare = Edit(Span(whole.line, whole.column, value.line, value.column), "")
    return Fix(
        "Take the active object", (bare, Edit.behind(whole, f"\n{indent}{name} = {_ACTIVE}")), sure=True
    )


RULE = Rule(
    "operator-result", "error", "The set that an operator returns is used as the object that it makes", _check
)
