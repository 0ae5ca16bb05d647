"""Messages on pipes: however they arrive in pieces, whoever reads them how slowly, and whoever goes away."""

from __future__ import annotations

import contextlib
import json
import os
import socket
from typing import TYPE_CHECKING

import anyio
import anyio.to_thread
import mcp_types as types
import pytest
from mcp.shared.message import SessionMessage

from simworlds.mcp_transport.pipes import PipeReader, PipeWriter

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.anyio

PING = b'{"jsonrpc": "2.0", "id": 1, "method": "ping"}'


def said(text: str) -> SessionMessage:
    return SessionMessage(types.JSONRPCNotification(jsonrpc="2.0", method=text))


def method(received: SessionMessage | Exception) -> str:
    assert isinstance(received, SessionMessage)
    return getattr(received.message, "method", "")


@pytest.fixture(params=["pipe", "socket"])
def ends(request: pytest.FixtureRequest) -> Iterator[tuple[int, int]]:
    """Where to read, and where to write."""
    if request.param == "pipe":
        reading, writing = os.pipe()
    else:
        reading, writing = (one.detach() for one in socket.socketpair())
    yield reading, writing
    for end in (reading, writing):
        with contextlib.suppress(OSError):  # the test has closed it
            os.close(end)


@pytest.mark.parametrize(
    ("sent", "expected"),
    [
        (b"", []),
        (PING + b"\n", ["ping"]),
        (PING + b"\r\n" + PING + b"\n", ["ping", "ping"]),
        (PING, ["ping"]),
        (PING + b"\nno message\n" + PING, ["ping", "", "ping"]),
        (PING.replace(b"ping", b"p\xffng"), ["p\ufffdng"]),
    ],
)
async def test_lines_are_messages_and_others_are_errors(
    ends: tuple[int, int], sent: bytes, expected: list[str]
) -> None:
    os.write(ends[1], sent)
    os.close(ends[1])
    received = [message async for message in PipeReader(ends[0])]
    assert ["" if isinstance(message, Exception) else method(message) for message in received] == expected


async def test_a_request_is_read_though_it_has_half_an_emoji_or_is_nested_deeply(
    ends: tuple[int, int],
) -> None:
    deep = '{"a":' * 300 + "1" + "}" * 300
    for number, given in enumerate((r'{"code": "a\ud83d", "\udc00": "\ud83d\ude00"}', deep)):
        params = f'{{"name": "t", "arguments": {given}}}'
        os.write(
            ends[1], f'{{"jsonrpc":"2.0","id":{number},"method":"tools/call","params":{params}}}\n'.encode()
        )
    reader = PipeReader(ends[0])
    cut, nested = (await reader.receive(), await reader.receive())
    assert isinstance(cut, SessionMessage)
    assert isinstance(cut.message, types.JSONRPCRequest)
    assert cut.message.params == {"name": "t", "arguments": {"code": "a?", "?": "😀"}}
    assert isinstance(nested, SessionMessage)


async def test_a_message_may_arrive_in_pieces_and_be_longer_than_a_pipe_holds(ends: tuple[int, int]) -> None:
    text = "é" * 300_000
    line = json.dumps({"jsonrpc": "2.0", "method": text}, ensure_ascii=False).encode() + b"\n"

    def write() -> None:
        for place in range(0, len(line), 9_999):
            os.write(ends[1], line[place : place + 9_999])

    async with anyio.create_task_group() as tasks:
        tasks.start_soon(anyio.to_thread.run_sync, write)
        assert method(await PipeReader(ends[0]).receive()) == text


async def test_a_message_that_was_begun_is_finished_though_its_sender_is_cancelled(
    ends: tuple[int, int],
) -> None:
    reader, writer = PipeReader(ends[0]), PipeWriter(ends[1], lambda: None)
    begun = "a" * 1_000_000
    async with anyio.create_task_group() as senders:
        senders.start_soon(writer.send, said(begun))
        await anyio.wait_all_tasks_blocked()
        senders.start_soon(writer.send, said("waits for its turn"))
        await anyio.wait_all_tasks_blocked()
        senders.cancel_scope.cancel()
        with anyio.CancelScope(shield=True):
            assert method(await reader.receive()) == begun
    await writer.send(said("next"))
    assert method(await reader.receive()) == "next"


async def test_a_client_that_is_gone_is_given_up(ends: tuple[int, int]) -> None:
    given_up: list[bool] = []
    os.close(ends[0])
    with pytest.raises(anyio.BrokenResourceError):
        await PipeWriter(ends[1], lambda: given_up.append(True)).send(said("x"))
    assert given_up


async def test_a_client_that_goes_without_reading_ends_the_messages() -> None:
    own, others = socket.socketpair()
    with own, others:
        own.send(b"unread")
        others.close()
        assert [message async for message in PipeReader(own.fileno())] == []
