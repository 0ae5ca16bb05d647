"""An attribute that a list does not have.

Read from the list that a call returns, and meant for its items, or from a list of handlers, which has Python's methods.

```python
obj.driver_add("location").driver  # reported: a list of three curves, for there is no index
obj.driver_add("location", 0).driver
bpy.app.handlers.load_post.add(follow)  # reported: append
```
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.types import Instance, Sequence
from kb_check.findings import Finding
from kb_check.handler_lists import handler_list
from kb_check.made_here import bindings, callee_path
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_ADDING = "bpy.types.bpy_struct.driver_add"


def _check(script: Script) -> Iterator[Finding]:
    for node in script.all(ast.Attribute):
        if hasattr(list, node.attr):
            continue
        if name := handler_list(script, node.value):
            yield Finding(
                RULE.id, "error", script.name_span(node),
                f"`{name}` is a list, which has no `{node.attr}`: `append` adds a function, `remove` takes one out.",
                name,
            )  # fmt: skip
            continue
        kind = script.type_of(node.value)
        if (
            isinstance(kind, Sequence)
            and isinstance(kind.element, Instance)
            and _is_added(script, node.value)
        ):
            yield Finding(
                RULE.id, "error", script.name_span(node),
                "`driver_add` of a property with several values gives a list of curves, one for each: "
                "give an index, `driver_add(path, index)`, or take one of the list.", _ADDING,
            )  # fmt: skip


def _is_added(script: Script, node: ast.expr) -> bool:
    if isinstance(node, ast.Name):
        values = bindings(script).get(node.id, [])
        return len(values) == 1 and values[0] is not None and _is_added(script, values[0])
    return isinstance(node, ast.Call) and callee_path(script, node) == _ADDING


RULE = Rule("list-attribute", "error", "An attribute that a list does not have", _check)
