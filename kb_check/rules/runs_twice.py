"""What a script adds once more each time it runs.

In one session of Blender a script is often run several times: after an edit, or by an agent. A function that it adds to
a list of handlers or to a menu is then called once for each run.

```python
bpy.app.handlers.frame_change_pre.append(follow)  # reported at the top level of a script
bpy.types.VIEW3D_MT_add.append(draw)  # likewise
```

Not reported: what stands in a function, which an add-on calls when it is enabled, and scripts that also look into the
list (``in``), clear it or remove from it.
"""

from __future__ import annotations

import ast
from collections import Counter
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import HANDLERS
from kb_check.findings import Finding
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_ADDING = frozenset({"append", "prepend", "insert"})


def _check(script: Script) -> Iterator[Finding]:
    added = list(_added(script))
    if not added:
        return
    mentions = Counter(
        path for row in script.resolutions("attribute", "name") for path in row.symbols
        if path.startswith(HANDLERS) or script.api.is_class(path)
    )  # fmt: skip
    uses = Counter(path for _, path in added)
    for call, path in added:
        if mentions[path] > uses[path]:
            continue
        what = "is called once more per frame or event" if path.startswith(HANDLERS) else "is drawn once more"
        yield Finding(
            RULE.id, "note", script.span(call),
            f"Run again in the same Blender, this adds to `{path}` once more, and what it adds {what}: remove the "
            "former first.", path,
        )  # fmt: skip


def _added(script: Script) -> Iterator[tuple[ast.Call, str]]:
    """The calls at the top level that add to a list of functions, with what they add to."""
    for call in _top_level_calls(script.tree.body):
        function = call.func
        if not isinstance(function, ast.Attribute) or function.attr not in _ADDING:
            continue
        row = script.analysis.resolutions.get(function.value)
        if row is None or len(row.symbols) != 1 or row.guarded:
            continue
        path = row.symbols[0]
        if path.startswith(HANDLERS) or script.api.is_class(path):
            yield call, path


def _top_level_calls(body: list[ast.stmt]) -> Iterator[ast.Call]:
    """The calls that are statements of a module, or stand in its loops and ``with``."""
    for statement in body:
        if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
            yield statement.value
        elif isinstance(statement, (ast.For, ast.With)):
            yield from _top_level_calls(statement.body)


RULE = Rule("runs-twice", "note", "What a script adds once more each time it runs", _check)
