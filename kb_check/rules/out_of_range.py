"""A number beyond what a property can hold.

Blender does not refuse it: the property gets the nearest value that it can hold, and the script goes on with another
number than it says.

```python
material.roughness = 5  # reported: it becomes 1
bpy.ops.mesh.primitive_circle_add(vertices=1)  # reported: it becomes 3
```

Not reported: values of sockets, which the range of their slider does not bound, values of shape keys, whose range is
set beside them, and arguments of functions.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kb_check.findings import Edit, Finding, Fix
from kb_check.given import given_values
from kb_check.literals import items, number
from kb_check.rule import Rule

if TYPE_CHECKING:
    import ast
    from collections.abc import Iterator

    from kb_check.given import Taker
    from kb_check.script import Script

_LONGEST_INT = 2**31
_ROUNDING = 1e-5  # of the limits, which Blender keeps as 32-bit floats
# Properties whose values RNA's range does not bound: their setters, or ranges that other values decide, do. Found by
# setting every number of some 900 instances just beyond its range, and again with each other setting of the same thing
# changed: only shape keys have a range that is set so.
_BOUND_OTHERWISE = {
    "Brush": {"size", "unprojected_size"},
    "Camera": {"angle", "angle_x", "angle_y"},
    "CameraDOFSettings": {"aperture_blades"},
    "ClothSettings": {
        "bending_stiffness", "bending_stiffness_max", "compression_stiffness", "compression_stiffness_max",
        "internal_compression_stiffness", "internal_compression_stiffness_max", "internal_tension_stiffness",
        "internal_tension_stiffness_max", "sewing_force_max", "shear_stiffness", "shear_stiffness_max", "shrink_max",
        "shrink_min", "tension_stiffness", "tension_stiffness_max",
    },
    "ColorManagedViewSettings": {"white_balance_whitepoint"},
    "CurveMapping": {"clip_max_x", "clip_max_y", "clip_min_x", "clip_min_y"},
    "MeshLoop": {"edge_index", "vertex_index"},
    "MeshPolygon": {"vertices"},
    "MultiresModifier": {"levels", "render_levels", "sculpt_levels"},
    "NodeSocket": {"default_value", "link_limit"},
    "NodeTreeInterface": {"active_index"},
    "Object": {"active_shape_key_index"},
    "OceanModifier": {"choppiness"},
    "ParticleSettings": {"hair_length", "line_length_head", "line_length_tail", "timestep"},
    "PointCache": {"frame_step"},
    "PointCacheItem": {"frame_step"},
    "PreferencesEdit": {"undo_steps"},
    "RenderSettings": {"threads"},
    "RigidBodyWorld": {"solver_iterations"},
    "Scene": {"frame_current", "frame_float"},
    "ShapeKey": {"slider_max", "slider_min", "value"},
    "Spline": {"material_index", "order_u", "order_v"},
    "Strip": {"animation_offset_end", "animation_offset_start", "content_trim_end", "content_trim_start"},
    "TextCharacterFormat": {"material_index"},
    "ThemeWidgetColors": {"roundness"},
    "ToolSettings": {"snap_playhead_frame_step", "snap_playhead_second_step"},
    "UnifiedPaintSettings": {"size", "unprojected_size"},
    "ViewLayer": {"active_aov_index", "active_lightgroup_index"},
}  # fmt: skip


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
    low, high = taker.hard_min, taker.hard_max
    limit = low if low is not None and value < low - _slack(low) else None
    if high is not None and value > high + _slack(high):
        limit = high
    if limit is None:
        return
    kept = f"{limit:g}" if taker.kind == "float" else f"{int(limit)}"
    start, end = ("-∞" if low is None else f"{low:g}"), ("∞" if high is None else f"{high:g}")
    span = script.span(node)
    literal = script.text(span).lstrip("+-").replace(".", "", 1).isdigit()
    yield Finding(
        RULE.id, "warning", span,
        f"`{taker.path}` holds {start} … {end}: {value:g} becomes {kept}.{_advice(taker, value)}", taker.path, (),
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
