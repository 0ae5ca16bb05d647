"""The commands of blender-mcp's add-on that work in Blender, each as a tool of a session."""

from __future__ import annotations

import json
import re
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Literal

from PIL import Image
from pydantic import Field

from agents.blender.drop_in.delivery import Delivery
from agents.blender.sheets.contact_sheet import draw_axes, paragraph, to_png
from agents.blender.sheets.view_reply import DrawnView
from agents.blender.sheets.worker_pictures import taken_picture
from agents.blender.tools import execute
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from simworlds.sandbox.errors import Refusal, TookTooLong
from simworlds.sandbox.replies import Claim, Count, Name, nothing

if TYPE_CHECKING:
    from collections.abc import Callable

    from agents.blender.drop_in.screenshot_places import ScreenshotPlaces

_SECONDS = 60.0
_LISTED = 10  # objects in get_scene_info
_SIDES = (64, 2000)  # pixels of a screenshot
_MOST_NAMES = 40_000
_LONGEST_PRINT = 1_100_000
_BACKGROUND = (61, 61, 61)
_DRAWS = re.compile(r"\bgpu\b")

_Number = float | None
"""None stands for what is not finite."""
_Vector = tuple[_Number, _Number, _Number]


class _NoArguments(Arguments):
    pass


class _OfObject(Arguments):
    name: str = Field(max_length=1000)


class _OfSearch(Arguments):
    query: str = Field(default="", max_length=1000)
    limit: int = Field(default=30, ge=1, le=1000)


class _OfScreenshot(Arguments):
    filepath: str = Field(min_length=1, max_length=4000)
    max_size: int = 800
    format: Literal["png", "PNG"] = "png"


class _OfCode(Arguments):
    code: str = Field(max_length=execute.LONGEST_CODE)


class _CapturedOutcome(execute.Outcome):
    printed: str = Field(max_length=_LONGEST_PRINT)


class _ListedObject(Claim):
    name: Name
    type: Name
    location: _Vector


class _SceneSummary(Claim):
    name: Name
    object_count: Count
    objects: list[_ListedObject] = Field(max_length=_LISTED)
    materials_count: Count


class _ObjectSummary(_ListedObject):
    rotation: _Vector
    scale: _Vector
    visible: bool
    materials: list[Name] = Field(max_length=_MOST_NAMES)
    box: tuple[_Vector, _Vector] | None
    mesh: tuple[Count, Count, Count] | None


class _NamedItem(Claim):
    kind: Literal["object", "material", "collection"]
    name: Name
    detail: Name


class _NamedItems(Claim):
    items: list[_NamedItem] = Field(max_length=1000)
    total: Count


def tools(seconds: float, places: ScreenshotPlaces) -> dict[str, BlenderTool]:
    """The tools by their commands. Code may run for ``seconds``; screenshots are written to ``places``."""
    delivery = Delivery(places)

    def run_code(context: ToolContext, arguments: _OfCode, call: Call) -> Result:
        return _run_code(context, arguments.code, seconds, call, delivery)

    def take_screenshot(context: ToolContext, arguments: _OfScreenshot, call: Call) -> Result:
        return _take_screenshot(context, arguments, call, places)

    return {
        "get_scene_info": _tool("get_scene_info", _NoArguments, _scene_info),
        "get_object_info": _tool("get_object_info", _OfObject, _object_info),
        "list_scene_items": _tool("list_scene_items", _OfSearch, _list_items),
        "get_viewport_screenshot": _tool("get_viewport_screenshot", _OfScreenshot, take_screenshot),
        "execute_code": _tool("execute_code", _OfCode, run_code),
    }


def _tool(
    name: str, arguments: type[Arguments], run: Callable[[ToolContext, Any, Call], Result]
) -> BlenderTool:
    return BlenderTool(name, name, "", arguments, run)


def _scene_info(context: ToolContext, _arguments: _NoArguments, call: Call) -> Result:
    read = _SceneSummary.model_validate
    reply = context.blender.call(
        "scene_summary", {"most": _LISTED}, read, timeout=_SECONDS, cancelled=call.cancelled
    )
    return Result("", reply.value.model_dump())


