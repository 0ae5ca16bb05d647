"""An operator that bakes while the render engine is not Cycles.

```python
bpy.context.scene.render.engine = "BLENDER_EEVEE"
bpy.ops.object.bake(type="DIFFUSE")  # reported: scene.render.engine = "CYCLES" comes before
```

Blender's other engines cannot bake: an error. Where a script sets no engine, it is a note: a new file has EEVEE, and
the script may be run with another file. Not reported: scripts that set Cycles anywhere, or compute the engine; what
runs in a context that others give; and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import called_operators, member_path
from kb_check.calls.sites import calls
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.background import is_called_by_others, lines_of_others
from kb_check.running.out_of_sight import knows_all
from kb_check.running.tried import is_tried
from kb_check.scene.opening import OPENING
from kb_check.syntax.bindings import assignments
from kb_check.syntax.literals import written
from kb_check.syntax.words import attributes, keywords_and_texts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_BAKE = "bpy.ops.object.bake"
_ENGINE = f"{T}RenderSettings.engine"
_NOT_BAKING = frozenset({"BLENDER_EEVEE", "BLENDER_EEVEE_NEXT", "BLENDER_WORKBENCH"})


def _check(script: Script) -> Iterator[Finding]:
    if _BAKE not in called_operators(script) or not knows_all(script):
        return
    engines = _engines(script)
    if engines is None or not engines <= _NOT_BAKING:
        return
    if not engines and (is_called_by_others(script) or not called_operators(script).isdisjoint(OPENING)):
        return
    given = lines_of_others(script)
    for call in calls(script):
        is_baking = call.callee.symbol.path == _BAKE and not is_tried(script, call.node)
        if is_baking and call.node.lineno not in given:
            here = f"is {' or '.join(sorted(engines))} here" if engines else "of a new file is EEVEE"
            yield Finding(
                RULE.id, "error" if engines else "note", script.span(call.node),
                f"`{_BAKE}` is refused by engines other than Cycles, and the engine {here}: "
                "`scene.render.engine = 'CYCLES'` comes before.",
                _BAKE,
            )  # fmt: skip


def _engines(script: Script) -> set[str] | None:
    """The engines that a script sets; None where it may set others."""
    if "engine" in keywords_and_texts(script):
        return None
    found: set[str] = set()
    values = {target: value for value, node in assignments(script).items() for target in node.targets}
    for node in attributes(script).get("engine", ()):
        if isinstance(node.ctx, ast.Load):
            return None  # it is asked for, or kept to be set again
        value = values.get(node)
        match written(script, value) if value is not None else None:
            case ast.Constant(value=str(engine)) if member_path(script, node) == _ENGINE:
                found.add(engine)
            case _:
                return None
    return found


RULE = Rule("wrong-engine", "error", "An operator that bakes while the engine is not Cycles", _check)
