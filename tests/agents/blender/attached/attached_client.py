"""A client of a server that is attached to an open window, and what tests ask of it again and again."""

from __future__ import annotations

from base64 import b64decode
from io import BytesIO
from typing import TYPE_CHECKING, Any, Protocol

from mcp import Client, StdioServerParameters
from mcp_types import ImageContent, TextContent
from PIL import Image
from places import REPO
from processes import becomes

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from mcp_types import CallToolResult

BUILD = """\
# add {name}
mesh = bpy.data.meshes.new("{name}")
mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
made = bpy.data.objects.new("{name}", mesh)
bpy.context.scene.collection.objects.link(made)
made.location = ({x}, 0, 0)
"""


class OpenBlender(Protocol):
    """A Blender that the extension listens in."""

    @property
    def command(self) -> Sequence[str]:
        """The command of a server that attaches to it."""
        ...

    @property
    def environment(self) -> Mapping[str, str]:
        """What it runs in."""
        ...


def server(blender: OpenBlender) -> StdioServerParameters:
    program, *words = blender.command
    environment = {**blender.environment, "PYTHONPATH": str(REPO), "PYTHONWARNINGS": "error"}
    return StdioServerParameters(command=program, args=words, env=environment, cwd=REPO)


async def use(client: Client, tool: str, /, **arguments: Any) -> CallToolResult:
    return await client.call_tool(tool, arguments)


def text(result: CallToolResult) -> str:
    return " ".join(block.text for block in result.content if isinstance(block, TextContent))


def picture(result: CallToolResult) -> Image.Image:
    block = next(block for block in result.content if isinstance(block, ImageContent))
    return Image.open(BytesIO(b64decode(block.data)))


async def build(client: Client, name: str, x: int = 0) -> CallToolResult:
    result = await use(client, "blender_execute", code=BUILD.format(name=name, x=x))
    assert not result.is_error, text(result)
    return result


async def state(client: Client) -> dict[str, Any]:
    result = await use(client, "blender_view", picture="none")
    assert not result.is_error, text(result)
    assert result.structured_content is not None
    return result.structured_content


async def digests(client: Client) -> dict[str, str]:
    """Digests of everything in the file."""
    result = await use(client, "blender_scene_state", sections=["data_blocks"])
    assert result.structured_content is not None
    return result.structured_content["data_blocks"]


def listens(process: subprocess.Popen[bytes], home: Path, log: Path, seconds: float) -> None:
    """Waits until a Blender has said where it listens; fails with the end of its log if it does not."""
    file = home / "open-blenders" / f"{process.pid}.json"
    becomes(lambda: file.exists() or process.poll() is not None, seconds)
    assert file.exists(), log.read_text()[-2000:]


async def build_and_undo(client: Client) -> dict[str, Any]:
    """Builds two things and groups them, then undoes all three steps; what undo replied."""
    before = await digests(client)
    first = await build(client, "One")
    assert "a copy was kept" in text(first)
    await build(client, "Two", 3)
    groups = [{"object": "pair", "system": "things", "members": ["One", "Two"]}]
    grouped = await use(client, "blender_group", groups=groups)
    assert not grouped.is_error, text(grouped)
    assert {"Object One", "Object Two", "Object pair root"} <= (await digests(client)).keys()
    undone = await use(client, "blender_undo", steps=3)
    assert undone.structured_content is not None, text(undone)
    assert undone.structured_content["matches"] is True
    assert await digests(client) == before
    return undone.structured_content


async def never_arrives(client: Client, code: str, said: str) -> None:
    """Checks that code is refused with what was ``said``, and that the open Blender's file stays as it is."""
    before = await digests(client)
    seconds = 1 if code.startswith("while True") else 5  # all of them pass
    result = await use(client, "blender_execute", code=code, timeout=seconds)
    assert result.is_error
    assert said in text(result)
    assert "Nothing was done in the open Blender" in text(result)
    assert await digests(client) == before
