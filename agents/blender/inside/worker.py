# SPDX-License-Identifier: GPL-3.0-or-later
"""Serves the tools of the live Blender to its supervisor."""

from simworlds.sandbox.inside import mantaflow, service

from . import changes, interpreter_state
from .exchange import usd_thread
from .physics import freed_bakes, rigid_body_inputs

# Tool → (module of this package, function). A tool takes its arguments and ``report(done, total, text)``, and returns
# JSON data.
TOOLS = {
    "execute": ("execute", "execute"),
    "execute_captured": ("captured_execute", "execute_captured"),
    "present": ("api_presence", "present"),
    "open": ("blend.file_io", "open_file"),
    "write": ("blend.file_io", "write_file"),
    "ping": ("blend.file_io", "ping"),
    "tag": ("tag", "tag"),
    "save": ("portable_copy", "save"),
    "inspect": ("portable_copy", "inspect"),
    "load": ("portable_copy", "load"),
    "exchange_formats": ("exchange.hand_out", "available"),
    "import_file": ("exchange.bring_in", "import_file"),
    "export_file": ("exchange.hand_out", "export_file"),
    "read_assets": ("assets.read", "read_assets"),
    "place_asset": ("assets.place", "place_asset"),
    "connect_textures": ("assets.place", "connect_textures"),
    "set_world": ("assets.place", "set_world"),
    "kept_caches": ("portable_copy", "caches_of_file"),
    "bake": ("physics.bake", "bake"),
    "free_bake": ("physics.bake", "free"),
    "trial": ("motion.trial", "trial"),
    "scene_facts": ("measure.scene_facts", "scene_facts"),
    "measure": ("measure.batch", "measure"),
    "go_to_frame": ("motion.timeline", "go_to_frame"),
    "findings_image": ("preview.findings_image", "findings_image"),
    "group": ("group", "group"),
    "preview": ("preview.fixed_views", "preview"),
    "viewport": ("preview.viewport", "viewport"),
    "make_drawable": ("preview.viewport", "make_drawable"),
    "material_sheet": ("preview.material_sheet", "material_sheet"),
    "uv_sheet": ("preview.uv_sheet", "uv_sheet"),
    "subject_mask": ("preview.subject_mask", "subject_mask"),
    "motion_sheet": ("motion.motion_sheet", "motion_sheet"),
    "scene_state": ("state.readout", "scene_state"),
    "scene_summary": ("state.plain_summary", "scene_summary"),
    "object_summary": ("state.plain_summary", "object_summary"),
    "named_items": ("state.plain_summary", "named_items"),
    "render_plan": ("render.camera_frames", "plan"),
    "render_step": ("render.camera_frames", "step"),
    "render_frame": ("render.camera_frames", "render_frame"),
    "render_put_back": ("render.camera_frames", "put_back"),
    "render_video": ("render.video", "assemble"),
    "fluid_self_test": ("physics.fluid_self_test", "self_test"),
    "check_escapes": ("self_check", "try_escapes"),
    "check_workbench": ("self_check", "workbench"),
    "check_cycles": ("self_check", "cycles"),
    "check_video": ("self_check", "video"),
}

# Those after which the file is as the last executed code left it.
_LEAVING = frozenset({"execute", "present", "ping", "write"})


class _Guard:
    """Restores the interpreter after each call, this package's modules included."""

    def __init__(self):
        self._interpreter = interpreter_state.InterpreterState(service.HIGH)

    def before(self):
        self._interpreter.protect_modules()
        self._interpreter.before()

    def after(self):
        return self._interpreter.after()


def main(arguments, more=()):
    """Serves the tools, and ``more`` (as TOOLS), on the socket whose descriptor is the first argument."""
    mantaflow.mend()
    rigid_body_inputs.watch()
    freed_bakes.watch()
    usd_thread.start()
    tools = service.Tools(__package__, {**TOOLS, **dict(more)})

    def answer(tool, arguments, report):
        if tool not in _LEAVING:
            changes.forget()
        return tools.find(tool)(arguments, report)

    service.serve(int(arguments[0]), answer, _Guard())
