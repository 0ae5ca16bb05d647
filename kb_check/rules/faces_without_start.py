"""Faces that are added to a mesh and never told at which corner each begins.

```python
mesh.loops.add(8)
mesh.loops.foreach_set("vertex_index", corners)
mesh.polygons.add(2)  # reported: mesh.polygons.foreach_set("loop_start", [0, 4]) is missing
mesh.polygons.foreach_set("loop_total", [4, 4])
```

A face has the corners from its `loop_start` to that of the next one. Without it, one face gets all of them and the
others none; older Blenders leave there what was in memory, and end when the mesh is read.

Not reported: a single face (``polygons.add(1)``), and scripts that compute names or call other files.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.sites import calls
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.out_of_sight import knows_all
from kb_check.syntax.words import named_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_ADD = f"{T}MeshPolygons.add"
_START = "loop_start"


def _check(script: Script) -> Iterator[Finding]:
    if not knows_all(script) or _START in named_words(script):
        return
    for call in calls(script):
        match call.argument("count"):
            case None | ast.Constant(value=1):
                pass
            case _ if call.callee.symbol.path == _ADD:
                yield Finding(
                    RULE.id, "warning", script.span(call.node),
                    "The new faces have no corners of their own: nothing in this script sets their `loop_start`. "
                    '`polygons.foreach_set("loop_start", …)` does, with the number of each one\'s first corner.',
                    f"{T}MeshPolygon.{_START}",
                )  # fmt: skip
            case _:
                pass


RULE = Rule("faces-without-start", "warning", "New faces that no corners belong to", _check)
