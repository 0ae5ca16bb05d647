"""Results that are unpacked into another number of names.

```python
hit, location, normal = ob.ray_cast(origin, direction)  # reported: there is `index` too
hit, location, normal, index = scene.ray_cast(depsgraph, origin, direction)  # reported: six
hit, *rest = ob.ray_cast(origin, direction)
hit, location, normal, _ = ob.ray_cast(origin, direction)
```

Not reported: a name that was given the results before, and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.types import NONE, UNKNOWN, Tuple, members
from kb_check.calls import calls
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.calls import CallSite
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    targets = {
        node.value: node.targets for node in script.all(ast.Assign) if isinstance(node.value, ast.Call)
    }
    for call in calls(script) if targets else ():
        for target in targets.get(call.node, ()):
            if isinstance(target, (ast.Tuple, ast.List)) and (told := _told(script, call, target)):
                yield Finding(RULE.id, "error", script.span(target), told, call.callee.symbol.path)


def _told(script: Script, call: CallSite, target: ast.Tuple | ast.List) -> str:
    """What is wrong with unpacking the results of a call so; empty if nothing surely is."""
    symbol = call.callee.symbol
    kinds = [kind for kind in members(script.type_of(call.node) or UNKNOWN) if kind != NONE]
    counts = {len(kind.items) if isinstance(kind, Tuple) else None for kind in kinds}
    given = counts.pop() if len(counts) == 1 else None
    if given is None or is_tried(script, call.node):
        return ""
    wanted = len(target.elts)
    starred = sum(isinstance(item, ast.Starred) for item in target.elts)
    if given == wanted or (starred and given >= wanted - starred):
        return ""
    names = [result.name for result in symbol.returns]
    known = f": {', '.join(f'`{name}`' for name in names)}" if len(names) == given and all(names) else ""
    at_least = "at least " if starred else ""
    return f"`{symbol.path}` gives {given} values{known}. Here {at_least}{wanted - starred} are unpacked."


RULE = Rule("wrong-count", "error", "Results that are unpacked into another number of names", _check)
