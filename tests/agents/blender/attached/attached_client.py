"""A client of a server that is attached to an open window, and what tests ask of it again and again."""

from __future__ import annotations

from base64 import b64decode
from io import BytesIO
from typing import TYPE_CHECKING, Any, Protocol

from mcp import Client, StdioServerParameters
from mcp_types import ImageContent, TextContent
from PIL import Image
from places import REPO

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

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
        """The command of a server that attaches to it …"""
        ...

    @property
    def server_environment(self) -> Mapping[str, str]:
        """… and its environment."""
        ...


def server(blender: OpenBlender) -> StdioServerParameters:
    program, *words = blender.command
    return StdioServerParameters(command=program, args=words, env=dict(blender.server_environment), cwd=REPO)


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
