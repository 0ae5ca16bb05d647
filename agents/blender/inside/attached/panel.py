# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's panel and settings in Blender. Nothing starts by itself unless the user says so."""

import atexit

import bpy

from . import calls

ROOT = __package__.partition(".worker.")[0]
VERSION = "0.1.0"
_SHORT = 46
_START_SECONDS = 1.0

runner = None


def _rights_changed(_preferences, _context):
    if runner is not None and runner.listener is not None:
        runner.announce()


class SIMWORLDS_Preferences(bpy.types.AddonPreferences):
    """What clients may do."""

    bl_idname = ROOT

    may_change: bpy.props.BoolProperty(name="Change the scene", default=True, update=_rights_changed)
    may_run: bpy.props.BoolProperty(name="Run code, rehearsed in a copy", default=True, update=_rights_changed)
    may_run_unrehearsed: bpy.props.BoolProperty(
        name="Run code that was not rehearsed",
        description="Such code can hang or crash this Blender",
        default=False,
        update=_rights_changed,
    )
    several: bpy.props.BoolProperty(name="Several clients at once", default=False, update=_rights_changed)
    ignore_addons: bpy.props.BoolProperty(
        name="Work beside add-ons' modal operators",
        description="For add-ons that run as long as Blender does, such as those that show pressed keys",
        default=False,
    )
    start_by_itself: bpy.props.BoolProperty(name="Start with Blender", default=False)

    def draw(self, _context):
        """Draws the settings."""
        _draw_rights(self.layout, self)


class SIMWORLDS_OT_start(bpy.types.Operator):
    """Let SimWorlds on this machine connect to this Blender."""

    bl_idname = "simworlds.start"
    bl_label = "Start"

    def execute(self, _context):
        """Starts to listen."""
        try:
            runner.start()
        except (OSError, LookupError) as error:
            self.report({"ERROR"}, f"SimWorlds cannot listen: {error}")
            return {"CANCELLED"}
        return {"FINISHED"}


class SIMWORLDS_OT_stop(bpy.types.Operator):
    """End the connection."""

    bl_idname = "simworlds.stop"
    bl_label = "Stop"

    def execute(self, _context):
        """Stops listening."""
        runner.stop()
        return {"FINISHED"}


class SIMWORLDS_OT_undo(bpy.types.Operator):
    """Take back SimWorlds' newest step."""

    bl_idname = "simworlds.undo"
    bl_label = "Undo the last step"

    @classmethod
    def poll(cls, _context):
        """Whether there is a step."""
        return runner is not None and runner.listener is not None and bool(runner.undo_steps.steps)

    def execute(self, _context):
        """Undoes, once this operator has ended."""

        def undo():
            try:
                runner.undo_steps.undo(1)
            except calls.Refused as error:
                runner.log.appendleft(calls.LogEntry(str(error), 0.0, well=False))
            _redraw()

        runner.want(undo)
        return {"FINISHED"}


class SIMWORLDS_PT_panel(bpy.types.Panel):
    """Who is connected, what they may do, and what they did."""

    bl_label = "SimWorlds"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "SimWorlds"

    def draw(self, _context):
        """Draws the panel."""
        layout = self.layout
        listens = runner.listener is not None
        names = runner.clients
        if not listens:
            layout.label(text="Not listening", icon="UNLINKED")
            layout.operator("simworlds.start", icon="PLAY")
        else:
            text = f"Connected: {', '.join(names)}" if names else "Waiting: simworlds mcp --attach"
            layout.label(text=text, icon="LINKED" if names else "TIME")
            layout.operator("simworlds.stop", icon="PAUSE")
        _draw_rights(layout, _preferences())
        if runner.log:
            box = layout.box()
            row = box.row()
            row.label(text="Last calls")
            row.operator("simworlds.undo", text="Undo", icon="LOOP_BACK")
            for entry in list(runner.log):
                text = entry.text if len(entry.text) <= _SHORT else f"{entry.text[:_SHORT]}…"
                box.label(text=f"{text}  {entry.seconds:.2f} s", icon="CHECKMARK" if entry.well else "CANCEL")


def _draw_rights(layout, preferences):
    column = layout.column(heading="May")
    column.label(text="Look, and show you things", icon="HIDE_OFF")
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
    if runner is not None and not bpy.app.background and _preferences().start_by_itself:
        runner.start()


def _at_exit():
    if runner is not None:
        runner.leave("The user has closed Blender.")


_CLASSES = (SIMWORLDS_Preferences, SIMWORLDS_OT_start, SIMWORLDS_OT_stop, SIMWORLDS_OT_undo, SIMWORLDS_PT_panel)


def register():
    """Called by Blender when the extension is enabled."""
    global runner
    for kind in _CLASSES:
        bpy.utils.register_class(kind)
    runner = calls.CallRunner(_rights, VERSION, _redraw)
    atexit.register(_at_exit)
    bpy.app.timers.register(_start_by_itself, first_interval=_START_SECONDS)


def unregister():
    """Called by Blender when the extension is disabled."""
    global runner
    atexit.unregister(_at_exit)
    runner.stop("The user has disabled the SimWorlds extension.")
    runner = None
    for kind in reversed(_CLASSES):
        bpy.utils.unregister_class(kind)
