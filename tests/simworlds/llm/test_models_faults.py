"""Whatever a server or a network does, an answer is whole or there is an error that says what happened."""

from __future__ import annotations

import json
import random
import signal
import subprocess
import sys
import threading
import time
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime
from pathlib import Path
from typing import Any

import fake_messages_stream as sse
import pytest
from asks import MESSAGES, ask
from fake_messages_api import (
    Drop,
    Garble,
    Hang,
    Raw,
    Reply,
    Stall,
    Status,
    StreamError,
    Truncate,
)
from places import REPO

from simworlds.llm.apis.attempts import Settings
from simworlds.llm.apis.claude import Claude
from simworlds.llm.apis.retries import RetryPolicy, requested_pause
from simworlds.llm.errors import ModelError, OverBudget, Rejected, Unreachable
from simworlds.llm.messages import Kept, Text, ToolUse, Usage
from simworlds.llm.spending import Metered, Spending

CONTENT = (
    {"type": "thinking", "thinking": "A table first.", "signature": "signed"},
    {"type": "text", "text": "I build the table. 🙂"},
    {"type": "tool_use", "id": "toolu_1", "name": "blender_execute", "input": {"code": "import bpy\n"}},
)
WHOLE = (
    Kept({"type": "thinking", "thinking": "A table first.", "signature": "signed"}),
    Text("I build the table. 🙂"),
    ToolUse("toolu_1", "blender_execute", {"code": "import bpy\n"}),
)
HTML = (
    b"HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Type: text/html\r\nContent-Length: 26\r\n\r\n"
    b"<html>Please log in</html>"
)


@pytest.fixture(autouse=True)
def _answers(api):
    api.answer = lambda params: Reply(content=CONTENT, stop_reason="tool_use")


def stream_of(api) -> bytes:
    """The stream of the answer."""
    message = api.message(Reply(content=CONTENT, stop_reason="tool_use"), {"model": "claude-opus-5-5"})
    return b"".join(map(sse.encoded, sse.events(message)))


@pytest.mark.parametrize(
    ("fault", "told_of"),
    [
        (Status(429, {"retry-after": "0"}), "429 scripted 429"),
        (Status(529), "529"),
        (Status(500), "500"),
        (Status(503, body="<html>busy</html>"), "503"),
        (Status(408), "408"),
        (Status(409), "409"),
        (Status(400, {"x-should-retry": "true"}), "400"),
        (Drop(), "disconnected"),
        (Drop(handled=True), "disconnected"),
        (Hang(0.05), "disconnected"),
        (Raw(b""), "disconnected"),
        (Raw(b"SSH-2.0-OpenSSH\r\n"), "Protocol"),
        (Raw(HTML), "ended in the middle"),
        (Raw(HTML.replace(b"200 OK", b"503 No")), "503"),
        (Raw(HTML.replace(b"26", b"99")), "Protocol"),
        (Raw(b"HTTP/1.1 500 No\r\nConnection: close\r\nContent-Length: 99\r\n\r\n{"), "Protocol"),
        (
            Raw(
                b"HTTP/1.1 302 Found\r\nConnection: close\r\nLocation: http://[::1\r\nContent-Length: 0\r\n\r\n"
            ),
            "",
        ),
        (
            Raw(
                b"HTTP/1.1 302 Found\r\nConnection: close\r\nLocation: gopher://x/\r\nContent-Length: 0\r\n\r\n"
            ),
            "",
        ),
        (
            Raw(
                b"HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Encoding: gzip\r\nContent-Length: 4\r\n\r\nnope"
            ),
            "Decod",
        ),
        (
            Raw(b"HTTP/1.1 200 OK\r\nConnection: close\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n"),
            "Protocol",
        ),
        (
            Raw(b"HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Length: 12\r\n\r\ndata: [1,2]\n"),
            "ended in the middle",
        ),
        (
            Raw(
                b"HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Length: 34\r\n\r\n"
                b"event: message_start\ndata: [1,2]\n\n"
            ),
            "an invalid event",
        ),
        (StreamError(1), "overloaded_error: Overloaded"),
        (StreamError(8, "api_error", "Internal server error"), "api_error"),
        (StreamError(4, "rate_limit_error", "Slow down"), "rate_limit_error"),
        (StreamError(4, "a_new_error", "What?"), "a_new_error"),
        (Stall(900, seconds=0.05), "Protocol"),
    ],
    ids=str,
)
def test_passing_faults_are_reported_and_retried(api, claude, told, fault, told_of):
    api.fail(MESSAGES, fault)
    heard: list[str] = []
    turn = claude.answer(ask(), heard.append)
    assert turn.content == WHOLE
    assert "".join(heard).endswith("A table first.I build the table. 🙂")
    (retry,) = told.retries
    assert told_of in retry.why
    assert (retry.failed, told.pauses) == (1, [retry.pause])
    assert len(api.requests) == 2
    assert api.requests[0].body == api.requests[1].body


