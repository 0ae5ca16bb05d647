"""Chat completions: the real package against a local server that speaks as the servers in use do."""

from __future__ import annotations

import json
import random
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import pytest
from asks import LOOK, ask, png
from fake_chat_api import DIALECTS, Called, FakeChatAPI, Said
from fake_messages_api import Drop, Raw, Status, Truncate

from simworlds.llm.apis.attempts import Settings
from simworlds.llm.apis.chat_stream import ChatAnswer
from simworlds.llm.apis.claude_stream import BrokenStream
from simworlds.llm.apis.openai_chat import OpenAIChat
from simworlds.llm.apis.retries import RetryPolicy
from simworlds.llm.errors import CutShort, Declined, Rejected, TooLong, Unreachable
from simworlds.llm.messages import Kept, Picture, Text, ToolResult, ToolUse, Usage, user
from simworlds.llm.prices import Price, Prices

if TYPE_CHECKING:
    from collections.abc import Iterator

CALLS = (
    Called("blender_execute", json.dumps({"code": 'print("ä")\n' * 3}), "call_1"),
    Called("blender_object_preview", '{"name": "Cube"}', "call_2"),
    Called("blender_execute", "{}", "call_3"),
)


_made: list[OpenAIChat] = []


@pytest.fixture(autouse=True)
def _no_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("OPENAI_API_KEY", "OPENAI_BASE_URL"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture(autouse=True)
def _closed() -> Iterator[None]:
    yield
    while _made:
        _made.pop().close()


@pytest.fixture
def server() -> Iterator[FakeChatAPI]:
    with FakeChatAPI() as server:
        yield server


def model_of(server: FakeChatAPI, *, tries: int = 4, **given: Any) -> OpenAIChat:
    settings = Settings("key", server.base_url, 10.0, patience=RetryPolicy(tries=tries), **given)
    _made.append(OpenAIChat(settings, pause=lambda seconds: None, chance=random.Random(1)))
    return _made[-1]


# Requests


def test_a_conversation_is_sent_as_the_api_has_it(server: FakeChatAPI) -> None:
    turn = model_of(server).answer(
        ask(
            "Begin.",
            _assistant(
                Text("I look."), ToolUse("a1", LOOK.name, {"name": "Cube"}), Kept({"type": "thinking"})
            ),
            user(ToolResult("a1", (Text("Here it is."), Picture(png()))), "Is it right?"),
        )
    )
    assert turn.text == "Hello."
    (body,) = server.requests
    system, begin, looked, result, shown = body["messages"]
    assert system == {"role": "system", "content": "You write Blender Python.\n\nThe plan: a table."}
    assert begin == {"role": "user", "content": [{"type": "text", "text": "Begin."}]}
    assert looked["tool_calls"][0]["function"] == {"name": LOOK.name, "arguments": '{"name": "Cube"}'}
    assert (result["role"], result["tool_call_id"]) == ("tool", "a1")
    assert result["content"].startswith("Here it is.")
    assert [part["type"] for part in shown["content"]] == ["image_url", "text"]
    assert [tool["function"]["name"] for tool in body["tools"]] == [LOOK.name, "blender_execute"]
    assert body["max_completion_tokens"] == 1000


def test_a_failed_call_says_so(server: FakeChatAPI) -> None:
    model_of(server).answer(
        ask("Begin.", _assistant(ToolUse("a", LOOK.name, {})), user(ToolResult("a", (), failed=True)))
    )
    assert server.requests[0]["messages"][-1]["content"] == "This call failed: (nothing)"


def test_a_server_that_knows_the_older_name_of_the_limit_is_asked_by_it(server: FakeChatAPI) -> None:
    server.takes = "max_tokens"
    model = model_of(server)
    assert model.answer(ask()).text == "Hello."
    assert model.answer(ask()).text == "Hello."
    assert ["max_tokens" in body for body in server.requests] == [False, True, True]


def test_requests_that_are_under_way_together_learn_the_older_name_too(
    server: FakeChatAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    server.takes = "max_tokens"
    model = model_of(server)
    together, respond = threading.Barrier(4), server.respond

    def once_all_have_asked(path: str, authorization: str, body: Any) -> tuple[int, Any]:
        if server.takes not in body:
            together.wait()
        return respond(path, authorization, body)

    monkeypatch.setattr(server, "respond", once_all_have_asked)
    with ThreadPoolExecutor(4) as threads:
        turns = list(threads.map(lambda _: model.answer(ask()), range(4)))
    assert [turn.text for turn in turns] == ["Hello."] * 4
    assert sorted("max_tokens" in body for body in server.requests) == [False] * 4 + [True] * 4


def test_a_form_is_a_structured_output(server: FakeChatAPI) -> None:
    schema = {
        "type": "object",
        "properties": {"ok": {"type": "boolean"}},
        "required": ["ok"],
        "additionalProperties": False,
    }
    form = type(LOOK)("verdict", "Whether it is right.", schema)
    model_of(server).answer(ask(tools=(), form=form))
    (body,) = server.requests
    assert body["response_format"]["json_schema"]["schema"] == schema
    assert "tools" not in body


# Answers


@pytest.mark.parametrize("dialect", DIALECTS)
def test_calls_arrive_whole_however_they_are_streamed(dialect: str) -> None:
    with FakeChatAPI(lambda params: Said("I begin.", calls=CALLS), dialect=dialect) as server:
        said: list[str] = []
        turn = model_of(server).answer(ask(), said.append)
    assert [(call.name, call.input, call.fault) for call in turn.calls] == [
        (call.name, json.loads(call.arguments), "") for call in CALLS
    ]
    assert len({call.id for call in turn.calls}) == 3
    assert all(call.id for call in turn.calls)
    assert (turn.stop_reason, "".join(said), turn.live) == ("tool_use", "I begin.", True)


def test_thinking_is_shown_and_not_sent_back(server: FakeChatAPI) -> None:
    server.answer = lambda params: Said("Done.", thinking="I wonder. ")
    said: list[str] = []
    turn = model_of(server).answer(ask(), said.append)
    assert ("".join(said), turn.content) == ("I wonder. Done.", (Text("Done."),))


@pytest.mark.parametrize(
    "arguments",
    [
        '{"code": "print(1)',
        "print(1)",
        "[1]",
        '{"code": NaN}',
        '{"frames": [{"to": 1e999}]}',
        "[" * 100_000,
    ],
)
def test_a_call_that_cannot_be_read_says_why_and_can_be_sent_back(
    server: FakeChatAPI, arguments: str
) -> None:
    server.answer = lambda params: Said(None, calls=(Called("blender_execute", arguments),))
    model = model_of(server)
    (call,) = model.answer(ask()).calls
    assert (call.name, call.input) == ("blender_execute", {})
    assert "JSON" in call.fault
    again = ask("Begin.", _assistant(call), user(ToolResult(call.id, (Text(call.fault),), failed=True)))
    server.answer = lambda params: Said("I see.")
    assert model.answer(again).text == "I see."


def test_arguments_that_a_server_has_decoded_are_held_to_the_same() -> None:
    deep: dict[str, Any] = {}
    for _ in range(5000):
        deep = {"a": deep}
    for given in ({"frames": [{"to": float("inf")}]}, {"frames": float("nan")}, deep):
        called = {"index": 0, "id": "a", "function": {"name": "blender_trial", "arguments": given}}
        answer = ChatAnswer()
        list(answer.read([{"choices": [{"delta": {"tool_calls": [called]}, "finish_reason": "stop"}]}]))
        (call,) = answer.turn().calls
        assert (call.name, call.input) == ("blender_trial", {})
        assert "JSON" in call.fault


def test_a_cut_off_call_is_left_out(server: FakeChatAPI) -> None:
    calls = (Called("blender_execute", "{}", "a"), Called("blender_execute", '{"code": "pri', "b"))
    server.answer = lambda params: Said("So:", "length", calls)
    with pytest.raises(CutShort) as cut:
        model_of(server).answer(ask())
    assert [call.id for call in cut.value.turn.calls] == ["a"]


def test_refusals_usage_and_cost(server: FakeChatAPI) -> None:
    server.answer = lambda params: Said(cached_tokens=60)
    model = model_of(server, prices=Prices({"claude-opus-5-5": Price(1.0, 10.0)}))
    turn = model.answer(ask())
    assert turn.usage == Usage(40, 20, 60)
    assert turn.cost == pytest.approx((40 + 6 + 200) / 1e6)
    server.answer = lambda params: Said(None, refusal="not this")
    with pytest.raises(Declined, match="not this"):
        model.answer(ask())
    server.answer = lambda params: Said("", "content_filter")
    with pytest.raises(Declined):
        model.answer(ask())


# Faults

HTML = b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: 6\r\nConnection: close\r\n\r\n<html>"
JUNK = (
    b'HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nConnection: close\r\n\r\ndata: {"choices": 3}\n\n'
)


@pytest.mark.parametrize(
    "fault",
    [
        Status(429),
        Status(503),
        Drop(),
        Truncate(500),
        Truncate(20),
        Raw(HTML),
        Raw(JUNK),
        Raw(b"nonsense\r\n\r\n"),
    ],
    ids=str,
)
def test_passing_faults_are_retried(server: FakeChatAPI, fault: Any) -> None:
    server.fail(fault)
    assert model_of(server).answer(ask()).text == "Hello."
    assert len(server.requests) == 2


def test_a_fault_that_stays_ends_the_call(server: FakeChatAPI) -> None:
    server.fail(*[Truncate(500)] * 3)
    with pytest.raises(Unreachable, match="3 times in a row"):
        model_of(server, tries=3).answer(ask())
    server.fail(Status(401))
    with pytest.raises(Rejected, match="OPENAI_API_KEY"):
        model_of(server).answer(ask())
    server.fail(Status(404))
    with pytest.raises(Rejected, match=r"ends in /v1"):
        model_of(server).answer(ask())
    server.fail(Status(413))
    with pytest.raises(TooLong):
        model_of(server).answer(ask())


def test_a_key_is_needed_only_where_there_is_no_address(
    server: FakeChatAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(Rejected, match=r"OPENAI_API_KEY.*OPENAI_BASE_URL"):
        OpenAIChat()
    monkeypatch.setenv("OPENAI_BASE_URL", server.base_url)
    model = OpenAIChat()
    assert model.answer(ask()).text == "Hello."
    assert model.address.rstrip("/") == server.base_url
    model.close()
    for wrong in ("ftp://here/v1", "no address", "http://"):
        monkeypatch.setenv("OPENAI_BASE_URL", wrong)
        with pytest.raises(Rejected, match="OPENAI_BASE_URL"):
            OpenAIChat()


@pytest.mark.parametrize(
    "chunk",
    [3, {"choices": [{"delta": {"content": 3}}]}, {"usage": {"prompt_tokens": -1}}, {"choices": [None]}],
)
def test_invalid_pieces_are_a_broken_stream(chunk: object) -> None:
    with pytest.raises(BrokenStream, match="invalid piece"):
        list(ChatAnswer().read([chunk]))


def _assistant(*content: Any) -> Any:
    from simworlds.llm.messages import Message

    return Message("assistant", content)
