"""``blender_check``, and the pre-flight of ``blender_execute``, over MCP as a client meets them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from mcp import Client
from serving import over_stdio

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from pathlib import Path

    from mcp_types import CallToolResult

pytestmark = [pytest.mark.blender, pytest.mark.anyio]


@pytest.fixture(scope="module")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def home(base: Path) -> Path:
    return base.parent.parent


@pytest.fixture(scope="module")
async def client(home: Path) -> AsyncIterator[Client]:
    async with Client(over_stdio(home)) as connected:
        yield connected


async def run(client: Client, code: str, **more: Any) -> CallToolResult:
    return await client.call_tool("blender_execute", {"code": code, **more})


def said(answer: CallToolResult) -> str:
    assert answer.content[0].type == "text"
    return answer.content[0].text


async def test_the_live_server_checks_scripts_that_it_does_not_run(client: Client) -> None:
    answer = await client.call_tool("blender_check", {"code": "bpy.context.object.draw_type = 'WIRE'"})
    assert not answer.is_error
    assert "fix: `bpy.context.object.display_type = 'WIRE'`" in said(answer)


async def test_code_that_is_sure_to_fail_changes_nothing(client: Client) -> None:
    before = (await run(client, "len(bpy.data.objects)")).structured_content
    answer = await run(client, "bpy.ops.mesh.primitive_cube_add()\nbpy.context.object.draw_type = 'WIRE'")
    assert answer.is_error
    assert "Nothing was executed" in said(answer)
    assert "display_type" in said(answer)
    after = (await run(client, "len(bpy.data.objects)")).structured_content
    assert before is not None
    assert after is not None
    assert before["value"] == after["value"]


async def test_what_an_earlier_call_registered_is_known(client: Client) -> None:
    assert (await run(client, "bpy.context.scene.my_own = 1")).is_error
    await run(client, "bpy.types.Scene.my_own = bpy.props.IntProperty()")
    answer = await run(client, "bpy.context.scene.my_own = 7\nbpy.context.scene.my_own")
    assert answer.structured_content is not None
    assert answer.structured_content["value"] == "7"


async def test_the_check_can_be_left_out(client: Client) -> None:
    answer = await run(client, "bpy.context.scene.nonsense", preflight="off")
    assert "AttributeError" in said(answer)
    refused = await run(client, "1", preflight="maybe")
    assert refused.is_error
    assert "preflight" in said(refused)


@pytest.mark.parametrize(
    "code",
    [
        "print 'bpy'",
        "bpy\0",
        "bpy" + "(" * 5_000,
        "bpy" + ".a" * 40_000,
        "# bpy\n" * 60_000,
        "bpy.🙂",
        "\ufeffbpy",
    ],
    ids=lambda text: ascii(text)[:20],
)
async def test_any_code_is_answered_by_blender_itself(client: Client, code: str) -> None:
    answer = await run(client, code)
    assert "Nothing was executed" not in said(answer)
    assert answer.structured_content is not None
    assert "seconds" in answer.structured_content


async def test_code_that_is_too_long_is_refused_in_words(client: Client) -> None:
    for tool in ("blender_execute", "blender_check"):
        answer = await client.call_tool(tool, {"code": "#" * 10_000_000})
        assert answer.is_error
        assert len(said(answer)) < 1000
