"""An operator's `bl_idname` that Blender refuses.

It is the operator's place below `bpy.ops`: lower-case letters, digits and underscores with one dot between, and no
more than 60 characters in all.

```python
class Grow(bpy.types.Operator):
    bl_idname = "OBJECT_OT_grow"  # reported: "object.grow"
```
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.findings import Finding, Fix
from kb_check.registered.classes import own_classes
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_OPERATORS = frozenset({f"{T}Operator", f"{T}Macro"})
_TAKEN = re.compile(r"[a-z0-9_]+\.[a-z0-9_]+")
_LONGEST = 60
_HUMP = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")
_OTHER = re.compile(r"[^a-z0-9_]+")


def _check(script: Script) -> Iterator[Finding]:
    seen: set[ast.expr] = set()
    for own in own_classes(script):
        if own.path not in _OPERATORS or not own.is_final:
            continue
        node = own.value("bl_idname")
        if not isinstance(node, ast.Constant) or not isinstance(node.value, str) or node in seen:
            continue
        seen.add(node)
        if not node.value and not own.is_registered:
            continue  # it may be there to be derived from
        if not _TAKEN.fullmatch(node.value) or len(node.value) > _LONGEST:
            yield _finding(script, node, node.value, own.path)


def _finding(script: Script, node: ast.Constant, name: str, path: str) -> Finding:
    better = _better(name)
    instead = f" Write '{better}'." if better else ""
    edit = script.renamed(node, better) if better else None
    return Finding(
        RULE.id, "error", script.span(node),
        f"{name!r} is not an operator's name: Blender registers one with lower-case letters, digits and underscores, "
        f"one dot between, {_LONGEST} characters at most.{instead}",
        f"{path}.bl_idname", (), Fix(f"Write {better}", (edit,)) if edit else None,
    )  # fmt: skip


def _better(name: str) -> str:
    """A name that is taken, and near to the one that is refused; empty for none."""
    module, dot, rest = name.replace("_OT_", ".").partition(".")
    if not dot:
        module, rest = "object", module
    parts = [_OTHER.sub("_", _HUMP.sub("_", part).lower()).strip("_") for part in (module, rest)]
    better = ".".join(parts)
    return better if _TAKEN.fullmatch(better) and len(better) <= _LONGEST else ""


RULE = Rule("operator-idname", "error", "An operator's name that Blender refuses", _check)
