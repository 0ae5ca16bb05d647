"""Which tools a client of ``simworlds mcp`` is offered, how little it is sent, and that nothing is lost by that."""

from __future__ import annotations

import json
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any

import pytest
from jsonschema import Draft202012Validator
from mcp import Client
from mcp.shared.exceptions import MCPError
from mcp_types import TextContent, TextResourceContents, Tool
from serving import over_stdio
from small_plan import small_plan

from agents.blender.tool_catalogue import TOOLS
from agents.blender.tool_profiles import PROFILES
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


@asynccontextmanager
async def offered(home: Path, profile: str) -> AsyncIterator[tuple[Client, dict[str, Tool]]]:
    async with Client(over_stdio(home, "--tools", profile)) as client:
        yield client, {tool.name: tool for tool in (await client.list_tools()).tools}


def size(tools: dict[str, Tool]) -> int:
    listed = (tool.model_dump_json(by_alias=True, exclude_none=True).encode() for tool in tools.values())
    return _AROUND + sum(len(tool) + 1 for tool in listed)


async def resource(client: Client, uri: str) -> Any:
    (part,) = (await client.read_resource(uri)).contents
    assert isinstance(part, TextResourceContents)
    return json.loads(part.text)


async def test_each_profile_has_what_the_one_before_it_has_and_keeps_to_its_size(home: Path) -> None:
    before: set[str] = set()
    for profile in PROFILES:
        async with offered(home, profile) as (_, tools):
            assert before < set(tools)
            before = set(tools)
            if profile in MOST_SENT:
                assert size(tools) <= MOST_SENT[profile], profile
    assert {tool.name for tool in TOOLS} < before


async def test_docs_starts_no_blender_and_look_changes_no_scene(home: Path) -> None:
    runs = home / "runs"
    known = set(runs.glob("*"))
    async with offered(home, "docs") as (client, tools):
        assert set(tools) == {"blender_docs", "blender_check"}
        assert client.instructions is not None
        assert "live Blender" not in client.instructions
        with pytest.raises(MCPError, match=r"blender_execute is not among .*--tools docs.* --tools build"):
            await client.call_tool("blender_execute", {"code": "1"})
    assert set(runs.glob("*")) == known
    async with offered(home, "look") as (client, tools):
        assert {
            name for name, tool in tools.items() if not (tool.annotations and tool.annotations.read_only_hint)
        } == {"blender_load"}
        with pytest.raises(MCPError, match="--tools all"):
            await client.call_tool("blender_tag_object", {})
        with pytest.raises(MCPError, match="--tools build"):
            await client.call_tool("blender_plan_check", {})
        state = await client.call_tool("blender_scene_state", {})
        assert not state.is_error


async def test_what_the_list_leaves_out_is_had_from_resources(home: Path) -> None:
    async with offered(home, "build") as (client, tools):
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


async def test_a_plan_check_without_a_plan_tells_the_shape_of_one(home: Path) -> None:
    async with offered(home, "build") as (client, _):
        answer = await client.call_tool("blender_plan_check", {})
    assert not answer.is_error
    (block,) = answer.content
    assert isinstance(block, TextContent)
    for name in ("ScenePlan {", "PlannedObject {", "SupportedBy", "opt_out"):
        assert name in block.text


async def test_what_roles_are_told_does_not_depend_on_the_profile(home: Path) -> None:
    async with offered(home, "build") as (_, lean), offered(home, "all") as (_, whole):
        for name, tool in lean.items():
            assert lean_arguments(tool.input_schema) == lean_arguments(whole[name].input_schema), name
            assert lean_arguments(tool.input_schema) == tool.input_schema, name
