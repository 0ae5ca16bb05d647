"""What the context has only where a script runs in an area of a window."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES

SPACE = f"{TYPES}Space"  # what an area shows
OF_AN_AREA = frozenset(f"{TYPES}Context.{name}" for name in ("area", "region", "region_data", "space_data"))
OUTSIDE = (
    "`bpy.context` has no `area`, `region`, `region_data` or `space_data` where a script runs in no area, as from the "
    "command line or in a handler. One is taken from a window: `areas = "
    "bpy.context.window_manager.windows[0].screen.areas`, `area = next(a for a in areas if a.type == 'VIEW_3D')`, then "
    "`area.spaces.active`; an operator is given it by `with bpy.context.temp_override(area=area):`."
)