def test_a_stream_may_break_at_any_byte(api, claude, told):
    data = stream_of(api)
    ends = [place for place in range(len(data)) if data[place : place + 2] == b"\n\n"]
    stop = data.index(b'"message_stop"}') + len(b'"message_stop"}\n\n')
    cuts = sorted(
        {*range(0, stop, 53), *(end + more for end in ends for more in (0, 1, 2, 3))} & {*range(stop)}
    )
    for number, cut in enumerate(cuts):
        api.fail(MESSAGES, Truncate(cut, clean=number % 3 == 0))
        assert claude.answer(ask()).content == WHOLE, cut
    assert len(told.retries) == len(cuts) > 100


def test_a_stream_without_its_last_byte_is_whole(api, claude, told):
    api.fail(MESSAGES, Truncate(len(stream_of(api)), clean=False))
    assert claude.answer(ask()).content == WHOLE
    assert told.retries == []


def test_garbled_streams_give_a_turn_or_a_model_error(api, make_claude):
    claude = make_claude(patience=RetryPolicy(tries=1))
    chance = random.Random(5)
    data = stream_of(api)
    turns = errors = 0
    for _ in range(100):
        at = chance.randrange(len(data))
        junk = bytes(chance.randrange(256) for _ in range(chance.choice([1, 1, 2, 30])))
        api.fail(MESSAGES, Garble(at, junk))
        try:
            claude.answer(ask())
            turns += 1
        except ModelError:
            errors += 1
    assert turns > 5 < errors


START = {
    "type": "message_start",
    "message": {"model": "m", "content": [], "usage": {"input_tokens": 5, "output_tokens": 1}},
}
BLOCK = {"type": "content_block_start", "index": 0, "content_block": {"type": "text", "text": ""}}
DELTA = {"type": "content_block_delta", "index": 0, "delta": {"type": "text_delta", "text": "x"}}
STOP = {"type": "content_block_stop", "index": 0}
END = {"type": "message_delta", "delta": {"stop_reason": "end_turn"}, "usage": {"output_tokens": 3}}
LAST = {"type": "message_stop"}
GOOD = [START, BLOCK, DELTA, STOP, END, LAST]
CALL = {**BLOCK, "content_block": {"type": "tool_use", "id": "t", "name": "n", "input": {}}}


def start_with(**changes: Any) -> dict[str, Any]:
    return {**START, "message": {**START["message"], **changes}}


def input_of(text: str) -> dict[str, Any]:
    return {**DELTA, "delta": {"type": "input_json_delta", "partial_json": text}}


def script(api, events, times: int = 1) -> None:
    """The next answers consist of these events."""
    body = b"".join(map(sse.encoded, events))
    head = b"HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Length: %d\r\n\r\n" % len(body)
    api.fail(MESSAGES, *[Raw(head + body)] * times)


@pytest.mark.parametrize(
    "events",
    [
        GOOD,
        [{"type": "news"}, *GOOD[:-1], {"type": "ping"}, {"type": "news", "index": 0, "delta": 5}, LAST],
        [START, BLOCK, {**DELTA, "delta": {"type": "news", "text": 5}}, DELTA, STOP, END, LAST],
        [*GOOD, DELTA],
        [START, END, BLOCK, DELTA, STOP, END, LAST],
    ],
)
def test_unknown_events_and_what_follows_the_message_are_ignored(api, claude, told, events):
    script(api, events)
    turn = claude.answer(ask())
    assert (turn.content, turn.model, turn.usage) == ((Text("x"),), "m", Usage(5, 3))
    assert told.retries == []


