"""The package blender-mcp itself as the client: its tools work without a window."""

from __future__ import annotations

from base64 import b64decode
from io import BytesIO
from typing import TYPE_CHECKING, Any

import pytest
from addon_server import AddonServer
from mcp import Client, StdioServerParameters
from mcp_types import ImageContent
from PIL import Image
from places import REPO
from serving import environment

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Iterator
    from pathlib import Path

    from mcp_types import CallToolResult

PACKAGE = REPO / ".tools" / "blender-mcp" / "bin" / "blender-mcp"

pytestmark = [
    pytest.mark.blender,
    pytest.mark.anyio,
    pytest.mark.skipif(not PACKAGE.exists(), reason="the package blender-mcp is not here: make blender-mcp"),
]

SCENE = """
import bpy
bpy.ops.mesh.primitive_monkey_add(location=(0, 0, 1))
bpy.ops.mesh.primitive_plane_add(size=6)
bpy.ops.object.camera_add(location=(0, -9, 3), rotation=(1.3, 0, 0))
bpy.context.scene.camera = bpy.context.object
print(len(bpy.data.objects))
"""


@pytest.fixture(scope="module")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[AddonServer]:
    with AddonServer(tmp_path_factory.mktemp("home")) as started:
        yield started


@pytest.fixture(scope="module")
async def client(server: AddonServer, tmp_path_factory: pytest.TempPathFactory) -> AsyncIterator[Client]:
    home: Path = tmp_path_factory.mktemp("client")
    folders = {name: str(home) for name in ("HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME")}
    more = {
        "TMPDIR": str(server.temporary),
        "DISABLE_TELEMETRY": "true",
        "PYTHONPATH": "",
        "PYTHONWARNINGS": "",
    }
    env = {**environment(home), **folders, **more, "BLENDER_PORT": str(server.port)}
    async with Client(StdioServerParameters(command=str(PACKAGE), args=[], env=env)) as connected:
        built = await connected.call_tool("execute_blender_code", {"code": SCENE})
        assert said(built) == "Code executed successfully: 3\n"
        yield connected


def said(answer: CallToolResult) -> str:
    return "\n".join(part.text for part in answer.content if part.type == "text")


def picture(answer: CallToolResult) -> Image.Image:
    """The one picture of an answer, which shows something."""
    assert not answer.is_error, said(answer)
    (content,) = [part for part in answer.content if isinstance(part, ImageContent)]
    image = Image.open(BytesIO(b64decode(content.data)))
    assert len(image.convert("L").getcolors() or ()) > 8
    return image


async def test_it_finds_an_add_on_that_is_up_to_date(client: Client) -> None:
    told = said(await client.call_tool("get_addon_status", {}))
    assert '"up_to_date": true' in told
    assert '"polyhaven": "off"' in told
    assert '"telemetry_consent": false' in told


async def test_it_reads_the_scene(client: Client) -> None:
    told = said(await client.call_tool("get_scene_info", {"fields": ["location", "ground", "settings"]}))
    assert "1 camera, 2 mesh" in told
    assert "Suzanne | mesh | at (0.0, 0.0, 1.0)" in told
    resource = (await client.read_resource("blender://object/Suzanne")).contents[0]
    assert '"polygons": 500' in resource.text  # pyright: ignore[reportAttributeAccessIssue]


@pytest.mark.parametrize(
    ("arguments", "caption"),
    [
        ({"max_size": 320}, ""),
        ({"mode": "angles", "target": ["Suzanne"]}, "front, right, top, three_quarter"),
        ({"mode": "camera", "shading": "wireframe"}, "Through camera 'Camera'"),
    ],
)
async def test_it_sees_the_scene(client: Client, arguments: dict[str, Any], caption: str) -> None:
    answer = await client.call_tool("look", arguments)
    picture(answer)
    assert caption in said(answer)
    assert "isn't available" not in said(answer)


async def test_it_sees_what_code_rendered(client: Client, server: AddonServer) -> None:
    path = server.temporary / "still.png"
    code = (
        "s = bpy.context.scene\ns.render.engine = 'BLENDER_WORKBENCH'\ns.render.resolution_percentage = 10\n"
        f"s.render.filepath = {str(path)!r}\nbpy.ops.render.render(write_still=True)"
    )
    assert said(await client.call_tool("execute_blender_code", {"code": code})).startswith("Code executed")
    with Image.open(path) as image:
        assert image.size == (192, 108)
    assert picture(await client.call_tool("look", {"image": "Render Result"})).size == (192, 108)


async def test_it_is_told_of_errors_and_crashes_and_goes_on(client: Client) -> None:
    failed = said(await client.call_tool("execute_blender_code", {"code": "bpy.data.objects['none']"}))
    assert "KeyError" in failed
    crashed = said(await client.call_tool("execute_blender_code", {"code": "import os; os.abort()"}))
    assert "crashed (SIGABRT)" in crashed
    assert "the scene as it was before" in crashed
    assert "1 camera, 2 mesh" in said(await client.call_tool("get_scene_info", {}))
    off = said(await client.call_tool("search_assets", {"source": "polyhaven", "query": "chair"}))
    assert "Poly Haven is off" in off
