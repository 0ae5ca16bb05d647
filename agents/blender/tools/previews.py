"""The four preview tools: images of one mesh, one object, one system, the whole scene."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Annotated

from PIL import Image
from pydantic import Field

from agents.blender.sheets import contact_sheet
from agents.blender.sheets.text_layout import format_length
from agents.blender.sheets.view_reply import PreviewReply
from agents.blender.sheets.worker_pictures import taken_picture
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from agents.blender.tools.preview_files import new_preview
from simworlds.counting import counted, format_list

if TYPE_CHECKING:
    from agents.blender.sheets.view_reply import DrawnView
    from agents.blender.supervisor import Supervisor

PANEL = 384  # pixels a side
_BACKGROUND: contact_sheet.Colour = (198, 202, 208)
_LAST_FRAME = 1_048_574
_NAMED = 30


class PreviewArguments(Arguments):
    """The arguments of all previews."""

    frame: int | None = Field(
        default=None,
        ge=-_LAST_FRAME,
        le=_LAST_FRAME,
        description="Default: the current one.",
    )
    timeout: float = Field(default=120.0, ge=1, le=3600, description="Seconds.")


class SingleMeshArguments(PreviewArguments):
    """The arguments of ``blender_single_mesh_preview``."""

    object: str = Field(min_length=1, max_length=200, description="Its name.")


class ObjectArguments(PreviewArguments):
    """The arguments of ``blender_object_preview``."""

    object: str = Field(min_length=1, max_length=200, description="Name of its collection.")


class LayoutArguments(PreviewArguments):
    """The arguments of previews of several objects."""

    everything: bool = Field(
        default=False,
        description="Fit in grounds, backdrops, distant objects too.",
    )


class SystemLayoutArguments(LayoutArguments):
    """The arguments of ``blender_system_layout_preview``."""

    system: str = Field(min_length=1, max_length=200, description="Name of its collection.")


class SceneLayoutArguments(LayoutArguments):
    """The arguments of ``blender_scene_layout_preview``."""

    subjects: list[Annotated[str, Field(min_length=1, max_length=200)]] = Field(
        default_factory=list[str],
        max_length=40,
        description="Objects to label first and show closely.",
    )


_ALIKE = "from front, right, top and three-quarter, evaluated, with scale bars, in plain colours."


def run_single_mesh(context: ToolContext, arguments: SingleMeshArguments, call: Call) -> Result:
    """Shows one Blender object alone."""
    return _preview(context, "mesh", arguments.object, arguments, call)


def run_object(context: ToolContext, arguments: ObjectArguments, call: Call) -> Result:
    """Shows one object (L3) alone."""
    return _preview(context, "object", arguments.object, arguments, call)


def run_system_layout(context: ToolContext, arguments: SystemLayoutArguments, call: Call) -> Result:
    """Shows one system (L2) alone."""
    return _preview(context, "system", arguments.system, arguments, call)


def run_scene_layout(context: ToolContext, arguments: SceneLayoutArguments, call: Call) -> Result:
    """Shows everything that renders show."""
    return _preview(context, "scene", None, arguments, call)


def _preview(
    context: ToolContext, kind: str, name: str | None, arguments: PreviewArguments, call: Call
) -> Result:
    blender, folder = context.blender, context.blender.folder
    request = {
        "kind": kind,
        "name": name,
        "frame": arguments.frame,
        "everything": isinstance(arguments, LayoutArguments) and arguments.everything,
        "subjects": arguments.subjects if isinstance(arguments, SceneLayoutArguments) else [],
        "folder": folder.workspace.for_blender(),
        "size": PANEL,
    }
    read = PreviewReply.model_validate
    reply = blender.call(
        "preview", request, read, timeout=arguments.timeout, progress=call.progress, cancelled=call.cancelled
    )
    preview = reply.value
    panels = [_panel(blender, view, preview) for view in preview.views]
    title = re.sub(r"\W+", "-", preview.title).strip("-")[:40] or "unnamed"
    png = contact_sheet.to_png(_sheet(kind, preview, panels))
    image = new_preview(folder, f"{kind}-{title}-frame-{preview.frame}", png)
    data = preview.model_dump(exclude={"views": {"__all__": {"file", "marks"}}})
    data |= {"file": str(image.path.relative_to(folder.root)), "seconds": round(reply.seconds, 3)}
    return Result(_text(kind, preview, data["file"]), data, (image,))


# The sheet


def _panel(blender: Supervisor, view: DrawnView, preview: PreviewReply) -> contact_sheet.Panel:
    """The panel of a view; the image that Blender left in the workspace is removed."""
    picture = taken_picture(blender, view.file, _BACKGROUND).resize(view.size, Image.Resampling.LANCZOS)
    if view.ground is not None:
        contact_sheet.draw_level(picture, view.ground, "z = 0")
    if view.metres_per_pixel:
        contact_sheet.draw_scale_bar(picture, view.metres_per_pixel)
    contact_sheet.draw_labels(picture, view.labels)
    contact_sheet.draw_axes(picture, view.axes)
    return contact_sheet.Panel(picture, view.name, view.lens or _across(view.name, preview))


def _across(view: str, preview: PreviewReply) -> str:
    """The extent of the framed geometry along the world's axes that a view shows without foreshortening."""
    axes = {"front": "XZ", "right": "YZ", "top": "XY"}.get(view, "") if not preview.turned else ""
    return " · ".join(f"{letter} {format_length(preview.size['XYZ'.index(letter)])}" for letter in axes)