@pytest.mark.filterwarnings("ignore:Pydantic serializer")  # the package says it of a wrong model
@pytest.mark.parametrize(
    "events",
    [
        GOOD[1:],
        GOOD[:-1],
        [START, *GOOD],
        [START, DELTA, STOP, END, LAST],
        [START, STOP, END, LAST],
        [START, BLOCK, BLOCK, DELTA, STOP, END, LAST],
        [START, BLOCK, {**DELTA, "index": 1}, STOP, END, LAST],
        [START, BLOCK, {**DELTA, "index": -1}, STOP, END, LAST],
        [START, BLOCK, STOP, DELTA, END, LAST],
        [START, {**BLOCK, "index": 7}, {**DELTA, "index": 7}, {**STOP, "index": 7}, END, LAST],
        [START, {**BLOCK, "content_block": []}, STOP, END, LAST],
        [START, BLOCK, {**DELTA, "delta": {"type": "text_delta", "text": 5}}, STOP, END, LAST],
        [START, BLOCK, DELTA, END, LAST],
        [START, LAST],
        [START, {**END, "delta": {"stop_reason": None}}, LAST],
        [start_with(usage={"input_tokens": -5}), *GOOD[1:]],
        [start_with(usage=None), *GOOD[1:]],
        [start_with(content=None), *GOOD[1:]],
        [start_with(model=5), *GOOD[1:]],
        [{**START, "message": "hello"}, *GOOD[1:]],
        [START, {"type": "error"}],
        [START, CALL, input_of("[1]"), STOP, END, LAST],
        [START, CALL, input_of('{"code": "import bp'), STOP, END, LAST],
        [START, CALL, input_of('{"code": NaN}'), STOP, END, LAST],
        [START, CALL, input_of('{"frames": [1, -1e999]}'), STOP, END, LAST],
        [START, CALL, input_of("{'code': 1}"), STOP, END, LAST],
        [START, CALL, input_of("[" * 5000), STOP, END, LAST],
        [START, CALL, input_of('{"code": "\\ud800"}'), STOP, END, LAST],
        [START, {**BLOCK, "content_block": {"type": "tool_use"}}, STOP, END, LAST],
    ],
)
def test_invalid_event_sequences_are_retried(api, make_claude, events):
    script(api, events, times=2)
    with pytest.raises(Unreachable, match=r"\(2 times in a row\)"):
        make_claude(patience=RetryPolicy(tries=2)).answer(ask())


def test_a_failing_server_is_given_up_after_growing_pauses(api, make_claude, told):
    api.fail(MESSAGES, *[Status(529)] * 8)
    with pytest.raises(Unreachable, match=r"529 scripted 529 \(8 times in a row\)"):
        make_claude().answer(ask())
    assert len(api.requests) == 8
    assert [retry.failed for retry in told.retries] == [1, 2, 3, 4, 5, 6, 7]
    for longest, pause in zip((1, 2, 4, 8, 16, 32, 60), told.pauses, strict=True):
        assert longest / 2 <= pause <= longest


def test_an_unreachable_address_is_given_up_soon(make_claude, told):
    claude = make_claude(base_url="http://127.0.0.1:9")
    with pytest.raises(Unreachable, match=r"127\.0\.0\.1:9.*refused.*3 times"):
        claude.answer(ask())
    assert len(told.retries) == 2


@pytest.mark.parametrize(
    ("headers", "least", "most"),
    [
        ({"retry-after": "20"}, 20, 21),
        ({"retry-after-ms": "1500"}, 1.5, 2.5),
        ({"retry-after": "nonsense"}, 0.5, 1),
        ({"retry-after": "-3"}, 0.5, 1),
        ({"retry-after": "nan"}, 0.5, 1),
    ],
)
def test_retry_after_seconds_are_respected(api, claude, told, headers, least, most):
    api.fail(MESSAGES, Status(429, headers))
    claude.answer(ask())
    assert least <= told.pauses[0] <= most


@pytest.mark.parametrize(
    ("wait", "least", "most"), [(timedelta(seconds=90), 60, 92), (timedelta(days=-1), 0.5, 1)]
)
def test_retry_after_dates_are_respected(api, claude, told, wait, least, most):
    api.fail(MESSAGES, Status(429, {"retry-after": format_datetime(datetime.now(UTC) + wait)}))
    claude.answer(ask())
    assert least <= told.pauses[0] <= most


def test_a_date_beyond_the_last_year_asks_for_no_pause(monkeypatch):
    with monkeypatch.context() as patch:
        patch.setenv("TZ", "UTC-9")  # nine hours before, and without a zone the date is taken for one of here
        time.tzset()
        assert requested_pause({"retry-after": "Fri, 31 Dec 9999 23:59:59 -0000"}) == 0
    time.tzset()


def test_too_long_a_retry_after_is_given_up(api, claude, told):
    api.fail(MESSAGES, Status(429, {"retry-after": "7200"}))
    with pytest.raises(Unreachable, match="asks to wait 7200 s"):
        claude.answer(ask())
    assert told.pauses == []


@pytest.mark.parametrize(
    ("fault", "says"),
    [
        (Status(401), "Check the key"),
        (Status(402), "Check the account's credit"),
        (Status(403), "may use this model"),
        (Status(404), "Check the model's name"),
        (Status(400), "400"),
        (Status(422, body="[]"), "422"),
        (Status(529, {"x-should-retry": "false"}), "529"),
        (StreamError(3, "invalid_request_error", "No such thing"), "No such thing"),
        (StreamError(0, "permission_error", "Not you"), "Not you"),
    ],
)
def test_lasting_faults_are_errors_at_once(api, claude, told, fault, says):
    api.fail(MESSAGES, fault)
    with pytest.raises(Rejected, match=says):
        claude.answer(ask())
    assert len(api.requests) == 1
    assert told.retries == []


