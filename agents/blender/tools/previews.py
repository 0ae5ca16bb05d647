"""The four preview tools: images of one mesh, one object, one system, the whole scene."""

from __future__ import annotations

import contextlib
import re
from typing import TYPE_CHECKING, Any

from PIL import Image
from pydantic import Field

from agents.blender.formatting import format_count
from agents.blender.sheets import contact_sheet
from agents.blender.sheets.text_layout import format_length
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from agents.blender.tools.preview_files import new_preview

if TYPE_CHECKING:
    from agents.blender.run_folder import RunFolder

PANEL = 384  # pixels a side
_BACKGROUND: contact_sheet.Colour = (198, 202, 208)
_LAST_FRAME = 1_048_574


class PreviewArguments(Arguments):
    """The arguments of all previews."""

    frame: int | None = Field(
        default=None,
        ge=-_LAST_FRAME,
        le=_LAST_FRAME,
        description="The frame to show; by default the current one. With unbaked simulations, only the current one.",
    )
    timeout: float = Field(
        default=120.0, ge=1, le=3600, description="Seconds after which Blender is stopped."
    )


class SingleMeshArguments(PreviewArguments):
    """The arguments of ``blender_single_mesh_preview``."""

    object: str = Field(min_length=1, max_length=200, description="Name of an object with geometry.")


class ObjectArguments(PreviewArguments):
    """The arguments of ``blender_object_preview``."""

    object: str = Field(
        min_length=1, max_length=200, description='Name of a collection tagged protocol_role="object".'
    )


class LayoutArguments(PreviewArguments):
    """The arguments of previews of several objects."""

    everything: bool = Field(
        default=False,
        description="Also fit grounds, backdrops and distant objects into the views, which otherwise cut them off.",
    )


class SystemLayoutArguments(LayoutArguments):
    """The arguments of ``blender_system_layout_preview``."""

    system: str = Field(
        min_length=1, max_length=200, description='Name of a collection tagged protocol_role="system".'
    )


class SceneLayoutArguments(LayoutArguments):
    """The arguments of ``blender_scene_layout_preview``."""


_ALIKE = """\
The reply is one contact sheet: front, right, top and three-quarter view, each with a scale bar and the world's axes, \
framed on the evaluated geometry at the frame (modifiers, simulations, instances), in the materials' colours. The \
scene is not changed."""


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
    folder = context.blender.folder
    request = {
        "kind": kind,
        "name": name,
        "frame": arguments.frame,
        "everything": isinstance(arguments, LayoutArguments) and arguments.everything,
        "folder": str(folder.workspace),
        "size": PANEL,
    }
    reply = context.blender.call(
        "preview", request, timeout=arguments.timeout, progress=call.progress, cancelled=call.cancelled
    )
    data: dict[str, Any] = reply.value
    size = [high - low for low, high in zip(data["low"], data["high"], strict=True)]
    panels = [_panel(folder, view, size) for view in data["views"]]
    title = re.sub(r"\W+", "-", data["title"]).strip("-")[:40] or "unnamed"
    png = contact_sheet.to_png(_sheet(kind, data, panels))
    image = new_preview(folder, f"{kind}-{title}-frame-{data['frame']}", png)
    for view in data["views"]:
        del view["file"]
    data |= {"file": str(image.path.relative_to(folder.root)), "seconds": round(reply.seconds, 3)}
    return Result(_text(kind, data), data, (image,))


# The sheet


def _panel(folder: RunFolder, view: dict[str, Any], size: list[float]) -> contact_sheet.Panel:
    """The panel of a view; the image that Blender left in the workspace is removed."""
    with folder.open_made(view["file"]) as file:
        picture = contact_sheet.read_png(file, _BACKGROUND)
    with contextlib.suppress(OSError):
        (folder.workspace / view["file"]).unlink()
    picture = picture.resize(tuple(view["size"]), Image.Resampling.LANCZOS)
    if view["ground"] is not None:
        contact_sheet.draw_level(picture, view["ground"], "z = 0")
    if view["metres_per_pixel"]:
        contact_sheet.draw_scale_bar(picture, view["metres_per_pixel"])
    contact_sheet.draw_labels(picture, view["labels"])
    contact_sheet.draw_axes(picture, view["axes"])
    return contact_sheet.Panel(picture, view["name"], view.get("lens") or _across(view["name"], size))


def _across(view: str, size: list[float]) -> str:
    """The extent of the framed geometry along the axes that a view shows without foreshortening."""
    axes = {"front": "XZ", "right": "YZ", "top": "XY"}.get(view, "")
    return " · ".join(f"{letter} {format_length(size['XYZ'.index(letter)])}" for letter in axes)


def _sheet(kind: str, data: dict[str, Any], panels: list[contact_sheet.Panel]) -> Image.Image:
    blocks = [contact_sheet.grid(panels[:4], 2)]
    if len(panels) > 4:
        blocks = [contact_sheet.grid(panels[:3], 3), contact_sheet.grid(panels[3:], 2)]
    return contact_sheet.sheet(
        f"{kind.capitalize()}: {data['title']}",
        blocks,
        subtitle=f"frame {data['frame']} · {_size_of(data)} · {format_count(data['objects'], 'object')}",
        remarks=_cut_away(data),
        notes=data["notes"],
    )


def _size_of(data: dict[str, Any]) -> str:
    edges = (high - low for low, high in zip(data["low"], data["high"], strict=True))
    return " × ".join(format_length(edge) for edge in edges)


def _cut_away(data: dict[str, Any]) -> list[str]:
    """A line on what was cut away in which view; none if nothing was."""
    views = [f"{view['name']}: {', '.join(view['cut_away'])}" for view in data["views"] if view["cut_away"]]
    return [f"Cut away to see inside – {'; '.join(views)}."] if views else []


def _text(kind: str, data: dict[str, Any]) -> str:
    low, high = (", ".join(f"{part:.4g}" for part in data[name]) for name in ("low", "high"))
    lines = [
        f"{data['title']} ({kind}), frame {data['frame']}: {format_count(data['objects'], 'object')}, "
        f"{_size_of(data)} (x × y × z), from ({low}) to ({high}).",
        *_cut_away(data),
        *(f"- {note}" for note in data["notes"]),
        f"Saved as {data['file']}.",
    ]
    return "\n".join(lines)


SINGLE_MESH = BlenderTool(
    "blender_single_mesh_preview",
    "See one mesh",
    f"See one object with geometry (mesh, curve, text, …), alone. {_ALIKE}",
    SingleMeshArguments,
    run_single_mesh,
    read_only=True,
)
OBJECT = BlenderTool(
    "blender_object_preview",
    "See one object with all its meshes",
    f"See one object of the scene protocol (L3), alone, with all its meshes. {_ALIKE}",
    ObjectArguments,
    run_object,
    read_only=True,
)
_ROOMS = "Closed rooms are opened: the part of their shell that faces the viewer is cut away, and named."
SYSTEM_LAYOUT = BlenderTool(
    "blender_system_layout_preview",
    "See how one system is laid out",
    f"See one system of the scene protocol (L2) with all its objects, alone. {_ALIKE} {_ROOMS}",
    SystemLayoutArguments,
    run_system_layout,
    read_only=True,
)
SCENE_LAYOUT = BlenderTool(
    "blender_scene_layout_preview",
    "See how the scene is laid out",
    f"See everything that renders show, and the view of the scene's camera. {_ALIKE} {_ROOMS}",
    SceneLayoutArguments,
    run_scene_layout,
    read_only=True,
)
TOOLS = (SINGLE_MESH, OBJECT, SYSTEM_LAYOUT, SCENE_LAYOUT)
