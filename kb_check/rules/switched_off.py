"""A setting that Blender greys out as long as another is off, or that has no effect without it, on something that the
script has just made.

```python
camera = bpy.data.cameras.new("Camera")
camera.dof.focus_distance = 3  # reported: camera.dof.use_dof is off on a new camera, and stays off
rows = obj.modifiers.new("Rows", "ARRAY")
rows.constant_offset_displace.x = 2  # reported: rows.use_constant_offset is off
thin = obj.modifiers.new("Thin", "DECIMATE")
thin.angle_limit = 0.1  # reported: only with thin.decimate_type = 'DISSOLVE'
lamp = bpy.data.lights.new("Window", "AREA")
lamp.size_y = 2  # reported: only with lamp.shape = 'RECTANGLE' or 'ELLIPSE'
```

Blender's own panels tell which settings have such a switch, or are shown with some choice only. Of modifiers it was
tried on meshes.

Not reported: things that the script did not make itself, which may have the switch on; scripts that name the switch
anywhere, or set settings by names that they compute; and values that a new thing has anyway.
"""

from __future__ import annotations

import ast
from itertools import groupby
from operator import attrgetter
from typing import TYPE_CHECKING

from kb_build.schema import TEST_ON
from kb_build.symbols.flag_names import COMPARED
from kb_build.symbols.flags import usual_default
from kb_build.symbols.lines import is_contrary
from kb_build.symbols.paths import last_name
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names
from kb_check.scene.made_here import is_new
from kb_check.script import once_per_script
from kb_check.syntax.words import named_words

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kb_build.symbols.records import SettingCondition
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    parts = _set_in_part(script)
    for row in script.resolutions("store", "attribute"):
        node = row.node
        if row.kind == "attribute" and node not in parts:
            continue
        certain = row.sure and not row.guarded and not row.missing and len(row.symbols) == 1
        if not certain or not isinstance(node, ast.Attribute):
            continue
        path = row.symbols[0]
        message, gates = _switched_off(script, path)
        if (
            not gates
            or any(last_name(gate) in named_words(script) for gate in gates)
            or _has_default(script, row.statement, path)
        ):
            continue
        if not computes_names(script) and is_new(script, node.value):
            yield Finding(RULE.id, "note", script.name_span(node), message, gates[0], gates)


@once_per_script
def _set_in_part(script: Script) -> frozenset[ast.AST]:
    """The arrays of which the script sets one value: ``offset`` of ``rows.offset[0] = 2`` and ``rows.offset.x = 2``."""
    targets = (target for node in script.all(ast.Assign) for target in node.targets)
    owners = (target.value for target in targets if isinstance(target, (ast.Subscript, ast.Attribute)))
    return frozenset(node for node in owners if _is_array(script, node))


def _is_array(script: Script, node: ast.expr) -> bool:
    row = script.analysis.resolutions.get(node)
    symbol = script.api.symbols.symbol(row.symbols[0]) if row and len(row.symbols) == 1 else None
    return symbol is not None and bool(symbol.array)


def _switched_off(script: Script, path: str) -> tuple[str, tuple[str, ...]]:
    """(what to say of a setting, the settings of which one must be changed) where it is of no use on a new thing."""
    conditions = script.names.reader.settings.conditions_of(path)
    clauses = [[*rows] for _, rows in groupby(conditions, key=attrgetter("clause"))]
    for row, *others in clauses:
        is_switch = not others and row.otherwise == "greyed" and row.test == TEST_ON
        if is_switch and _is_otherwise(script, path, row):
            message = (
                f"Blender's panels grey `{path}` out unless `{last_name(row.gate)}` is on. A new one has it off, and "
                "this script does not turn it on."
            )
            return message, (row.gate,)
    unmet = "A new one has it otherwise, and this script does not set it."
    if idle := [row for row in conditions if row.otherwise == "idle"]:
        return f"`{path}` has no effect unless {_told(idle)}. {unmet}", tuple(row.gate for row in idle)
    for clause in clauses:
        is_choice = all(row.otherwise == "hidden" and "'" in row.test for row in clause)
        if is_choice and all(_is_otherwise(script, path, row) for row in clause):
            message = f"Blender's panels show `{path}` only if {_told(clause)}. {unmet}"
            return message, tuple(row.gate for row in clause)
    return "", ()


def _told(rows: Iterable[SettingCondition]) -> str:
    return " or ".join(f"`{last_name(row.gate)}` is {row.test}" for row in rows)


def _is_otherwise(script: Script, path: str, row: SettingCondition) -> bool:
    """Whether a setting of the same thing surely is otherwise on every new thing than is asked for."""
    gate = script.api.symbols.symbol(row.gate)
    if gate is None or not script.names.reader.descends(path.rpartition(".")[0], gate.owner):
        return False
    values = [usual_default(gate), *(new.value for new in gate.new_values)]
    return COMPARED in gate.flags and all(is_contrary(row, gate, value) for value in values)


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
