"""A number beyond what a property can hold.

Blender does not refuse it: the property gets the nearest value that it can hold, and the script goes on with another
number than it says.

```python
material.roughness = 5  # reported: it becomes 1
bpy.ops.mesh.primitive_circle_add(vertices=1)  # reported: it becomes 3
```

Not reported: ends of ranges that Blender does not keep to, as was tried when the base was built (the mass of a rigid
body); values of sockets, which the range of their slider does not bound; values of shape keys, whose range is set
beside them; and arguments of functions.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kb_check.findings import Edit, Finding, Fix
from kb_check.rule import Rule
from kb_check.syntax.literals import items, number
from kb_check.values.given import given_values
from kb_serve.answer.facts.ranges import number_text, range_text

if TYPE_CHECKING:
    import ast
    from collections.abc import Iterator

    from kb_check.script import Script
    from kb_check.values.given import Taker

_LONGEST_INT = 2**31
_ROUNDING = 1e-5  # of the limits, which Blender keeps as 32-bit floats
# Properties of which RNA's range says nothing, and Blender's own values when the base was made neither: what stays of a
# number depends on other things, or on the machine.
_BOUND_OTHERWISE = {
    "ColorManagedViewSettings": {"white_balance_whitepoint"},
    "MeshLoop": {"edge_index", "vertex_index"},
    "MeshPolygon": {"vertices"},
    "NodeSocket": {"default_value", "link_limit"},
    "PointCacheItem": {"frame_step"},
    "PreferencesEdit": {"undo_steps"},
    "RenderSettings": {"threads"},
    "ShapeKey": {"value"},
    "ThemeWidgetColors": {"roundness"},
    "ToolSettings": {"snap_playhead_frame_step", "snap_playhead_second_step"},
}


def _check(script: Script) -> Iterator[Finding]:
    for given in given_values(script):
        taker = given.takers[0]
        if len(given.takers) == 1 and taker.kind in {"int", "float"} and _is_clamped(script, taker):
            parts = (items(script, given.node) or []) if taker.sizes else [given.node]
            for part in parts:
                yield from _judged(script, taker, part)


def _is_clamped(script: Script, taker: Taker) -> bool:
    if taker.is_parameter:
        return taker.is_operator
    symbol = taker.symbol
    return not any(
        symbol.name in names and script.api.descends(symbol.owner, f"bpy.types.{cls}")
        for cls, names in _BOUND_OTHERWISE.items()
    )


def _judged(script: Script, taker: Taker, node: ast.expr) -> Iterator[Finding]:
    value = number(script, node)
    if value is None or (taker.kind == "int" and (isinstance(value, float) or abs(value) >= _LONGEST_INT)):
        return
    low, high = taker.kept_ends
    limit = low if low is not None and value < low - _slack(low) else None
    if high is not None and value > high + _slack(high):
        limit = high
    if limit is None:
        return
    kept, said = number_text(limit, taker.kind), number_text(value, taker.kind)
    holds = range_text(low, high, taker.kind)
    span = script.span(node)
    literal = script.text(span).lstrip("+-").replace(".", "", 1).isdigit()
    yield Finding(
        RULE.id, "warning", span,
        f"`{taker.path}` holds {holds}: {said} becomes {kept}.{_advice(taker, value)}", taker.path, (),
        Fix(f"Write {kept}", (Edit(span, kept),)) if literal and not _advice(taker, value) else None,
    )  # fmt: skip


def _advice(taker: Taker, value: float) -> str:
    low, high = taker.hard_min, taker.hard_max
    angle = math.radians(value)
    in_degrees = (low is None or angle >= low - _slack(low)) and (
        high is None or angle <= high + _slack(high)
    )
    return (
        f" It is an angle in radians: `math.radians({value:g})`?"
        if taker.unit == "ROTATION" and in_degrees
        else ""
    )


def _slack(limit: float) -> float:
    return _ROUNDING * max(1.0, abs(limit))


RULE = Rule("out-of-range", "warning", "A number beyond what a property can hold", _check)
