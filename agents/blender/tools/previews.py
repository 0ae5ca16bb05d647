"""The four previews: pictures of one mesh, one object, one system, the whole scene."""

from __future__ import annotations

import contextlib
import re
from typing import TYPE_CHECKING, Any

from PIL import Image
from pydantic import Field

from agents.blender.sheets import contact_sheet
from agents.blender.sheets.text_layout import format_length
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, SavedImage, ToolContext
from simworlds.files import write_whole

if TYPE_CHECKING:
    from pathlib import Path

    from agents.blender.run_folder import RunFolder

PANEL = 384  # pixels a side
_BACKGROUND: contact_sheet.Colour = (198, 202, 208)
_LAST_FRAME = 1_048_574


class PreviewArguments(Arguments):
    """What all previews take."""

    frame: int | None = Field(
        default=None,
        ge=-_LAST_FRAME,
        le=_LAST_FRAME,
        description="The frame to show; the current one by default. With simulations that are not baked, only that.",
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
    """What the previews of several objects take."""

    everything: bool = Field(
        default=False,
        description="Frame also grounds, backdrops and what lies far away, which otherwise reach out of the pictures.",
    )


class SystemLayoutArguments(LayoutArguments):
    """The arguments of ``blender_system_layout_preview``."""

    system: str = Field(
        min_length=1, max_length=200, description='Name of a collection tagged protocol_role="system".'
    )


class SceneLayoutArguments(LayoutArguments):
    """The arguments of ``blender_scene_layout_preview``."""


_ALIKE = """\
One contact sheet: front, right, top and three-quarter view, each with a scale bar and the world's axes, framed on \
the geometry as evaluated at the frame (modifiers, simulations, instances), in the materials' colours. Nothing in \
the scene changes."""


def run_single_mesh(context: ToolContext, arguments: SingleMeshArguments, call: Call) -> Result:
    """One object with geometry, alone."""
    return _preview(context, "mesh", arguments.object, arguments, call)


def run_object(context: ToolContext, arguments: ObjectArguments, call: Call) -> Result:
    """One L3, alone."""
    return _preview(context, "object", arguments.object, arguments, call)


def run_system_layout(context: ToolContext, arguments: SystemLayoutArguments, call: Call) -> Result:
    """One L2, alone."""
    return _preview(context, "system", arguments.system, arguments, call)


def run_scene_layout(context: ToolContext, arguments: SceneLayoutArguments, call: Call) -> Result:
    """All that renders show."""
    return _preview(context, "scene", None, arguments, call)


def _preview(
    context: ToolContext, kind: str, name: str | None, arguments: PreviewArguments, call: Call
) -> Result:
    folder = context.blender.folder
    given = {
        "kind": kind,
        "name": name,
        "frame": arguments.frame,
        "everything": isinstance(arguments, LayoutArguments) and arguments.everything,
        "folder": str(folder.workspace),
        "size": PANEL,
    }
    reply = context.blender.call(
        "preview", given, timeout=arguments.timeout, progress=call.progress, cancelled=call.cancelled
    )
    data: dict[str, Any] = reply.value
    size = [high - low for low, high in zip(data["low"], data["high"], strict=True)]
    panels = [_panel(folder, view, size) for view in data["views"]]
    png = contact_sheet.to_png(_sheet(kind, data, panels))
    path = _place(folder, kind, data)
    write_whole(path, png, durable=False)
    for view in data["views"]:
        del view["file"]
    data |= {"file": str(path.relative_to(folder.root)), "seconds": round(reply.seconds, 3)}
    return Result(_told(kind, data), data, (SavedImage(png, path),))


# The sheet


def _panel(folder: RunFolder, view: dict[str, Any], size: list[float]) -> contact_sheet.Panel:
    """The panel of a view, from the picture that Blender left in the workspace, which is removed."""
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
    """How far what is framed reaches along the axes that a view shows unshortened."""
    shown = {"front": "XZ", "right": "YZ", "top": "XY"}.get(view, "")
    return " · ".join(f"{letter} {format_length(size['XYZ'.index(letter)])}" for letter in shown)


def _sheet(kind: str, data: dict[str, Any], panels: list[contact_sheet.Panel]) -> Image.Image:
    blocks = [contact_sheet.grid(panels[:4], 2)]
    if len(panels) > 4:
        blocks = [contact_sheet.grid(panels[:3], 3), contact_sheet.grid(panels[3:], 2)]
    return contact_sheet.sheet(
        f"{kind.capitalize()}: {data['title']}",
        blocks,
        subtitle=f"frame {data['frame']} · {_size_of(data)} · {_counted(data['objects'], 'object')}",
        remarks=_cut_away(data),
        notes=data["notes"],
    )


def _size_of(data: dict[str, Any]) -> str:
    edges = (high - low for low, high in zip(data["low"], data["high"], strict=True))
    return " × ".join(format_length(edge) for edge in edges)


def _cut_away(data: dict[str, Any]) -> list[str]:
    """In words, what was taken off in which view; as no or one line."""
    said = [f"{view['name']}: {', '.join(view['cut_away'])}" for view in data["views"] if view["cut_away"]]
    return [f"Cut away to see inside – {'; '.join(said)}."] if said else []


def _counted(count: int, word: str) -> str:
    return f"{count} {word}{'s' * (count != 1)}"


def _told(kind: str, data: dict[str, Any]) -> str:
    low, high = (", ".join(f"{part:.4g}" for part in data[name]) for name in ("low", "high"))
    lines = [
        f"{data['title']} ({kind}), frame {data['frame']}: {_counted(data['objects'], 'object')}, "
        f"{_size_of(data)} (x × y × z), from ({low}) to ({high}).",
        *_cut_away(data),
        *(f"- {note}" for note in data["notes"]),
        f"Saved as {data['file']}.",
    ]
    return "\n".join(lines)


def _place(folder: RunFolder, kind: str, data: dict[str, Any]) -> Path:
    """A fresh path below ``previews``, that tells what it is."""
    previews = folder.root / "previews"
    previews.mkdir(exist_ok=True)
    plain = re.sub(r"\W+", "-", data["title"]).strip("-")[:40] or "unnamed"
    number = 1 + max((int(path.name[:4]) for path in previews.glob("[0-9][0-9][0-9][0-9]-*.png")), default=0)
    return previews / f"{number:04d}-{kind}-{plain}-frame-{data['frame']}.png"


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
_ROOMS = "Closed rooms are opened: what of their shell is towards the viewer is cut away, and named."
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
    f"See all that renders show, and what the scene's camera sees. {_ALIKE} {_ROOMS}",
    SceneLayoutArguments,
    run_scene_layout,
    read_only=True,
)
TOOLS = (SINGLE_MESH, OBJECT, SYSTEM_LAYOUT, SCENE_LAYOUT)
