"""``blender_material_preview``: lit stills of the scene and its objects, in their own materials."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from PIL import Image
from pydantic import Field
from pydantic.json_schema import SkipJsonSchema

from agents.blender.render.kept_pictures import KeptPictures
from agents.blender.sheets import contact_sheet
from agents.blender.sheets.view_reply import LitObject, LitPatch, MaterialReply
from agents.blender.sheets.worker_pictures import taken_picture
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, SavedImage, ToolContext
from agents.blender.tools.preview_files import FOLDER, new_preview
from simworlds.counting import counted, format_list
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.replies import Frame

if TYPE_CHECKING:
    from agents.blender.sheets.view_reply import LitView
    from agents.blender.supervisor import Supervisor

_PANEL, _LEAST_PANEL, _COLUMNS = 272, 64, 4  # pixels a side of an object's still
_BACKGROUND: contact_sheet.Colour = (206, 209, 214)
_MOST_OBJECTS, _MOST_FIRST, _MOST_FRAMES = 12, 200, 4
_NAMED = 6
_Name = Annotated[str, Field(min_length=1, max_length=200)]


class MaterialArguments(Arguments):
    """The arguments of ``blender_material_preview``."""

    show: Literal["all", "scene", "objects"] = Field(default="all", description="all: both.")
    objects: list[_Name] = Field(
        default_factory=list[_Name],
        max_length=_MOST_OBJECTS,
        description="Default: all.",
    )
    first: list[str] = Field(
        default_factory=list[str],
        max_length=_MOST_FIRST,
        description="Of all objects, these first.",
    )
    # Not for models, which name the objects: of all, only those that ``first`` names and that are not ``old``.
    only_first: SkipJsonSchema[bool] = False
    old: SkipJsonSchema[list[str] | None] = Field(default=None, max_length=5_000)
    frames: list[Frame] = Field(
        default_factory=list[Frame],
        max_length=_MOST_FRAMES,
        description="Of the scene; objects: at the first.",
    )
    width: int | SkipJsonSchema[None] = Field(default=None, ge=64, le=1536, description="Pixels.")
    seconds: float = Field(
        default=150.0,
        ge=1,
        le=3600,
        description="Then no still is begun.",
    )
    timeout: float = Field(default=400.0, ge=1, le=3600, description="Seconds.")


DESCRIPTION = """\
See materials as they render (Cycles, the file's shaders and textures) in neutral light, without lamps. \
Shows the scene through its camera, or in three-quarter view, and each object alone: up to a minute a picture."""


def run(context: ToolContext, arguments: MaterialArguments, call: Call) -> Result:
    """Renders the stills, and puts those of objects on a sheet. Raises BlenderError."""
    blender, folder = context.blender, context.blender.folder
    kept = KeptPictures(folder.root / FOLDER / "materials")
    request = {
        "show": arguments.show,
        "objects": arguments.objects,
        "first": arguments.first,
        "only_first": arguments.only_first,
        "old": arguments.old,
        "frames": list(dict.fromkeys(arguments.frames)),
        "folder": folder.workspace.for_blender(),
        "size": [arguments.width, _panel(arguments)],
        "seconds": arguments.seconds,
        "kept": kept.keys,
    }
    reply = blender.call(
        "material_sheet",
        request,
        MaterialReply.model_validate,
        timeout=arguments.timeout,
        progress=call.progress,
        cancelled=call.cancelled,
    )
    shown = reply.value
    images = [_scene_picture(blender, kept, view) for view in shown.scene]
    if shown.objects:
        sheet = _sheet(blender, kept, shown)
        images.append(new_preview(folder, "materials-objects", contact_sheet.to_png(sheet)))
    data = shown.model_dump(include={"title": True, "notes": True})
    data["objects"] = [
        one.model_dump(include={"name", "materials", "alike", "bare"}) for one in shown.objects
    ]
    data["frames"] = [view.frame for view in shown.scene]
    data["files"] = [str(image.path.relative_to(folder.root)) for image in images]
    data["patches"] = [patch.name for patch in shown.patches]
    stills = (*shown.scene, *shown.objects, *shown.patches)
    data["kept"] = sum(still.file is None for still in stills)
    data["rendered"] = len(stills) - data["kept"]
    data["seconds"] = round(reply.seconds, 2)
    return Result(_text(shown, data), data, tuple(images))


def _panel(arguments: MaterialArguments) -> int:
    """Pixels a side of an object's still. Where only objects are shown, they share the width that was asked for."""
    if arguments.width is None or arguments.show != "objects":
        return _PANEL
    columns = min(_COLUMNS, len(arguments.objects) or _COLUMNS)
    return max(_LEAST_PANEL, arguments.width // columns)


def _picture(blender: Supervisor, kept: KeptPictures, still: LitView | LitObject | LitPatch) -> Image.Image:
    """The picture of a still that was rendered now, or kept as it would be."""
    if still.file is not None:
        picture = taken_picture(blender, still.file, _BACKGROUND)
        if still.key is not None:
            kept.keep(still.key, picture)
        return picture
    if still.key is None:
        raise Refusal(f"Blender has made no picture of {still.name}.")
    return kept.get(still.key)


def _scene_picture(blender: Supervisor, kept: KeptPictures, view: LitView) -> SavedImage:
    picture = _picture(blender, kept, view).resize(view.size, Image.Resampling.LANCZOS)
    return new_preview(blender.folder, f"materials-frame-{view.frame}", contact_sheet.to_png(picture))


def _sheet(blender: Supervisor, kept: KeptPictures, shown: MaterialReply) -> Image.Image:
    panels: list[contact_sheet.Panel] = []
    for one in shown.objects:
        picture = _picture(blender, kept, one)
        contact_sheet.draw_scale_bar(picture, one.metres_per_pixel)
        panels.append(contact_sheet.Panel(picture, one.name, format_list(one.materials, 2) or "no material"))
    for patch in shown.patches:
        picture = _picture(blender, kept, patch)
        contact_sheet.draw_scale_bar(picture, patch.metres_per_pixel)
        panels.append(contact_sheet.Panel(picture, patch.name, "close up"))
    return contact_sheet.sheet(
        "Materials",
        [contact_sheet.grid(panels, min(_COLUMNS, len(panels)))],
        subtitle="each object alone, in neutral light",
        remarks=[
            f"As {one.name}: {format_list(one.alike, _NAMED, one.alike_in_all)}."
            for one in shown.objects
            if one.alike
        ],
        notes=shown.notes,
    )


def _text(shown: MaterialReply, data: dict[str, Any]) -> str:
    files = data["files"]
    lines = ["In neutral light, not the scene's:"] if files else ["Nothing is shown:"]
    lines += [f"- frame {view.frame}, {_seen_by(view)}" for view in shown.scene]
    lines += [_line(one) for one in shown.objects]
    lines += [f"- close up: {', '.join(patch.name for patch in shown.patches)}"] if shown.patches else []
    lines += [f"- {note}" for note in shown.notes]
    lines += (
        [f"Rendered: {counted(data['rendered'], 'still')} in {data['seconds']:.0f} s."]
        if data["rendered"]
        else []
    )
    lines += (
        [f"Shown as before, since nothing has changed: {counted(data['kept'], 'still')}."]
        if data["kept"]
        else []
    )
    lines += [f"Saved as {format_list(files, len(files))}."] if files else []
    return "\n".join(lines)


def _seen_by(view: LitView) -> str:
    cut = f"; cut away to see inside: {format_list(view.cut_away, _NAMED)}" if view.cut_away else ""
    return f"{view.name}{cut}"


def _line(one: LitObject) -> str:
    parts = [f"- {one.name}: {format_list(one.materials, _NAMED) or 'no material'}"]
    if one.bare and one.materials:
        parts.append(f"**without a material**: {format_list(one.bare, _NAMED)}")
    if one.alike:
        parts.append(f"the same on {format_list(one.alike, _NAMED, one.alike_in_all)}")
    return "; ".join(parts)


TOOL = BlenderTool(
    "blender_material_preview",
    "See materials",
    DESCRIPTION,
    MaterialArguments,
    run,
    read_only=True,
    shows_scene=True,
    profile="look",
    habit="to see materials as they render, in neutral light, before the scene has any",
)