def test_silence_and_endless_answers_have_an_end(api, make_claude):
    api.fail(MESSAGES, Hang(20), Stall(700, 20))
    quick = make_claude(silence=0.1, patience=RetryPolicy(tries=2))
    with pytest.raises(Unreachable, match="Timeout"):
        quick.answer(ask())
    clock = iter(range(0, 10**6, 1000))
    go = threading.Event()
    go.set()
    api.fail(MESSAGES, Stall(700, go=go))
    slow = Claude(
        Settings("key", api.base_url, patience=RetryPolicy(tries=1)), clock=lambda: float(next(clock)) * 2
    )
    with pytest.raises(Unreachable, match="takes more than 1800 s"):
        slow.answer(ask())
    slow.close()


def test_usage_of_broken_attempts_is_counted(api, make_claude, told):
    claude = make_claude(patience=RetryPolicy(tries=3))
    data = stream_of(api)
    api.fail(MESSAGES, Truncate(len(data) - 100), Status(529), Truncate(20))
    with pytest.raises(Unreachable) as unreachable:
        claude.answer(ask())
    lost = unreachable.value.lost
    assert lost.input == 100
    assert 10 < lost.output < 60
    api.fail(MESSAGES, Truncate(len(data) - 100), Truncate(len(data) - 100))
    turn = claude.answer(ask())
    assert turn.lost == lost + lost
    assert turn.cost == pytest.approx((300 * 4 + (20 + 2 * lost.output) * 20) / 1e6)
    assert told.retries[-1].lost == turn.lost
    assert turn.usage == Usage(100, 20)


def test_the_limit_includes_retries(api, make_claude):
    spending = Spending(max_cost=0.031)
    claude = Claude(Settings("key", api.base_url), spending.before_retry, pause=lambda seconds: None)
    api.answer = lambda params: Reply("x" * 20_000)
    api.fail(MESSAGES, *[Stall(60_000, 0.0)] * 5)
    with pytest.raises(OverBudget, match=r"limit of \$0\.03"):
        Metered(claude, spending).answer(ask())
    claude.close()
    assert 1 <= len(api.requests) < 5
    assert spending.total().usage.output > 0


def test_errors_of_the_listener_are_not_retried(api, claude, told):
    def listen(text: str) -> None:
        raise OSError("the terminal is gone")

    with pytest.raises(OSError, match="the terminal is gone"):
        claude.answer(ask(), listen)
    assert told.retries == []
    assert claude.answer(ask()).content == WHOLE


ASKING = """\
import sys
sys.path[:0] = [{tests!r}, {repository!r}]
from asks import ask
from simworlds.llm.apis.attempts import Settings
from simworlds.llm.apis.claude import Claude
Claude(Settings("key", {address!r})).answer(ask())
"""


@pytest.mark.parametrize("fault", [Hang(200), Stall(700, 200)])
def test_ctrl_c_leaves_at_once(api, fault):
    api.fail(MESSAGES, fault)
    code = ASKING.format(tests=str(Path(__file__).parent), repository=str(REPO), address=api.base_url)
    asking = subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.PIPE, text=True)
    try:
        api.wait_for(MESSAGES)
        time.sleep(0.5)  # until the client waits: Python drops an interrupt that meets a destructor
        asking.send_signal(signal.SIGINT)
        _, said = asking.communicate(timeout=60)  # before the server would have let go
    finally:
        asking.kill()
    assert said.rstrip().endswith("KeyboardInterrupt"), said


def test_ctrl_c_in_a_pause_is_not_taken_for_a_fault(api):
    def pause(seconds: float) -> None:
        raise KeyboardInterrupt

    claude = Claude(Settings("key", api.base_url), pause=pause)
    api.fail(MESSAGES, Status(529))
    with pytest.raises(KeyboardInterrupt):
        claude.answer(ask())
    claude.close()
    assert len(api.requests) == 1


def test_several_threads_can_ask_at_once(api, claude):
    api.answer = lambda params: Reply(f"To {params['messages'][0]['content'][0]['text']}")
    said: dict[int, str] = {}

    def one(number: int) -> None:
        said[number] = claude.answer(ask(f"number {number}")).text

    threads = [threading.Thread(target=one, args=(number,)) for number in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert said == {number: f"To number {number}" for number in range(6)}
    assert json.dumps(said)
