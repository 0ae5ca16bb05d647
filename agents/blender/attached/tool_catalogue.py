"""The tools of an open Blender, in the order in which clients list them, and how models are told to work with them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agents.blender.attached.attached_blender import TooLarge
from agents.blender.attached.tools import bake, execute, show, undo, view
from agents.blender.attached.tools.base import AttachedTool
from agents.blender.tools import (
    files,
    group,
    job,
    material_preview,
    motion_sheet,
    previews,
    render,
    scene_state,
    tag,
    trial,
    uv_preview,
    verify,
)
from agents.blender.tools.base import BlenderTool, ToolContext
from simworlds.counting import format_list
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from agents.blender.attached.tools.base import AttachedContext
    from agents.blender.tools.base import Call, CallContext, Result

_LISTED = 6
_MOST_OBJECTS, _MOST_SUMMARIZED = 1000, 10_000  # whose state is read while the user's window waits
_MOST_READ = 2000  # whose state is read in a moment, in the copy
OPENING = (
    "You work in the Blender that the user has open, beside them. Everything you change is one undo step with a name; "
    "the user may change, save or close things at any time, which the next reply tells. Code is rehearsed in a copy "
    "first. Find objects by name, keep what the user has made, and ask before you replace it. Lengths are in metres, "
    "angles in Python in radians."
)
HABITS = (
    (view.NAME, "first, and whenever the user speaks of 'this' or 'here': what they see and have selected"),
    ("blender_docs", "before you use an API name that you have not looked up for this version"),
    scene_state.TOOL.told,
    execute.TOOL.told,
    (previews.SCENE_LAYOUT.name, "to see the scene from all sides, without moving the user's view"),
    motion_sheet.TOOL.told,
    (undo.NAME, "to take back your own steps"),
    (show.NAME, "to point the user to something"),
    (bake.TOOL.name, "for physics, before you judge motion; the user's window waits, unless it is a fluid"),
    (files.SAVE.name, "to save a copy; the user saves their own file"),
    (render.TOOL.name, "last, from a copy; start with a still"),
    job.TOOL.told,
)


def _in_open(tool: BlenderTool, run: Callable[[CallContext, Any, Call], Result]) -> AttachedTool:
    """A tool that works in the open Blender as in any other."""
    return AttachedTool(tool, lambda context, arguments, call: run(context.of_open, arguments, call))


def _in_twin(tool: BlenderTool) -> AttachedTool:
    """A tool that works in a copy, so that nothing of the user's is touched and their window stays alive."""
    return AttachedTool(
        tool, lambda context, arguments, call: tool.run(context.of_twin(call), arguments, call)
    )


def _looking(tool: BlenderTool, named: str) -> AttachedTool:
    """A tool that draws a copy: of a large scene, one of what its argument ``named`` names alone."""

    def run(context: AttachedContext, arguments: Any, call: Call) -> Result:
        note = ""
        try:
            copy = context.twin.refreshed(context.open, call.cancelled, soon=True)
        except TooLarge as error:
            value = getattr(arguments, named)
            names = [value] if isinstance(value, str) else [*(value or ())]
            try:
                if not names:
                    raise
                copy = context.twin.part_named(context.open, names, call.cancelled)
            except TooLarge as part:
                less = "fewer" if names else "some"
                raise TooLarge(
                    f"{part} Name {less} in {named!r}, or look with {view.NAME} at what the user sees."
                ) from error
            shown = format_list(names, _LISTED)
            note = f"This shows {shown} with what that needs, and nothing else of the scene: {error}"
        result = tool.run(ToolContext(copy, context.docs, context.check), arguments, call)
        return replace(result, text=f"{note}\n\n{result.text}") if note else result

    return AttachedTool(tool, run)


def _scene_state(context: AttachedContext, arguments: scene_state.SceneStateArguments, call: Call) -> Result:
    """Reads more objects than the window can wait for in the copy, unless that cannot be had."""
    most = _MOST_SUMMARIZED if arguments.detail == "summary" else _MOST_OBJECTS
    in_copy = None if arguments.detail == "summary" else _MOST_READ
    try:
        return scene_state.run(context.of_open, arguments, call, {"at_most": most, "in_copy": in_copy})
    except TooLarge:
        pass
    try:
        copy: CallContext = context.of_twin(call)
    except TooLarge:
        copy = context.of_open
    return scene_state.run(copy, arguments, call)


def _save(context: AttachedContext, arguments: files.SaveArguments, call: Call) -> Result:
    if arguments.name is None:
        raise Refusal(
            "Give the copy a name. There are no checkpoints here: every change is an undo step of Blender."
        )
    result = files.save(context.of_twin(call), arguments, call)
    text = (
        result.text.rpartition("\nThe scene is at checkpoint")[0] or result.text
    )  # of the copy: nobody asked for it
    data = {name: value for name, value in result.data.items() if name != "checkpoint"}
    return replace(result, text=text, data=data)


def _own(
    name: str, title: str, module: Any, *, read_only: bool = False, destructive: bool = False
) -> AttachedTool:
    """A tool that is there only with an open Blender."""
    arguments = {view: view.ViewArguments, show: show.ShowArguments, undo: undo.UndoArguments}[module]
    tool = BlenderTool(
        name,
        title,
        module.DESCRIPTION,
        arguments,
        _only_attached,
        read_only=read_only,
        destructive=destructive,
    )
    return AttachedTool(tool, module.run)


def _only_beside_calls(*_: Any) -> Result:
    raise Refusal("Jobs run beside the calls of a session.")


def _only_attached(*_: Any) -> Result:
    raise Refusal("This tool needs an open Blender: simworlds mcp --attach.")


ATTACHED: tuple[AttachedTool, ...] = (
    _own(view.NAME, "See what the user sees", view, read_only=True),
    AttachedTool(scene_state.TOOL, _scene_state),
    _looking(previews.SINGLE_MESH, "object"),
    _looking(previews.OBJECT, "object"),
    _looking(previews.SYSTEM_LAYOUT, "system"),
    _looking(previews.SCENE_LAYOUT, "subjects"),
    _looking(material_preview.TOOL, "objects"),
    _looking(uv_preview.TOOL, "objects"),
    _looking(motion_sheet.TOOL, "actors"),
    AttachedTool(execute.TOOL, execute.run),
    _own(undo.NAME, "Undo your steps", undo, destructive=True),
    _own(show.NAME, "Show the user something", show),
    _in_open(tag.TOOL, tag.run),
    _in_open(group.TOOL, group.run),
    _in_twin(verify.TOOL),
    AttachedTool(files.SAVE, _save),
    _in_twin(trial.TOOL),
    AttachedTool(bake.TOOL, bake.run),
    _in_twin(render.TOOL),
    AttachedTool(job.TOOL, _only_beside_calls),
)
TOOLS: tuple[BlenderTool, ...] = tuple(attached.tool for attached in ATTACHED)
RUN = {attached.tool.name: attached.run for attached in ATTACHED}
