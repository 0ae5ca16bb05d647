"""MCP messages on two pipes or sockets, one a line, read and written by the event loop itself.

The MCP package's own transport reads and writes files in threads: each message changes threads six times, which takes
as long as all else that the package does for a call. A pipe can be waited for instead; a file cannot.
"""

from __future__ import annotations

import json
import os
import select
from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING, Self

import anyio
import mcp_types as types
from mcp.shared.message import SessionMessage

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

_AT_ONCE = 64 * 1024  # what a pipe holds


class _Stream:
    """What both streams are to the MCP package besides: asynchronous context managers."""

    async def aclose(self) -> None:
        """Nothing: the descriptor is the caller's."""

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        await self.aclose()


def _read_leniently(line: str) -> SessionMessage | None:
    """A message that pydantic does not read, so that its sender does not wait for ever; None if it is none.

    Half of an emoji, which JavaScript writes where a text was cut, becomes a question mark; what is nested too deeply
    is for the tools to refuse.
    """
    with suppress(ValueError, RecursionError):
        whole = json.dumps(json.loads(line), ensure_ascii=False).encode(errors="replace")
        return SessionMessage(types.jsonrpc_message_adapter.validate_python(json.loads(whole), by_name=False))
    return None


class PipeReader(_Stream):
    """The messages that the client sends: a stream as the MCP package reads it."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._begun = bytearray()  # of a line whose end is not here yet
        self._lines: deque[bytes] = deque()
        self._has_ended = False

    async def receive(self) -> SessionMessage | Exception:
        """The next message, or what is wrong with its line. Raises EndOfStream once there are no more."""
        while not self._lines:
            if self._has_ended:
                raise anyio.EndOfStream
            await anyio.wait_readable(self._descriptor)
            try:
                self._take(os.read(self._descriptor, _AT_ONCE))
            except ConnectionError:  # of a socket whose client has gone without reading all
                self._take(b"")
        line = self._lines.popleft().decode(errors="replace")
        try:
            return SessionMessage(types.jsonrpc_message_adapter.validate_json(line, by_name=False))
        except Exception as error:  # nothing that a client writes may end the server
            return _read_leniently(line) or error

    def _take(self, read: bytes) -> None:
        """Splits what was read into lines."""
        self._has_ended = not read
        *ends, begun = read.split(b"\n")
        if self._has_ended and self._begun:
            ends = [b""]
        for end in ends:
            self._lines.append(bytes(self._begun) + end)
            self._begun.clear()
        self._begun += begun

    async def aclose(self) -> None:
        """Gives out no more messages."""
        self._has_ended = True
        self._lines.clear()

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> SessionMessage | Exception:
        try:
            return await self.receive()
        except anyio.EndOfStream:
            raise StopAsyncIteration from None


class PipeWriter(_Stream):
    """The messages to the client: a stream as the MCP package writes it.

    ``give_up`` is called when nobody reads them any more.
    """

    def __init__(self, descriptor: int, give_up: Callable[[], None]) -> None:
        self._descriptor = descriptor
        self._give_up = give_up
        self._turn = anyio.Lock(fast_acquire=True)
        self._has_room = select.poll()
        self._has_room.register(descriptor, select.POLLOUT)

    async def send(self, item: SessionMessage) -> None:
        """Writes a message. Raises BrokenResourceError if nobody reads it."""
        line = item.message.model_dump_json(by_alias=True, exclude_unset=True) + "\n"
        # Half a line would spoil all that follow: once begun, it is finished.
        async with self._turn:
            with anyio.CancelScope(shield=True):
                try:
                    await self._write(memoryview(line.encode()))
                except OSError as error:
                    self._give_up()
                    raise anyio.BrokenResourceError from error

    async def _write(self, left: memoryview) -> None:
        """Writes so much at a time as a pipe with room takes without blocking.

        The pipe itself is not made non-blocking: it may be other processes' too.
        """
        while left:
            if not self._has_room.poll(0):
                await anyio.wait_writable(self._descriptor)
            left = left[os.write(self._descriptor, left[: select.PIPE_BUF]) :]
