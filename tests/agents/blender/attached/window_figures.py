"""Measures the attached Blender in a real window, and keeps a picture of it: ``window_figures.py [PICTURE]``.

Run by ``make window-figures``. The window is drawn without a graphics card.
"""

from __future__ import annotations

import os
import statistics
import sys
import tempfile
import time
from base64 import b64decode
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

REPO = Path(__file__).resolve().parents[4]
sys.path[:0] = [str(REPO), str(REPO / "tests"), str(REPO / "tests" / "agents"), str(Path(__file__).parent)]

import anyio  # noqa: E402
from attached_client import server  # noqa: E402
from mcp import Client  # noqa: E402
from mcp_types import ImageContent  # noqa: E402
from open_window import OpenWindow  # noqa: E402
from PIL import Image  # noqa: E402

from agents.blender.attached.attached_blender import AttachedBlender  # noqa: E402
from simworlds.sandbox.replies import unread  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

OBJECTS = 500
CALLS = 20
SCENE = """\
# a table with fruit
import math
def put(name, mesh, place, size, colour):
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    made.location, made.scale = place, size
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*colour, 1)
    mesh.materials.append(material)
    return made
def cube(name):
    bpy.ops.mesh.primitive_cube_add(size=1)
    mesh = bpy.context.object.data
    bpy.data.objects.remove(bpy.context.object)
    mesh.name = name
    return mesh
def ball(name):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1)
    mesh = bpy.context.object.data
    bpy.data.objects.remove(bpy.context.object)
    for face in mesh.polygons:
        face.use_smooth = True
    return mesh
bpy.data.objects["Cube"].hide_set(True)
put("Top", cube("Top"), (0, 0, 1), (2, 1.2, 0.08), (0.45, 0.25, 0.1))
for number, (x, y) in enumerate([(-0.9, -0.5), (0.9, -0.5), (-0.9, 0.5), (0.9, 0.5)]):
    put(f"Leg {number}", cube("Leg"), (x, y, 0.48), (0.1, 0.1, 0.96), (0.4, 0.22, 0.09))
fruit = [(-0.3, 0, (0.8, 0.1, 0.1)), (0.05, 0.2, (0.9, 0.6, 0.1)), (0.35, -0.1, (0.3, 0.6, 0.1))]
for number, (x, y, colour) in enumerate(fruit):
    put(f"Fruit {number}", ball("Fruit"), (x, y, 1.18), (0.14, 0.14, 0.14), colour)
"""
SHOWN = """\
# material colours in the view
for area in bpy.context.window.screen.areas if bpy.context.window else ():
    if area.type == "VIEW_3D":
        area.spaces.active.shading.color_type = "MATERIAL"
"""
MANY = f"""\
# many objects
for number in range({OBJECTS}):
    made = bpy.data.objects.new(f"Many {{number}}", bpy.data.objects["Cube"].data)
    bpy.context.scene.collection.objects.link(made)
    made.location = (number % 25, number // 25, 0)
"""

# 5,000 objects with 20 million triangles, as the user has them.
PRODUCTION = """\
import bpy, numpy
side = 46
x, y = (part.ravel() for part in numpy.meshgrid(numpy.linspace(-1, 1, side), numpy.linspace(-1, 1, side)))
first = (numpy.arange(side - 1)[:, None] * side + numpy.arange(side - 1)).ravel()
faces = numpy.stack([first, first + 1, first + side + 1, first + side], 1).tolist()
meshes = [bpy.data.meshes.new(f"Part {number}") for number in range(100)]
for number, mesh in enumerate(meshes):
    mesh.from_pydata(numpy.stack([x, y, 0.1 * numpy.sin(6 * x)], 1).tolist(), [], faces)
    mesh.uv_layers.new()
    mesh.materials.append(bpy.data.materials.new(f"Paint {number}"))
for number in range(5000):
    if number % 100 == 0:
        row = bpy.data.collections.new(f"Row {number // 100}")
        bpy.context.scene.collection.children.link(row)
    made = bpy.data.objects.new(f"Object {number}", meshes[number % 100])
    made.location = (number % 100 * 2.2, number // 100 * 2.2, 0)
    row.objects.link(made)
"""
LOOKS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("blender_view", {}),
    ("blender_scene_state", {"detail": "summary"}),
    ("blender_scene_state", {}),
    ("blender_scene_state", {"objects": ["Row 7"]}),
    ("blender_single_mesh_preview", {"object": "Object 7"}),
    ("blender_scene_layout_preview", {}),
    ("blender_scene_layout_preview", {"subjects": ["Object 7", "Object 8"]}),
    ("blender_material_preview", {"show": "objects", "objects": ["Object 7"]}),
    ("blender_uv_preview", {"objects": ["Object 7"]}),
    (
        "blender_motion_sheet_preview",
        {"actors": ["Object 7"], "phases": [{"name": "still", "start": 1, "end": 12}]},
    ),
    ("blender_execute", {"code": "bpy.data.objects['Object 7'].location.z = 1"}),
)