def _sheet(kind: str, preview: PreviewReply, panels: list[contact_sheet.Panel]) -> Image.Image:
    blocks = [contact_sheet.grid(panels, 2)]
    if len(panels) > 4:
        rows = (panels[:3], panels[3:5], panels[5:])
        blocks = [contact_sheet.grid(row, len(row)) for row in rows if row]
    return contact_sheet.sheet(
        f"{kind.capitalize()}: {preview.title}",
        blocks,
        subtitle=f"frame {preview.frame} · {_size_of(preview)} · {counted(preview.objects, 'object')}",
        remarks=[*_turned(preview), *_cut_away(preview)],
        notes=preview.notes,
    )


def _size_of(preview: PreviewReply) -> str:
    return " × ".join(format_length(edge) for edge in preview.size)


def _turned(preview: PreviewReply) -> list[str]:
    """A line on views that are not along the world's axes."""
    if not preview.turned:
        return []
    return [f"Seen along its own axes: it is turned by {preview.turned:g}° about Z."]


def _cut_away(preview: PreviewReply) -> list[str]:
    """A line on what was cut away in which view; none if nothing was."""
    views = [f"{view.name}: {format_list(view.cut_away, _NAMED)}" for view in preview.views if view.cut_away]
    return [f"Cut away to see inside – {'; '.join(views)}."] if views else []


def _text(kind: str, preview: PreviewReply, file: str) -> str:
    low, high = (", ".join(f"{part:.4g}" for part in corner) for corner in (preview.low, preview.high))
    lines = [
        f"{preview.title} ({kind}), frame {preview.frame}: {counted(preview.objects, 'object')}, "
        f"{_size_of(preview)} (x × y × z), from ({low}) to ({high}).",
        *_turned(preview),
        *_cut_away(preview),
        *(f"- {note}" for note in preview.notes),
        f"Saved as {file}.",
    ]
    return "\n".join(lines)


SINGLE_MESH = BlenderTool(
    "blender_single_mesh_preview",
    "See one mesh",
    f"See one mesh, curve or text alone, {_ALIKE}",
    SingleMeshArguments,
    run_single_mesh,
    read_only=True,
    shows_scene=True,
    profile="look",
    habit="to see one mesh from all sides before it is used",
)
OBJECT = BlenderTool(
    "blender_object_preview",
    "See one object",
    f"See one object (L3) alone, {_ALIKE}",
    ObjectArguments,
    run_object,
    read_only=True,
    shows_scene=True,
    profile="look",
)
_ROOMS = "Closed rooms are cut open."
SYSTEM_LAYOUT = BlenderTool(
    "blender_system_layout_preview",
    "See one system",
    f"See one system (L2) alone, {_ALIKE} {_ROOMS}",
    SystemLayoutArguments,
    run_system_layout,
    read_only=True,
    shows_scene=True,
    profile="look",
)
SCENE_LAYOUT = BlenderTool(
    "blender_scene_layout_preview",
    "See the scene",
    f"See the scene through its camera, and {_ALIKE} {_ROOMS}",
    SceneLayoutArguments,
    run_scene_layout,
    read_only=True,
    shows_scene=True,
    profile="look",
    habit="to see the scene; use it after every step that changes what is seen",
)
TOOLS = (SINGLE_MESH, OBJECT, SYSTEM_LAYOUT, SCENE_LAYOUT)
