"""Explains messages that the context lacks a member which it has: it is there only with a window."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.records import PROVIDED_BY

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol

_ANYWHERE = "screen"  # where members are from that every editor of a window gives
# Member → what gives the same without a window.
_WITHOUT_WINDOW = {
    "object": "bpy.context.view_layer.objects.active",
    "active_object": "bpy.context.view_layer.objects.active",
    "selected_objects": "bpy.context.view_layer.objects.selected",
}


def note_on_absent(member: Symbol) -> str:
    """Where a member of the context is not that every editor gives, and what gives the same there; empty for others,
    of which the answer itself tells the editors.
    """
    if _ANYWHERE not in member.flagged(PROVIDED_BY):
        return ""
    instead = _WITHOUT_WINDOW.get(member.name, "")
    return (
        f"`bpy.context.{member.name}` is there only while the context has a window and its screen: not in threads, "
        "nor in every timer and handler. "
        + (f"`{instead}` needs none. Or give it one: " if instead else "Give it one: ")
        + "`with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):`."
    )
