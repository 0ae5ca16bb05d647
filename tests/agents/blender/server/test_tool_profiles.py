"""Which tools a client of ``simworlds mcp`` is offered, how little it is sent, and that nothing is lost by that."""

from __future__ import annotations

import json
from contextlib import AsyncExitStack
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest
from jsonschema import Draft202012Validator
from mcp import Client
from mcp.shared.exceptions import MCPError
from mcp_types import TextContent, TextResourceContents, Tool
from serving import ByHand, blenders, over_stdio
from shared_docs import share_docs
from small_plan import small_plan

from agents.blender.blender_sessions import BlenderSessions, SessionSetup
from agents.blender.docs_client import DocsClient
from agents.blender.server import make_server
from agents.blender.team import Team
from agents.blender.tool_catalogue import TOOLS
from agents.blender.tool_profiles import DEFAULT, PROFILES
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.schemas.json_schema import lean_arguments

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from pathlib import Path

pytestmark = [pytest.mark.blender, pytest.mark.anyio]

MOST_SENT = {"docs": 3_000, "look": 11_000, "build": 18_000}  # bytes of the list of tools
_AROUND = 200  # bytes of the answer that has the list


@pytest.fixture(scope="module")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def home(base: Path) -> Path:
    return base.parent.parent


class Offered(NamedTuple):
    """A client of a server with one of the profiles, and the tools that it lists."""

    client: Client
    tools: dict[str, Tool]


@pytest.fixture(scope="module")
async def offers(
    home: Path, docs_url: str, tmp_path_factory: pytest.TempPathFactory
) -> AsyncIterator[dict[str, Offered]]:
    """Of each profile; the default one's is a server of its own."""
    async with AsyncExitStack() as servers:
        share_docs(servers.enter_context(pytest.MonkeyPatch.context()), docs_url)
        made: dict[str, Offered] = {}
        for profile in PROFILES:
            setup = SessionSetup(best_sandbox(), run=tmp_path_factory.mktemp(profile))
            sessions = BlenderSessions(setup)
            servers.callback(sessions.close)
            server = (
                over_stdio(home)
                if profile == DEFAULT
                else make_server(sessions, DocsClient(), Team(), profile)
            )
            client = await servers.enter_async_context(Client(server))
            made[profile] = Offered(client, {tool.name: tool for tool in (await client.list_tools()).tools})
        yield made


def size(tools: dict[str, Tool]) -> int:
    listed = (tool.model_dump_json(by_alias=True, exclude_none=True).encode() for tool in tools.values())
    return _AROUND + sum(len(tool) + 1 for tool in listed)


async def resource(client: Client, uri: str) -> Any:
    (part,) = (await client.read_resource(uri)).contents
    assert isinstance(part, TextResourceContents)
    return json.loads(part.text)


async def test_each_profile_has_what_the_one_before_it_has_and_keeps_to_its_size(
    offers: dict[str, Offered],
) -> None:
    before: set[str] = set()
    for profile in PROFILES:
        tools = offers[profile].tools
        assert before < set(tools)
        before = set(tools)
        if profile in MOST_SENT:
            assert size(tools) <= MOST_SENT[profile], profile
    assert {tool.name for tool in TOOLS} < before


async def test_docs_starts_no_blender_and_look_changes_no_scene(
    home: Path, offers: dict[str, Offered]
) -> None:
    client, tools = offers["docs"]
    assert set(tools) == {"blender_docs", "blender_check"}
    assert client.instructions is not None
    assert "live Blender" not in client.instructions
    with pytest.raises(MCPError, match=r"blender_execute is not among .*--tools docs.* --tools build"):
        await client.call_tool("blender_execute", {"code": "1"})
    with ByHand(home, "--tools", "docs") as wire:
        refused = wire.call("tools/call", name="blender_execute", arguments={"code": "1"})
        assert "is not among" in refused["error"]["message"]
        assert not blenders(wire.process.pid)
    client, tools = offers["look"]
    assert {
        name for name, tool in tools.items() if not (tool.annotations and tool.annotations.read_only_hint)
    } == {"blender_load"}
    with pytest.raises(MCPError, match="--tools all"):
        await client.call_tool("blender_tag_object", {})
    with pytest.raises(MCPError, match="--tools build"):
        await client.call_tool("blender_plan_check", {})
    state = await client.call_tool("blender_scene_state", {})
    assert not state.is_error


async def test_what_the_list_leaves_out_is_had_from_resources(offers: dict[str, Offered]) -> None:
    client, tools = offers["build"]
    whole = {entry["name"]: entry for entry in await resource(client, "blender://tools")}
    plan = await resource(client, "blender://plan/schema")
    assert set(whole) == set(tools)
    for name, tool in tools.items():
        assert set(tool.input_schema["properties"]) == set(whole[name]["inputSchema"]["properties"]), name
        assert tool.output_schema is None
        assert tool.description == whole[name]["description"]
    assert whole["blender_scene_state"]["inputSchema"]["properties"]["max_tokens"]["maximum"] == 50_000
    assert "findings" in whole["blender_check"]["outputSchema"]["properties"]
    Draft202012Validator(plan).validate(small_plan())
    assert not Draft202012Validator(plan).is_valid({**small_plan(), "objects": [{"name": "Box"}]})


async def test_a_plan_check_without_a_plan_tells_the_shape_of_one(offers: dict[str, Offered]) -> None:
    answer = await offers["build"].client.call_tool("blender_plan_check", {})
    assert not answer.is_error
    (block,) = answer.content
    assert isinstance(block, TextContent)
    for name in ("ScenePlan {", "PlannedObject {", "SupportedBy", "opt_out"):
        assert name in block.text


async def test_what_roles_are_told_does_not_depend_on_the_profile(offers: dict[str, Offered]) -> None:
    whole = offers["all"].tools
    for name, tool in offers["build"].tools.items():
        assert lean_arguments(tool.input_schema) == lean_arguments(whole[name].input_schema), name
        assert lean_arguments(tool.input_schema) == tool.input_schema, name
