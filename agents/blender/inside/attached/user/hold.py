# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds the user's hands while a simulation is stepped through in their window: only Esc counts, which ends it."""

import bpy

NAME = "SIMWORLDS_OT_hold"
_SECONDS = 0.1  # between two looks at whether it is over, if the user does nothing
_held = {"on": False, "escaped": False}


class HoldOperator(bpy.types.Operator):
    """SimWorlds works; Esc ends it."""

    bl_idname = "simworlds.hold"
    bl_label = "SimWorlds works"
    bl_options = {"INTERNAL"}  # noqa: RUF012 - as Blender wants it

    def invoke(self, context, _event):
        """Takes the window's events."""
        manager = context.window_manager
        self._timer = manager.event_timer_add(_SECONDS, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Keeps them to itself until ``release``."""
        if not _held["on"]:
            context.window_manager.event_timer_remove(self._timer)
            return {"FINISHED"}
        if event.type == "ESC" and event.value == "PRESS":
            _held["escaped"] = True
        return {"RUNNING_MODAL"}


def begin():
    """Holds all windows from now on."""
    _held.update(on=True, escaped=False)
    for window in bpy.context.window_manager.windows:
        with bpy.context.temp_override(window=window, screen=window.screen):
            bpy.ops.simworlds.hold("INVOKE_DEFAULT")  # pyright: ignore[reportAttributeAccessIssue]


def escaped():
    """Whether the user has pressed Esc."""
    return _held["escaped"]


def tell(text):
    """Shows what is being done in the status bars."""
    for workspace in {window.workspace for window in bpy.context.window_manager.windows}:
        workspace.status_text_set(text)


def release():
    """Lets the user work again."""
    _held["on"] = False
    tell(None)
