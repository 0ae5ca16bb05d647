"""An operator that runs only in an area of a window, or something read from an area, in a script that gives it none.

Run with ``--background``, from a terminal or by an agent, a script has no area: the operator's poll fails, a
RuntimeError, and ``context.area`` is None. The same script may run from Blender's text editor.

```python
bpy.ops.view3d.view_selected()  # reported
bpy.context.space_data.shading.type = (
    "SOLID"  # reported: bpy.context.screen.areas has the areas that a file shows
)
with bpy.context.temp_override(window=window, area=area, region=region):
    bpy.ops.view3d.view_selected()
```

Not reported: what stands inside ``temp_override`` or in a class, which Blender's interface calls; add-ons (a file with
a function ``register``), modules that only define, functions that the script does not call; scripts that ask for
``bpy.app.background`` or for the operator's ``poll``.

Which operators those are was found by asking each whether it can run, with objects of all types in all modes, in every
area and in none (``kb_build/blender/inside/preconditions/operator_areas.py``).
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Builtin, Mapping, Operator
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flags import operator_areas, operator_given
from kb_build.symbols.lines import area_text
from kb_check.calls.sites import calls
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.background import is_called_by_others, lines_of_others
from kb_check.running.read_pointers import read_from
from kb_check.syntax.bindings import alias
from kb_check.syntax.words import asked_names

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.running.read_pointers import PointerRead
    from kb_check.script import Script


# What the context has in an area alone.
_OF_AREAS = {f"{T}Context.{name}": name for name in ("area", "region", "region_data", "space_data")}
_AREAS = "the areas that a file shows are in `bpy.context.screen.areas`"


def _check(script: Script) -> Iterator[Finding]:
    found = [call for call in calls(script) if _wants(call.callee.symbol)]
    read = [one for one in read_from(script, _OF_AREAS) if _is_starting(script, one)]
    if not (found or read) or is_called_by_others(script):
        return
    asked = set(_asked(script))
    given = lines_of_others(script)
    for call in found:
        path = call.callee.symbol.path
        first = script.type_of(call.node.args[0]) if call.node.args else None
        line = call.node.lineno
        if path in asked or isinstance(first, Mapping) or line in given:
            continue
        yield Finding(
            RULE.id, "note", script.span(call.node), f"`{path}` {_advice(call.callee.symbol)}", path,
            ("bpy.types.Context.temp_override",),
        )  # fmt: skip
    for one in read:
        if one.node.lineno not in given:
            told = f"`{one.path}` is None in a Blender without a window (`--background`): {_AREAS}."
            yield Finding(RULE.id, "note", script.name_span(one.node), told, one.path, (f"{T}Screen.areas",))


def _is_starting(script: Script, read: PointerRead) -> bool:
    """Whether it is read of the context that Blender starts with, none that is handed on, and not asked for."""
    is_own = ast.unparse(alias(script, read.pointer.value)) == "bpy.context"
    return is_own and _OF_AREAS[read.path] not in asked_names(script)


def _wants(operator: Symbol) -> bool:
    """Whether an operator wants what the context of a script does not have."""
    return bool(operator_areas(operator) or operator_given(operator))


def _advice(operator: Symbol) -> str:
    """How an operator runs where there is no window."""
    areas, member = operator_areas(operator), operator_given(operator)
    given = f"give it that with `bpy.context.temp_override({member}=…)`"
    if not areas:
        return f"runs with `{member}` in the context, which is there in its panel alone: {given}."
    where = f"runs in {area_text(areas)}, which a Blender without a window (`--background`) does not have"
    if member:
        return f"{where}, or with what it works on: {given}, which needs no window."
    return f"{where}: give it one with `bpy.context.temp_override(window=…, area=…, region=…)`."


def _asked(script: Script) -> Iterator[str]:
    """The operators whose poll a script asks for."""
    for kind in script.analysis.types.values():
        if isinstance(kind, Builtin) and kind.name == "operator.poll" and isinstance(kind.receiver, Operator):
            yield kind.receiver.path


RULE = Rule("needs-context", "note", "What runs or is there only in an area of a window", _check)
