"""The team over MCP: prompts and the plan's check, as a real client of ``simworlds mcp`` finds them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from mcp import Client
from mcp.shared.exceptions import MCPError
from mcp_types import PromptReference
from serving import over_stdio
from small_plan import small_plan

from agents.blender import server as served
from agents.blender.blender_sessions import BlenderSessions, SessionSetup
from agents.blender.docs_client import DocsClient
from agents.blender.team import PROMPTS
from agents.plan.part import STAGES
from agents.roles.prompts import protocol_text, role_text, stage_text, team_text
from simworlds.sandbox.confinement.confined_command import best_sandbox

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from pathlib import Path

pytestmark = [pytest.mark.blender, pytest.mark.anyio]

FITTING = {
    "prompt": "A ball rolls off a shelf.",
    "instruction": "Make the ball blue.",
    "stage": "motion",
}


@pytest.fixture(scope="module")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
async def client(base: Path) -> AsyncIterator[Client]:
    async with Client(over_stdio(base.parent.parent)) as connected:
        yield connected


async def text(client: Client, name: str, **arguments: str) -> str:
    (message,) = (await client.get_prompt(name, arguments)).messages
    assert message.role == "user"
    assert message.content.type == "text"
    return message.content.text


async def test_prompts_are_listed_with_what_they_need(client: Client) -> None:
    listed = (await client.list_prompts()).prompts
    assert [prompt.name for prompt in listed] == ["make_scene", "edit_scene", "plan", "stage", "review"]
    for prompt in listed:
        assert prompt.title
        assert prompt.description
        assert prompt.arguments
        assert all(argument.description for argument in prompt.arguments)


@pytest.mark.parametrize("prompt", PROMPTS, ids=lambda prompt: prompt.name)
async def test_every_prompt_ends_with_what_the_user_asked_for(client: Client, prompt: Any) -> None:
    needed = {one.name: FITTING[one.name] for one in prompt.arguments if one.required}
    told = await text(client, prompt.name, **needed)
    protocol = protocol_text(edit=prompt.name == "edit_scene")
    assert (protocol in told) == (prompt.name not in {"stage", "review"})
    ((_, wanted),) = needed.items()
    assert wanted in told[-400:]


async def test_make_scene_prompt_has_all_roles_and_stages(client: Client) -> None:
    told = await text(client, "make_scene", prompt="A ball rolls off a shelf.")
    assert told.startswith(team_text())
    for role in ("planner", "coder", "reviewer", "final_reviewer"):
        assert role_text(role) in told
    for stage in STAGES:
        assert stage_text(stage) in told


async def test_edit_scene_prompt_names_the_file_and_what_stays(client: Client) -> None:
    told = await text(client, "edit_scene", instruction="Make the ball blue.", file="room.blend")
    assert told.startswith(team_text(edit=True))
    assert role_text("coder", edit=True) in told
    assert "\nEditPlan {" in told
    assert told.endswith("Make the ball blue.\n\nThe file: room.blend")


@pytest.mark.parametrize("stage", STAGES)
async def test_each_stage_can_be_built_and_reviewed_by_itself(client: Client, stage: Any) -> None:
    building, review = await text(client, "stage", stage=stage), await text(client, "review", stage=stage)
    assert role_text("coder") in building
    assert role_text("reviewer") in review
    assert stage_text(stage) in building
    assert stage_text(stage) in review


@pytest.mark.parametrize(
    ("name", "arguments", "reason"),
    [
        ("make_movie", {}, "There is no prompt 'make_movie'. Available: make_scene, edit_scene"),
        ("make_scene", {}, "make_scene needs the argument 'prompt'"),
        ("make_scene", {"prompt": "  "}, "make_scene needs the argument 'prompt'"),
        ("make_scene", {"prompt": "x" * 30_000}, "has 30000 characters"),
        ("plan", {"prompt": "x", "stage": "uv"}, "plan has no argument 'stage'; it has prompt"),
        ("stage", {"stage": "baking"}, "There is no stage 'baking'. Available: modeling, uv"),
    ],
)
async def test_unknown_prompts_and_arguments_are_refused_with_the_valid_ones(
    client: Client, name: str, arguments: dict[str, str], reason: str
) -> None:
    with pytest.raises(MCPError, match=reason):
        await client.get_prompt(name, arguments)


async def test_stages_are_completed_as_they_are_typed(client: Client) -> None:
    reference = PromptReference(name="stage")
    found = await client.complete(reference, {"name": "stage", "value": "mo"})
    assert found.completion.values == ["modeling", "motion"]
    assert (await client.complete(reference, {"name": "prompt", "value": ""})).completion.values == []


async def test_braces_in_a_request_stay_as_they_are(client: Client) -> None:
    assert (await text(client, "make_scene", prompt="{{stages}} {x} %s")).endswith("{{stages}} {x} %s")


async def test_a_plan_is_checked(client: Client) -> None:
    sound = await client.call_tool("blender_plan_check", {"plan": small_plan()})
    assert not sound.is_error
    assert sound.structured_content is not None
    assert sound.structured_content["sound"] is True
    faulty = await client.call_tool("blender_plan_check", {"plan": small_plan() | {"systems": ["room"]}})
    assert not faulty.is_error
    assert faulty.structured_content is not None
    assert "systems" in [fault["path"] for fault in faulty.structured_content["faults"]]
    wrong = await client.call_tool("blender_plan_check", {"scene": small_plan()})
    assert wrong.is_error


async def test_valid_plan_is_accepted_by_the_verifier(client: Client) -> None:
    answer = await client.call_tool("blender_verify", {"plan": small_plan(), "rules": ["R1"]})
    assert answer.structured_content is not None
    assert {finding["rule"] for finding in answer.structured_content["findings"]} == {"R1"}


@pytest.mark.usefixtures("shared_docs")
async def test_server_without_team_offers_no_prompts_or_plan_check(tmp_path: Path) -> None:
    blender_sessions = BlenderSessions(SessionSetup(best_sandbox(), run=tmp_path / "run"))
    async with Client(served.make_server(blender_sessions, DocsClient())) as connected:
        assert connected.server_capabilities.prompts is None
        assert connected.instructions is not None
        assert "blender_plan_check" not in connected.instructions
        with pytest.raises(MCPError, match="There is no tool 'blender_plan_check'"):
            await connected.call_tool("blender_plan_check", {"plan": small_plan()})
