"""What belongs to Blender's windows and tools rather than to scenes."""

from __future__ import annotations

_PARTS = ("tool_settings", "space_data", "preferences", "window", "studio_light", "region", ".area", "gizmo")


def is_of_interface(expression: str) -> bool:
    """Whether an expression leads to what belongs to Blender's windows and tools."""
    return any(part in expression for part in _PARTS)