async def measure(window: OpenWindow, picture: Path | None) -> None:
    async with Client(server(window), read_timeout_seconds=300) as client:

        async def use(tool: str, **arguments: Any) -> Any:
            result = await client.call_tool(tool, arguments)
            assert not result.is_error, result.content
            return result

        await use("blender_execute", code="1+1")
        await told("code `1+1`, rehearsed and applied", lambda: use("blender_execute", code="1+1"))
        await use("blender_execute", code=SCENE)
        await use("blender_execute", code=SHOWN)
        await use("blender_show", objects=["Top", "Leg 0", "Leg 3"], select=False)
        await use("blender_show", objects=["Fruit 1"], view=False, mark=True)
        if picture is not None:
            window.act("mousemove", "500", "300", "key", "n")
            for place in (("1040", "250"), ("1044", "258")):  # the tab, once it is drawn
                await use("blender_scene_layout_preview")
                window.act("mousemove", *place)
            window.act("click", "1")
            window.act("mousemove", "700", "600")
            await use("blender_scene_layout_preview")
            shot = await use("blender_view", picture="window")
            block = next(block for block in shot.content if isinstance(block, ImageContent))
            image = Image.open(BytesIO(b64decode(block.data))).convert("RGB")
            small = image.resize((image.width * 3 // 4, image.height * 3 // 4), Image.Resampling.LANCZOS)
            small.convert("P", palette=Image.Palette.ADAPTIVE, colors=160).save(picture, optimize=True)
        await told("preview of a small scene", lambda: use("blender_scene_layout_preview"), 3)
        await use("blender_execute", code=MANY)
        await told(f"state of {OBJECTS} objects", lambda: use("blender_scene_state"))
    with_ends(window)
    async with Client(server, read_timeout_seconds=300) as client:
        await looked_at_production(client, window)


async def looked_at_production(client: Client, window: OpenWindow) -> None:
    """How long each look takes in a large scene, and whether it shows all, a part, or says what to narrow."""
    await client.call_tool("blender_execute", {"code": "1+1"})  # the copy's Blender is there
    window.choose(PRODUCTION)
    say(
        "\n| look at 5,000 objects, 20 million triangles | s | slowest | answer |\n| --- | ---: | ---: | --- |"
    )
    for tool, arguments in LOOKS:
        seconds: list[float] = []
        answer = ""
        for _ in range(3):
            started = time.perf_counter()
            result = await client.call_tool(tool, arguments)
            seconds.append(time.perf_counter() - started)
            said = " ".join(getattr(block, "text", "") for block in result.content)
            answer = "narrow it" if result.is_error or "**No picture**" in said else "all"
            answer = "the part that it names" if "nothing else of the scene" in said else answer
        words = ", ".join(f"{name}={value!r}" for name, value in arguments.items() if name != "phases")
        say(f"| `{tool}({words})` | {statistics.median(seconds):.1f} | {max(seconds):.1f} | {answer} |")


async def told(what: str, call: Callable[[], Awaitable[Any]], count: int = CALLS) -> None:
    seconds: list[float] = []
    for _ in range(count):
        started = time.perf_counter()
        await call()
        seconds.append(time.perf_counter() - started)
    say(f"| {what} | {1000 * statistics.median(seconds):.0f} | {1000 * max(seconds):.0f} |")


def with_ends(window: OpenWindow) -> None:
    """For how long single calls hold the window up."""
    os.environ["SIMWORLDS_HOME"] = str(window.home)
    blender = AttachedBlender("open", "figures", lambda _about: "", lambda _line: None)
    state = {
        "detail": "normal",
        "objects": None,
        "sections": ["collections", "objects", "physics", "animation", "view"],
    }
    for what, tool, arguments in (
        (
            "window held up by a copy, as each rendered look needs",
            "write_copy",
            {"path": str(window.root / "c.blend"), "seconds": 5},
        ),
        (f"window held up by the state of {OBJECTS} objects", "scene_state", state),
        (
            "window held up by a screenshot",
            "screenshot",
            {"path": str(window.root / "c.png"), "editor": "VIEW_3D"},
        ),
    ):
        held = [blender.call(tool, dict(arguments), unread, timeout=60).seconds for _ in range(CALLS)]
        say(f"| {what} | {1000 * statistics.median(held):.0f} | {1000 * max(held):.0f} |")
    blender.close()


def say(line: str) -> None:
    sys.stdout.write(f"{line}\n")


def main(words: list[str]) -> None:
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        window = OpenWindow(Path(folder))
        try:
            say("| what | p50 ms | slowest |\n| --- | ---: | ---: |")
            anyio.run(measure, window, Path(words[0]) if words else None)
        finally:
            window.close()


if __name__ == "__main__":
    main(sys.argv[1:])
