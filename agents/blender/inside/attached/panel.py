# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's panel and settings in Blender. Nothing starts by itself unless the user says so."""

# Blender reads the properties of a class from its annotations.
# pyright: reportInvalidTypeForm=false

import atexit
from typing import Any

import bpy

from . import calls
from .user import hold

ROOT = __package__.partition(".worker.")[0]
VERSION = "0.1.0"
_SHORT = 46
_START_SECONDS = 1.0

_state = {"runner": None}


def _runner() -> Any:
    """The runner, while the extension is enabled."""
    return _state["runner"]


def _rights_changed(_preferences, _context):
    if _runner() is not None and _runner().listener is not None:
        _runner().announce()


class SimWorldsPreferences(bpy.types.AddonPreferences):
    """What clients may do."""

    bl_idname = ROOT

    may_change: bpy.props.BoolProperty(name="Change the scene", default=True, update=_rights_changed)
    may_run: bpy.props.BoolProperty(
        name="Run rehearsed code",
        description="Code that ran in a copy of the scene before",
        default=True,
        update=_rights_changed,
    )
    may_run_unrehearsed: bpy.props.BoolProperty(
        name="Run other code",
        description="Such code can hang or crash this Blender",
        default=False,
        update=_rights_changed,
    )
    several: bpy.props.BoolProperty(name="Several clients", default=False, update=_rights_changed)
    ignore_addons: bpy.props.BoolProperty(
        name="Despite add-ons' tools",
        description="Work while a modal operator of an add-on runs, for add-ons that run as long as Blender does",
        default=False,
    )
    start_by_itself: bpy.props.BoolProperty(name="Start with Blender", default=False)

    def draw(self, _context):
        """Draws the settings."""
        _draw_rights(self.layout, self)


class StartOperator(bpy.types.Operator):
    """Let SimWorlds on this machine connect to this Blender."""

    bl_idname = "simworlds.start"
    bl_label = "Start"

    def execute(self, _context):
        """Starts to listen."""
        try:
            _runner().start()
        except (OSError, LookupError) as error:
            self.report({"ERROR"}, f"SimWorlds cannot listen: {error}")
            return {"CANCELLED"}
        return {"FINISHED"}


class StopOperator(bpy.types.Operator):
    """End the connection."""

    bl_idname = "simworlds.stop"
    bl_label = "Stop"

    def execute(self, _context):
        """Stops listening."""
        _runner().stop()
        return {"FINISHED"}


class UndoOperator(bpy.types.Operator):
    """Take back SimWorlds' newest step."""

    bl_idname = "simworlds.undo"
    bl_label = "Undo the last step"

    @classmethod
    def poll(cls, _context):
        """Whether there is a step."""
        return _runner() is not None and _runner().listener is not None and bool(_runner().undo_steps.steps)

    def execute(self, _context):
        """Undoes, once this operator has ended."""

        def undo():
            try:
                _runner().undo_steps.undo(1)
            except calls.Refused as error:
                _runner().log.appendleft(calls.LogEntry(str(error), 0.0, well=False))
            _redraw()

        _runner().want(undo)
        return {"FINISHED"}


class SimWorldsPanel(bpy.types.Panel):
    """Who is connected, what they may do, and what they did."""

    bl_idname = "SIMWORLDS_PT_panel"
    bl_label = "SimWorlds"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "SimWorlds"

    def draw(self, _context):
        """Draws the panel."""
        layout = self.layout
        listens = _runner().listener is not None
        names = _runner().clients
        if not listens:
            layout.label(text="Not listening", icon="UNLINKED")
            layout.operator("simworlds.start", icon="PLAY")
        else:
            text = f"Connected: {', '.join(names)}" if names else "Waiting for a client"
            layout.label(text=text, icon="LINKED" if names else "TIME")
            layout.operator("simworlds.stop", icon="PAUSE")
        _draw_rights(layout, _preferences())
        if _runner().log:
            box = layout.box()
            row = box.row()
            row.label(text="Last calls")
            row.operator("simworlds.undo", text="Undo", icon="LOOP_BACK")
            for entry in list(_runner().log):
                text = entry.text if len(entry.text) <= _SHORT else f"{entry.text[:_SHORT]}…"
                box.label(text=f"{text}  {entry.seconds:.2f} s", icon="CHECKMARK" if entry.well else "CANCEL")


def _draw_rights(layout, preferences):
    column = layout.column()
    column.label(text="Clients may look, and", icon="HIDE_OFF")
    column.prop(preferences, "may_change")
    row = column.row()
    row.enabled = preferences.may_change
    row.prop(preferences, "may_run")
    row = column.row()
    row.enabled = preferences.may_change and preferences.may_run
    row.prop(preferences, "may_run_unrehearsed")
    column.separator()
    column.prop(preferences, "several")
    column.prop(preferences, "ignore_addons")
    column.prop(preferences, "start_by_itself")


def _preferences():
    return bpy.context.preferences.addons[ROOT].preferences


def _rights():
    rights, chosen = calls.Rights(), _preferences()
    rights.change, rights.code = chosen.may_change, chosen.may_run
    rights.unrehearsed, rights.several = chosen.may_run_unrehearsed, chosen.several
    rights.ignore_addons = chosen.ignore_addons
    return rights


def _redraw():
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                for region in area.regions:
                    if region.type == "UI":
                        region.tag_redraw()


def _start_by_itself():
    if _runner() is not None and not bpy.app.background and _preferences().start_by_itself:
        _runner().start()


def _at_exit():
    if _runner() is not None:
        _runner().leave("The user has closed Blender.")


_CLASSES = (
    hold.HoldOperator,
    SimWorldsPreferences,
    StartOperator,
    StopOperator,
    UndoOperator,
    SimWorldsPanel,
)


def register():
    """Called by Blender when the extension is enabled."""
    for kind in _CLASSES:
        bpy.utils.register_class(kind)
    _state["runner"] = calls.CallRunner(_rights, VERSION, _redraw)
    atexit.register(_at_exit)
    bpy.app.timers.register(_start_by_itself, first_interval=_START_SECONDS)


def unregister():
    """Called by Blender when the extension is disabled."""
    atexit.unregister(_at_exit)
    _runner().stop("The user has closed Blender, or disabled the SimWorlds extension.")
    _state["runner"] = None
    for kind in reversed(_CLASSES):
        bpy.utils.unregister_class(kind)
