"""What a script adds once more each time it runs.

In one session of Blender a script is often run several times: after an edit, or by an agent. A function that it adds to
a list of handlers or to a menu is then called once for each run.

```python
bpy.app.handlers.frame_change_pre.append(follow)  # reported at the top level of a script
bpy.types.VIEW3D_MT_add.append(draw)  # likewise
if follow not in bpy.app.handlers.frame_change_pre:  # always true: each run makes another ``follow``
    bpy.app.handlers.frame_change_pre.append(follow)  # reported
```

Not reported: what stands in a function, which an add-on calls when it is enabled, and scripts that look into the list
in another way, clear it or remove from it.
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
    guards = _vain_guards(script.tree)
    uses.update(path for guard in guards if (path := _added_to(script, guard.comparators[0])))
    for call, path in added:
        if mentions[path] > uses[path]:
            continue
        what = "is called once more per frame or event" if path.startswith(HANDLERS) else "is drawn once more"
        guard = next((guard for guard in guards if _added_to(script, guard.comparators[0]) == path), None)
        vain = (
            f" `{script.text(script.span(guard))}` is true each time, as each run makes another function."
            if guard
            else ""
        )
        yield Finding(
            RULE.id, "note", script.span(call),
            f"Run again in the same Blender, this adds to `{path}` once more, and what it adds {what}: remove the "
            f"former first.{vain}", path,
        )  # fmt: skip


def _added(script: Script) -> Iterator[tuple[ast.Call, str]]:
    """The calls at the top level that add to a list of functions, with what they add to."""
    for call in _top_level_calls(script.tree, script.tree.body):
        function = call.func
        if isinstance(function, ast.Attribute) and function.attr in _ADDING:
            path = _added_to(script, function.value)
            if path:
                yield call, path


def _added_to(script: Script, node: ast.expr) -> str:
    """The list of handlers, or the class with a menu, that an expression surely is; empty for none."""
    row = script.analysis.resolutions.get(node)
    if row is None or len(row.symbols) != 1 or row.guarded:
        return ""
    path = row.symbols[0]
    return path if path.startswith(HANDLERS) or script.api.is_class(path) else ""


def _top_level_calls(tree: ast.Module, body: list[ast.stmt]) -> Iterator[ast.Call]:
    """The calls that are statements of a module, or stand in its loops, ``with`` and behind guards in vain."""
    for statement in body:
        if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
            yield statement.value
        elif isinstance(statement, (ast.For, ast.With)) or (
            isinstance(statement, ast.If) and _is_vain(tree, statement.test)
        ):
            yield from _top_level_calls(tree, statement.body)


def _vain_guards(tree: ast.Module) -> list[ast.Compare]:
    return [
        node.test
        for node in tree.body
        if isinstance(node, ast.If) and isinstance(node.test, ast.Compare) and _is_vain(tree, node.test)
    ]


def _is_vain(tree: ast.Module, test: ast.expr) -> bool:
    """Whether a function of the script itself is asked for: what an earlier run has added is another one."""
    return (
        isinstance(test, ast.Compare)
        and isinstance(test.left, ast.Name)
        and [type(operator) for operator in test.ops] == [ast.NotIn]
        and any(isinstance(one, ast.FunctionDef) and one.name == test.left.id for one in tree.body)
    )


RULE = Rule("runs-twice", "note", "What a script adds once more each time it runs", _check)