def _object_info(context: ToolContext, arguments: _OfObject, call: Call) -> Result:
    read = _ObjectSummary.model_validate
    summary = context.blender.call(
        "object_summary", {"name": arguments.name}, read, timeout=_SECONDS, cancelled=call.cancelled
    ).value
    data = summary.model_dump(exclude={"box", "mesh"})
    if summary.box is not None:
        data["world_bounding_box"] = summary.box
    if summary.mesh is not None:
        data["mesh"] = dict(zip(("vertices", "edges", "polygons"), summary.mesh, strict=True))
    return Result("", data)


def _list_items(context: ToolContext, arguments: _OfSearch, call: Call) -> Result:
    read = _NamedItems.model_validate
    reply = context.blender.call(
        "named_items", arguments.model_dump(), read, timeout=_SECONDS, cancelled=call.cancelled
    )
    return Result("", reply.value.model_dump())


def _run_code(context: ToolContext, code: str, seconds: float, call: Call, delivery: Delivery) -> Result:
    """Runs code unchecked, as the add-on does. Raises Refusal with the exception of the code, as JSON."""
    folder = context.blender.folder
    if _DRAWS.search(code):
        _make_drawable(context, call)
    title = execute.title_of(code)
    request = {"code": delivery.exchanged(code, folder), "targets": delivery.targets}
    try:
        outcome = context.blender.call(
            "execute_captured",
            request,
            _CapturedOutcome.model_validate,
            timeout=seconds,
            what=f"the code {title!r}",
            changes=True,
            after=f"after {title!r}",
            cancelled=call.cancelled,
        ).value
    except TookTooLong as error:
        hint = "Start the server with a longer --timeout if it is to run longer."
        raise TookTooLong(f"{error} {hint}", error.printed, error.ending) from error
    printed = delivery.restored("\n".join([outcome.printed, *delivery.deliver(folder)]))
    if (error := outcome.error) is not None:
        told = {
            "exception_type": error.type,
            "message": delivery.restored(error.message),
            "traceback": delivery.restored(error.traceback),
        }
        raise Refusal(json.dumps(told | ({"printed": printed} if printed else {})))
    return Result("", {"executed": True, "result": printed})


def _make_drawable(context: ToolContext, call: Call) -> None:
    """Lets code draw with the module ``gpu``, as a Blender with a window does, where this machine can."""
    folder = context.blender.folder.workspace.for_blender()
    with suppress(Refusal):
        context.blender.call(
            "make_drawable", {"folder": folder}, nothing, timeout=_SECONDS, cancelled=call.cancelled
        )


def _take_screenshot(
    context: ToolContext, arguments: _OfScreenshot, call: Call, places: ScreenshotPlaces
) -> Result:
    """Draws the scene, and writes the picture to the path that the client gave. Raises Refusal."""
    places.check(arguments.filepath)
    side = min(max(arguments.max_size, _SIDES[0]), _SIDES[1])
    try:
        picture = _draw(context, side, call)
    except Refusal as error:  # a viewport shows an empty scene, too
        picture = Image.new("RGB", (side, side), _BACKGROUND)
        picture.paste(paragraph(str(error), side - 16), (8, 8))
    places.write(arguments.filepath, to_png(picture))
    data = {
        "success": True,
        "width": picture.width,
        "height": picture.height,
        "filepath": arguments.filepath,
        "method": "render",
    }
    return Result("", data)


def _draw(context: ToolContext, side: int, call: Call) -> Image.Image:
    blender = context.blender
    request = {"folder": blender.folder.workspace.for_blender(), "size": side}
    view = blender.call(
        "viewport", request, DrawnView.model_validate, timeout=2 * _SECONDS, cancelled=call.cancelled
    ).value
    picture = taken_picture(blender, view.file, _BACKGROUND).resize(view.size, Image.Resampling.LANCZOS)
    draw_axes(picture, view.axes)
    return picture
