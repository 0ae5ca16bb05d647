"""An angle that is written in degrees where Blender takes radians.

```python
cube.rotation_euler = (90, 0, 45)  # reported: 90 radians are 14 turns and 117°
cube.rotation_euler = (math.radians(90), 0, math.radians(45))
```

What is taken for degrees is a whole number from 10 on that 5 divides, such as hardly any angle in radians is.

Not reported: what is computed, and numbers beyond the range of a property, which ``out-of-range`` tells.
"""

from __future__ import annotations

import ast
import math
from typing import TYPE_CHECKING

from kb_check.calls.resolved import callee_path
from kb_check.findings import Edit, Finding, Fix
from kb_check.rule import Rule
from kb_check.syntax.literals import items, number
from kb_check.values.given import given_values

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script
    from kb_check.values.given import Taker

_EULER = "mathutils.Euler"
_LEAST, _STEP = 10, 5
_TURN = 360
# What takes an angle that no base has the unit of: the place of the argument, and its name.
_ARGUMENTS = {
    _EULER: 0,
    f"{_EULER}.rotate_axis": 1,
    "mathutils.Matrix.Rotation": 0,
    "mathutils.Quaternion": 1,
}


def _check(script: Script) -> Iterator[Finding]:
    for path, value, is_taken in _angles(script):
        parts = items(script, value) or [value]
        known = {part: found for part in parts if (found := number(script, part)) is not None}
        turned = [part for part, found in known.items() if _is_degrees(found)]
        if not turned or len(known) < len(parts):
            continue
        first = known[turned[0]]
        yield Finding(
            RULE.id, "warning", script.span(value),
            f"`{path}` is in radians: {first:g} is {_turns(first)}. Write `math.radians({first:g})`.", path, (),
            _in_radians(script, turned) if is_taken else None,
        )  # fmt: skip


def _angles(script: Script) -> Iterator[tuple[str, ast.expr, bool]]:
    """What takes an angle, the value that it is given, and whether it takes as many numbers."""
    for given in given_values(script):
        if all(_is_angle(script, taker, given.node) for taker in given.takers):
            is_one = items(script, given.node) is None
            yield given.takers[0].path, given.node, not (is_one and any(one.sizes for one in given.takers))
    for node in script.all(ast.Assign):
        match node.targets:
            case [ast.Subscript(value=owner)] if script.class_of(owner) == _EULER:
                yield _EULER, node.value, True
            case _:
                pass
    for call in script.all(ast.Call):
        place = _ARGUMENTS.get(callee_path(script, call), -1)
        if 0 <= place < len(call.args):
            yield callee_path(script, call), call.args[place], True


def _is_angle(script: Script, taker: Taker, node: ast.expr) -> bool:
    """Whether a value is an angle that is not clamped."""
    if taker.symbol.owner == _EULER and not taker.is_parameter:
        return taker.symbol.name in {"x", "y", "z"}
    if taker.kind != "float" or taker.unit != "ROTATION":
        return False
    values = [number(script, part) or 0 for part in items(script, node) or [node]]
    low, high = taker.kept_ends
    return (low is None or min(values, default=0) >= low) and (high is None or max(values, default=0) <= high)


def _is_degrees(value: float) -> bool:
    return abs(value) >= _LEAST and value % _STEP == 0


def _turns(radians: float) -> str:
    turns, rest = divmod(math.degrees(abs(radians)), _TURN)
    return f"{turns:.0f} turn{'s' * (turns != 1)} and {rest:.0f}°"


def _in_radians(script: Script, parts: list[ast.expr]) -> Fix | None:
    """The fix that turns numbers to radians, and imports what does."""
    spans = [script.span(part) for part in parts]
    if any(isinstance(part, ast.Name) for part in parts):
        return None
    edits = [Edit(span, f"math.radians({script.text(span)})") for span in spans]
    imports = [node for node in script.tree.body if isinstance(node, ast.Import)]
    if not imports:
        return None
    if all(alias.name != "math" or alias.asname for node in imports for alias in node.names):
        edits.append(Edit.before(script.span(imports[0]), "import math\n"))
    return Fix("Write radians", tuple(edits))


RULE = Rule("degrees", "warning", "An angle in degrees where Blender takes radians", _check)
