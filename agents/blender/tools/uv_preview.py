"""``blender_uv_preview``: UV maps, as a checker on the meshes, as pictures of the maps, and in numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from PIL import Image
from pydantic import Field

from agents.blender.sheets import contact_sheet
from agents.blender.sheets.view_reply import UvMesh, UvReply
from agents.blender.sheets.worker_pictures import taken_picture
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from agents.blender.tools.preview_files import new_preview
from simworlds.counting import counted, format_list

if TYPE_CHECKING:
    from agents.blender.supervisor import Supervisor

_PANEL = 288  # pixels a side
_BACKGROUND: contact_sheet.Colour = (198, 202, 208)
_NAMED = 8
_MOST_OBJECTS = 40


class UvArguments(Arguments):
    """The arguments of ``blender_uv_preview``."""

    objects: list[Annotated[str, Field(min_length=1, max_length=200)]] = Field(
        default_factory=list[str],
        max_length=_MOST_OBJECTS,
        description="Meshes or collections. Default: all.",
    )
    timeout: float = Field(default=120.0, ge=1, le=3600, description="Seconds.")


DESCRIPTION = """\
See the UV maps of up to eight meshes: a checker on each, and the map (stretched yellow, overlapping red), with \
bounds, scale, and shares stretched, collapsed, mirrored, outside, overlapping."""


def run(context: ToolContext, arguments: UvArguments, call: Call) -> Result:
    """Draws and measures. Raises BlenderError."""
    blender, folder = context.blender, context.blender.folder
    request = {"objects": arguments.objects, "folder": folder.workspace.for_blender(), "size": _PANEL}
    reply = blender.call(
        "uv_sheet",
        request,
        UvReply.model_validate,
        timeout=arguments.timeout,
        progress=call.progress,
        cancelled=call.cancelled,
    )
    shown = reply.value
    data = shown.model_dump(exclude={"meshes": {"__all__": {"checker", "map"}}}, exclude_none=True)
    images = ()
    if shown.meshes:
        images = (new_preview(folder, "uv", contact_sheet.to_png(_sheet(blender, shown))),)
        data["file"] = str(images[0].path.relative_to(folder.root))
    return Result(_text(shown), data, images)


def _sheet(blender: Supervisor, shown: UvReply) -> Image.Image:
    panels: list[contact_sheet.Panel] = []
    for mesh in shown.meshes:
        checker = taken_picture(blender, mesh.checker, _BACKGROUND).resize(
            (_PANEL, _PANEL), Image.Resampling.LANCZOS
        )
        panels.append(contact_sheet.Panel(checker, mesh.name, f"map {mesh.uv_map!r}"))
        drawn = Image.new("RGB", (_PANEL, _PANEL), contact_sheet.PAPER)
        if mesh.map is not None:
            drawn = taken_picture(blender, mesh.map).resize((_PANEL, _PANEL), Image.Resampling.NEAREST)
        panels.append(contact_sheet.Panel(drawn, "", _bounds(mesh) if mesh.map is not None else "not drawn"))
    return contact_sheet.sheet(
        "UV maps",
        [contact_sheet.grid(panels, min(4, len(panels)))],
        subtitle="checker and map; yellow: stretched, red: overlapping, outline: the tile from 0 to 1",
        notes=shown.notes,
    )


def _bounds(mesh: UvMesh) -> str:
    (left, bottom), (right, top) = mesh.low, mesh.high
    return f"u {left:.2g}…{right:.2g}, v {bottom:.2g}…{top:.2g}"


def _text(shown: UvReply) -> str:
    lines = [_line(mesh) for mesh in shown.meshes] or ["No mesh has a UV map."]
    if shown.without:
        lines.append(f"- Without a UV map: {format_list(shown.without, _NAMED)}.")
    return "\n".join([*lines, *(f"- {note}" for note in shown.notes)])


def _line(mesh: UvMesh) -> str:
    also = f" (also {format_list(mesh.alike, _NAMED, mesh.alike_in_all)})" if mesh.alike else ""
    head = f"- {mesh.name}{also}, {counted(mesh.faces, 'face')}"
    if mesh.missing:
        return f"{head}: **its map has no usable coordinates**"
    low, high = mesh.scale
    parts = [f"map {mesh.uv_map!r}", _bounds(mesh), f"{low:.3g} to {high:.3g} tiles per metre"]
    shares = {
        "stretched": mesh.stretched,
        "collapsed": mesh.collapsed,
        "mirrored": mesh.mirrored,
        "outside the tile": mesh.outside,
        "of the map overlapping": mesh.overlap or 0.0,
    }
    parts += [f"{100 * share:.0f} % {name}" for name, share in shares.items() if share >= 0.005]
    if mesh.overlap is None:
        parts.append("overlap not measured: too many faces")
    return f"{head}: {', '.join(parts)}"


TOOL = BlenderTool(
    "blender_uv_preview",
    "See UV maps",
    DESCRIPTION,
    UvArguments,
    run,
    read_only=True,
    shows_scene=True,
    profile="look",
    habit="to see UV maps: a checker, bounds, stretch, overlap",
)
