"""``blender_view``: what the user sees and has selected."""

from __future__ import annotations

import io
import secrets
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from agents.blender.attached.attached_blender import TooLarge
from agents.blender.sheets.worker_pictures import taken_picture
from agents.blender.tools.base import Arguments, Call, Result
from agents.blender.tools.preview_files import new_preview
from simworlds.counting import format_list
from simworlds.sandbox.replies import Claim, Frame, Name, Place, mapping

if TYPE_CHECKING:
    from agents.blender.attached.tools.base import AttachedContext

NAME = "blender_view"
_SECONDS = 30.0
_WIDEST = 1280
_LISTED = 20

Editor = Literal[
    "VIEW_3D", "IMAGE_EDITOR", "UV", "ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree", "DOPESHEET",
    "FCURVES", "NLA_EDITOR", "OUTLINER", "PROPERTIES", "TEXT_EDITOR", "SEQUENCE_EDITOR", "SPREADSHEET",
]  # fmt: skip


class ViewArguments(Arguments):
    """The arguments of ``blender_view``."""

    picture: Literal["window", "none"] | Editor = Field(
        default="VIEW_3D", description="Of the largest editor of this type, of the window, or none."
    )


DESCRIPTION = """\
See what the user sees: a picture of their 3D view, another editor or the whole window, as it is on the screen; what \
they have selected, the active object, mode, tool, frame, viewpoint; missing files, linked libraries, unused data. \
Changes nothing. For geometry seen from all sides use the previews."""


class _View3D(Claim):
    perspective: Name
    shading: Name
    matrix: list[list[float]] = Field(max_length=4)
    location: list[float] = Field(max_length=3)
    distance: float
    lens: float
    local: bool


class _State(Claim):
    file: Place
    unsaved: bool
    scene: Name
    view_layer: Name
    workspace: Name
    frame: Frame
    playing: bool
    mode: Name
    tool: Name | None
    active: Name | None
    selected: list[Name] = Field(max_length=200)
    selected_count: int
    editors: list[Name] = Field(max_length=100)
    view: _View3D | None


class _WholeState(_State):
    missing: list[Place] = Field(max_length=40)
    libraries: list[Place] = Field(max_length=40)
    unused: list[Name] = Field(max_length=40)


def run(context: AttachedContext, arguments: ViewArguments, call: Call) -> Result:
    """Looks. Raises BlenderError."""
    read = _WholeState.model_validate
    state = context.open.call("user_state", {}, read, timeout=_SECONDS, cancelled=call.cancelled).value
    data: dict[str, Any] = state.model_dump()
    text = describe_state(state)
    if arguments.picture == "none":
        return Result(text, data)
    twin = context.twin.started(context.open)
    name = f"{secrets.token_hex(8)}.png"
    editor = None if arguments.picture == "window" else arguments.picture
    try:
        context.open.call(
            "screenshot",
            {"path": twin.folder.workspace.for_blender(name), "editor": editor},
            mapping,
            timeout=_SECONDS,
            cancelled=call.cancelled,
        )
    except TooLarge as error:
        return Result(f"**No picture**: {error}\n{text}", data)
    picture = taken_picture(twin, name)
    picture.thumbnail((_WIDEST, _WIDEST))
    stream = io.BytesIO()
    picture.save(stream, "PNG", optimize=True)
    shown = new_preview(twin.folder, "view", stream.getvalue())
    data["picture"] = str(shown.path.relative_to(twin.folder.root))
    return Result(text, data, (shown,))


def describe_state(state: _State) -> str:
    """The state as text."""
    name = state.file or "not saved yet"
    lines = [
        f"File: {name}{', with unsaved changes' if state.unsaved and state.file else ''}. Scene {state.scene!r}, view "
        f"layer {state.view_layer!r}, workspace {state.workspace!r}, frame {state.frame}"
        f"{', playing' if state.playing else ''}.",
        f"Mode {state.mode}, tool {state.tool or 'none'}. Active: {state.active or 'nothing'}. Selected "
        f"({state.selected_count}): {format_list(state.selected, _LISTED) or 'nothing'}.",
    ]
    if state.view is not None:
        view = state.view
        place = ", ".join(f"{part:.3g}" for part in view.location)
        local = ", local view" if view.local else ""
        lines.append(
            f"3D view: {view.perspective}, {view.shading}, looks at ({place}) from {view.distance:.3g} m{local}."
        )
    if isinstance(state, _WholeState):
        for title, names in (
            ("Missing files", state.missing),
            ("Linked libraries", state.libraries),
            ("Not used by anything", state.unused),
        ):
            lines += [f"{title}: {format_list(names, _LISTED)}."] if names else []
    return "\n".join(lines)


def read_state(value: Any) -> str:
    """The state that ``show`` returns, as text. Raises ValidationError."""
    return describe_state(_State.model_validate(value))
