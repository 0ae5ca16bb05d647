"""Explains messages that the context lacks a member which it has only with a window, or in some editors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.flag_names import PROVIDED_BY
from kb_build.symbols.object_data import OBJECT_DATA

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol

_ANYWHERE = "screen"  # where members are from that every editor of a window gives
# Member → what gives the same without a window.
_WITHOUT_WINDOW = {
    "object": "bpy.context.view_layer.objects.active",
    "active_object": "bpy.context.view_layer.objects.active",
    "selected_objects": "bpy.context.view_layer.objects.selected",
}


# What gives members of its own → the type of its area.
_EDITORS = {
    "buttons": "PROPERTIES", "clip": "CLIP_EDITOR", "file": "FILE_BROWSER", "image": "IMAGE_EDITOR",
    "node": "NODE_EDITOR", "sequencer": "SEQUENCE_EDITOR", "text": "TEXT_EDITOR", "view3d": "VIEW_3D",
}  # fmt: skip
_OF_OBJECT = frozenset(OBJECT_DATA.values())


def note_on_absent(member: Symbol) -> str:
    """Where a member of the context is not that every editor gives, or some alone, and what gives the same there."""
    givers = member.flagged(PROVIDED_BY)
    if _ANYWHERE not in givers:
        editors = " or ".join(_EDITORS[giver] for giver in givers if giver in _EDITORS)
        of_object = " The active object has its own data: `bpy.context.object.data`."
        return (
            f"`bpy.context.{member.name}` is there only where code runs in an area of type {editors}, as its panels do."
            f"{of_object if member.target in _OF_OBJECT else ''}"
            if editors
            else ""
        )
    instead = _WITHOUT_WINDOW.get(member.name, "")
    return (
        f"`bpy.context.{member.name}` is there only while the context has a window and its screen: not in threads, "
        "nor in every timer and handler. "
        + (f"`{instead}` needs none. Or give it one: " if instead else "Give it one: ")
        + "`with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):`."
    )
