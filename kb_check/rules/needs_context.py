"""An operator that runs only in an area of a window, in a script that gives it none.

Run with ``--background``, from a terminal or by an agent, a script has no area: the operator's poll fails, a
RuntimeError. The same script may run from Blender's text editor.

```python
bpy.ops.view3d.view_selected()  # reported
with bpy.context.temp_override(window=window, area=area, region=region):
    bpy.ops.view3d.view_selected()
```

Not reported: what stands inside ``temp_override`` or in a class, which Blender's interface calls; add-ons (a file with
a function ``register``), modules that only define, functions that the script does not call; scripts that ask for
``bpy.app.background`` or for the operator's ``poll``.

Which operators those are was found by asking each whether it can run, with objects of all types in all modes, in every
area and in none (``kb_build/blender/inside/operator_areas.py``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.flow.types import Builtin, Mapping, Operator
from kb_build.symbols.flags import operator_areas, operator_given
from kb_build.symbols.lines import area_text
from kb_check.background import is_called_by_others, lines_of_others
from kb_check.calls import calls
from kb_check.findings import Finding
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    found = [call for call in calls(script) if _wants(call.callee.symbol)]
    if not found or is_called_by_others(script):
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


RULE = Rule("needs-context", "note", "An operator that runs only in an area of a window", _check)
