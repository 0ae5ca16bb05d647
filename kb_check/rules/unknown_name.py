"""A class or function that a module of Blender's does not have.

Modules are those that Blender brings: ``bpy`` and what is below it, ``mathutils``, ``bmesh``, ``gpu``, ``bpy_extras``
and so on, and those that the Python which it brings has lost (``imp``); an import counts as well as a use. Operators
have a rule of their own.

```python
bpy.data.groups["Trees"]  # reported: collections since 2.80
from bpy_extras.io_utils import orientation_helper_factory
import bpy

bpy.utils.previews.new()  # reported, as a warning: `import bpy.utils.previews` makes it an attribute
```
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import LOST_MODULES, UNLOADED
from kb_check.calls.resolved import member_path
from kb_check.findings import Finding
from kb_check.names.lacking import lacking_finding
from kb_check.rule import Rule
from kb_check.running.out_of_sight import knows_all
from kb_check.running.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Resolution
    from kb_check.names.known import Lacking
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("attribute", "store", "name"):
        owner = row.missing[0]
        if owner.startswith("bpy.ops") or (row.kind != "name" and script.api.is_class(owner)):
            continue
        if not owner and (lost := LOST_MODULES.get(row.value)):
            yield _of_python(script, row, lost)
            continue
        symbol = script.api.symbols.symbol(owner)
        if symbol is None or symbol.kind == "module" or row.kind == "name":
            lacking = script.names.member(owner, row.value)
            yield lacking_finding(script, RULE.id, row, _of_lost_class(script, row, lacking) or lacking)
    yield from _unloaded(script)


def _of_python(script: Script, row: Resolution, lost: tuple[tuple[int, ...], str, str]) -> Finding:
    """A module that Python has lost by the version of it that this Blender brings."""
    since, python, instead = lost
    minor = ".".join(map(str, since))
    return Finding(
        RULE.id, "error", script.name_span(row.node),
        f"`{row.value}` went in Python {python}: Blender has brought a Python without it since {minor}."
        + (f" Use `{instead}`." if instead else ""),
        row.value,
    )  # fmt: skip


def _of_lost_class(script: Script, row: Resolution, lacking: Lacking) -> Lacking | None:
    """What became of a member that is asked of a class that is gone, where the class in its place lacks it."""
    if not script.api.is_class(lacking.replacement):
        return None
    for node in script.all(ast.Attribute):
        if node.value is row.node and node.attr not in script.names.reader.members(lacking.replacement):
            return script.names.path(f"{lacking.symbol}.{node.attr}")
    return None


def _unloaded(script: Script) -> Iterator[Finding]:
    """Modules that are used without an import, which another script may have made."""
    told: set[str] = set()
    for node in script.all(ast.Attribute):
        path = member_path(script, node) if isinstance(node.ctx, ast.Load) else ""
        if path not in UNLOADED or path in told or not knows_all(script) or is_tried(script, node):
            continue
        told.add(path)
        if path not in _imported(script):
            yield Finding(
                RULE.id, "warning", script.name_span(node),
                f"`{path}` is no attribute before something imports it, as nothing does here: `import {path}`.", path,
            )  # fmt: skip


def _imported(script: Script) -> set[str]:
    """The paths of the modules, and of what else is taken from them, that a script imports."""
    found = {alias.name for node in script.all(ast.Import) for alias in node.names}
    for node in script.all(ast.ImportFrom):
        if node.module:
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return found


RULE = Rule("unknown-name", "error", "A class or function that the module does not have", _check)
