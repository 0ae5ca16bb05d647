"""A run whose models are reached over chat completions, as of Ollama or vLLM."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import crates
import pytest
from chat_team import chat_team
from fake_chat_api import FakeChatAPI
from fake_messages_api import Reply
from run_sessions import at_home, sit
from team import ABORT, DONE, Team, run

if TYPE_CHECKING:
    from pathlib import Path

    from run_sessions import Played

pytestmark = pytest.mark.blender

BROKEN = Reply(
    content=({"type": "tool_use", "id": "call_x", "name": "blender_execute", "input": '{"code": "import b'},),
    stop_reason="tool_use",
)
TURNS = (BROKEN, run(crates.CODE["modeling"]), DONE)


@pytest.fixture(scope="module")
def server() -> Any:
    team = Team(coder={"modeling": TURNS}, decisions={"modeling": (ABORT,)})
    with FakeChatAPI(chat_team(team), dialect="blank") as server:
        server.needs_key = False
        yield server


@pytest.fixture(scope="module")
def played(home: Path, tmp_path_factory: pytest.TempPathFactory, server: FakeChatAPI) -> Played:
    with at_home(home) as patch:
        patch.setenv("OPENAI_BASE_URL", server.base_url)
        return sit(tmp_path_factory.mktemp("chat") / "run", provider="openai", model="qwen", price="0/0")


def test_tools_and_pictures_reach_a_server_without_a_key(played: Played, server: FakeChatAPI) -> None:
    assert played.ended.how == "aborted"
    assert {body["model"] for body in server.requests} == {"qwen"}
    called = played.of("tool.answered", role="coder", stage="modeling")
    assert [row["failed"] for row in called] == [False]
    kinds = {
        part["type"]
        for body in server.requests
        for message in body["messages"]
        if isinstance(message.get("content"), list)
        for part in message["content"]
    }
    assert kinds == {"text", "image_url"}


def test_a_call_that_was_not_json_is_told_and_made_again(played: Played, server: FakeChatAPI) -> None:
    told = [
        message["content"]
        for body in server.requests
        for message in body["messages"]
        if message["role"] == "tool"
    ]
    assert any("blender_execute was not called. The arguments are not valid JSON" in text for text in told)


def test_answers_of_models_with_a_price_of_ones_own_have_a_cost(played: Played) -> None:
    turns = [row["turn"] for row in played.of("model.answered")]
    assert turns
    assert {turn["cost"] for turn in turns} == {0.0}
