"""Connections whose messages are answered in turn; whatever a client does, the others go on."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from typing import TYPE_CHECKING

from agents.blender.drop_in.messages import MessageSplitter, NotMessages

if TYPE_CHECKING:
    import socket
    from collections.abc import Awaitable, Callable

MOST = 64
"""Connections at once."""
_PATIENCE = 30.0  # seconds that the rest of a message may keep waiting
_LINGER = 2.0  # seconds for a client to read why its connection is closed
_LAST_REPLIES = 1.0  # seconds for replies to be sent when the server ends
_CHUNK = 1 << 16

_LOG = logging.getLogger(__name__)


class _Connection:
    """One client's connection; ``busy`` while a message of it is being answered."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer
        self.busy = False
        self.used = time.monotonic()

    async def send(self, reply: bytes) -> None:
        self.writer.write(reply)
        await self.writer.drain()

    async def close(self) -> None:
        """Closes it so that the client still gets what was sent: unread input would make that vanish."""
        with contextlib.suppress(OSError, TimeoutError):
            self.writer.write_eof()
            async with asyncio.timeout(_LINGER):
                while await self.reader.read(_CHUNK):
                    pass
        self.drop()

    def drop(self) -> None:
        """Closes it at once."""
        self.writer.transport.abort()


class Connections:
    """The connections of a server. ``answer`` makes a reply of a message; ``refuse`` makes one of an error's text.

    When there are too many, the one that was idle for longest is closed.
    """

    def __init__(
        self,
        answer: Callable[[bytes], Awaitable[bytes]],
        refuse: Callable[[str], bytes],
        *,
        most: int = MOST,
        patience: float = _PATIENCE,
    ) -> None:
        self._answer, self._refuse = answer, refuse
        self._most, self._patience = most, patience
        self._open: dict[asyncio.Task[None], _Connection] = {}

    async def serve(self, listener: socket.socket, ending: asyncio.Event, end: Callable[[], None]) -> None:
        """Serves until ``ending`` is set; then calls ``end`` in a thread, which ends the running calls."""
        server = await asyncio.start_server(self._connected, sock=listener, limit=_CHUNK)
        try:
            await ending.wait()
        finally:
            server.close()
            await asyncio.to_thread(end)
            if busy := [task for task, connection in self._open.items() if connection.busy]:
                await asyncio.wait(busy, timeout=_LAST_REPLIES)
            for task, connection in [*self._open.items()]:
                connection.drop()
                task.cancel()
            await asyncio.gather(*self._open, return_exceptions=True)

    async def _connected(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        connection = _Connection(reader, writer)
        room = self._make_room()
        self._open[task] = connection
        try:
            if room:
                await self._answer_all(connection)
            else:
                await connection.send(
                    self._refuse(f"{len(self._open) - 1} clients are waiting for replies; no more are taken.")
                )
                await connection.close()
        except (OSError, asyncio.CancelledError):
            pass  # the client has gone, or the server ends
        except Exception:
            _LOG.exception("A connection was closed after an error")
        finally:
            connection.drop()
            del self._open[task]

    def _make_room(self) -> bool:
        """Whether there is room for one more, after the longest idle connection was closed if need be."""
        if len(self._open) < self._most:
            return True
        idle = [connection for connection in self._open.values() if not connection.busy]
        if not idle:
            return False
        min(idle, key=lambda connection: connection.used).drop()
        return True

    async def _answer_all(self, connection: _Connection) -> None:
        splitter = MessageSplitter()
        try:
            while data := await self._read(connection, splitter):
                for message in splitter.feed(data):
                    connection.busy = True
                    try:
                        reply = await self._answer(message)
                    finally:
                        connection.busy, connection.used = False, time.monotonic()
                    await connection.send(reply)
        except NotMessages as error:
            await connection.send(self._refuse(str(error)))
            await connection.close()
        except TimeoutError:
            await connection.send(
                self._refuse(
                    f"Half a message came, and nothing more for {self._patience:g} s. The connection is closed."
                )
            )
            await connection.close()

    async def _read(self, connection: _Connection, splitter: MessageSplitter) -> bytes:
        """What the client sends next; b"" when it has gone. Raises TimeoutError."""
        async with asyncio.timeout(self._patience if splitter.has_begun else None):
            return await connection.reader.read(_CHUNK)
