"""A picture that is rendered and written nowhere.

```python
scene.render.filepath = "/tmp/cube.png"
bpy.ops.render.render()  # reported: bpy.ops.render.render(write_still=True)
```

Not reported: scripts that write the result otherwise, or that compute names; and renders of animations, which write
their frames.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import member_path
from kb_check.calls.sites import calls, giving
from kb_check.findings import Finding, Fix
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names
from kb_check.syntax.words import attributes, named_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_RENDER, _WRITES = f"{OPERATORS}render.render", "write_still"
_FILEPATH = f"{T}RenderSettings.filepath"
# Words of scripts that write, or read, what was rendered in another way.
_OTHERWISE = frozenset(
    {_WRITES, "save_render", "save_as", "pixels", "Result", "Viewer", "CompositorNodeOutputFile", "handlers"}
)


def _check(script: Script) -> Iterator[Finding]:
    if computes_names(script) or not _OTHERWISE.isdisjoint(named_words(script)):
        return
    if not any(
        isinstance(node.ctx, ast.Store) and member_path(script, node) == _FILEPATH
        for node in attributes(script).get("filepath", ())
    ):
        return
    for call in calls(script):
        if call.callee.symbol.path != _RENDER or call.has_unpacking or call.node.args:
            continue
        if call.given <= {"scene", "layer", "use_viewport"}:
            edit = giving(script, call.node, f"{_WRITES}=True")
            yield Finding(
                RULE.id, "warning", script.span(call.node),
                f"`{_RENDER}()` writes no file: `render.filepath` is used only with `{_WRITES}=True`.", _RENDER, (),
                Fix(f"Write {_WRITES}=True", (edit,)) if edit else None,
            )  # fmt: skip


RULE = Rule("unsaved-render", "warning", "A picture that is rendered and written nowhere", _check)
