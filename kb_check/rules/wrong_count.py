"""Results that are unpacked into another number of names.

```python
hit, location, normal = ob.ray_cast(origin, direction)  # reported: there is `index` too
hit, location, normal, index = scene.ray_cast(depsgraph, origin, direction)  # reported: six
default, loaded = addon_utils.enable(name)  # reported: one module
hit, *rest = ob.ray_cast(origin, direction)
hit, location, normal, _ = ob.ray_cast(origin, direction)
```

Not reported: a name that was given the results before, and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import NONE, UNKNOWN, Plain, Tuple, members
from kb_check.calls.sites import calls
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.values.misfits import describe

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Type
    from kb_build.symbols.records import Symbol
    from kb_check.calls.sites import CallSite
    from kb_check.script import Script


_NUMBERS = frozenset({"bool", "float", "int"})
_MODULE = "ModuleType"


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
    if (one := _one(symbol, kinds)) and not is_tried(script, call.node):
        return f"`{symbol.path}` gives {one}, which cannot be unpacked."
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


def _one(symbol: Symbol, kinds: list[Type]) -> str:
    """What a call gives that holds no others, in words; empty where it may."""
    if [result.type for result in symbol.returns] == [_MODULE]:
        return "a module"
    told = {describe(kind) if isinstance(kind, Plain) and kind.kind in _NUMBERS else "" for kind in kinds}
    return told.pop() if len(told) == 1 else ""


RULE = Rule("wrong-count", "error", "Results that are unpacked into another number of names", _check)
