"""A setting that Blender greys out as long as another is off, on something that the script has just made.

```python
camera = bpy.data.cameras.new("Camera")
camera.dof.focus_distance = 3  # reported: camera.dof.use_dof is off on a new camera, and stays off
```

Blender's own panels tell which settings have such a switch.

Not reported: things that the script did not make itself, which may have the switch on; scripts that name the switch
anywhere, or set settings by names that they compute; and values that a new thing has anyway.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.flags import usual_default
from kb_build.symbols.lines import switches
from kb_build.symbols.records import COMPARED
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names
from kb_check.scene.made_here import is_new
from kb_check.syntax.words import named_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for row in script.resolutions("store"):
        node = row.node
        certain = row.sure and not row.guarded and not row.missing and len(row.symbols) == 1
        if not certain or not isinstance(node, ast.Attribute):
            continue
        gate = _switch(script, row.symbols[0])
        if (
            gate is None
            or gate.name in named_words(script)
            or _has_default(script, row.statement, row.symbols[0])
        ):
            continue
        if not computes_names(script) and is_new(script, node.value):
            yield Finding(
                RULE.id, "note", script.name_span(node),
                f"Blender's panels grey `{row.symbols[0]}` out unless `{gate.name}` is on. A new one has it off, and "
                "this script does not turn it on.", gate.path, (gate.path,),
            )  # fmt: skip


def _switch(script: Script, path: str) -> Symbol | None:
    """The truth value of the same thing, off on every new one, that must be on before panels let a property be set."""
    reader = script.names.reader
    for switch, *others in switches(reader.panel_tests(path)):
        gate = None if others else script.api.symbols.symbol(switch)
        if gate is None or not reader.descends(path.rpartition(".")[0], gate.owner):
            continue
        values = [new.value for new in gate.new_values] or [usual_default(gate)]
        if COMPARED in gate.flags and all(value is False for value in values):
            return gate
    return None


def _has_default(script: Script, statement: ast.stmt | None, path: str) -> bool:
    """Whether a statement assigns what a new thing has, or something that is not one expression."""
    if not isinstance(statement, ast.Assign):
        return True
    symbol = script.api.symbols.symbol(path)
    try:
        value = ast.literal_eval(statement.value)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        return False
    default = usual_default(symbol) if symbol else None
    return value is None or value == (tuple(default) if isinstance(default, list) else default)


RULE = Rule("switched-off", "note", "A setting whose switch is off", _check)
