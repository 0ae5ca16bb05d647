"""Bounds a server's connections: how many there are, from one address and in all, and how long a client may keep the
server waiting.
"""

from __future__ import annotations

import errno
import ipaddress
import socket
import time
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from uvicorn.protocols.http.h11_impl import H11Protocol

if TYPE_CHECKING:
    import asyncio

PATIENCE_SECONDS = 15.0
_MOST = 1000
_DESCRIPTORS = 4096  # programs that are started inherit the limit, and some try every descriptor below it
_UNKNOWN_LIMIT = 256  # where the system does not say
_NETWORK_BITS = 64  # of an IPv6 address; one customer has the rest to itself
_NO_DESCRIPTOR = {errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM}
_SAME_LOOK_SECONDS = 0.5
_FULL = (
    b"HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nRetry-After: 1\r\n"
    b"Content-Type: text/plain\r\nContent-Length: 21\r\n\r\nToo many connections\n"
)


@dataclass(frozen=True, slots=True)
class ConnectionLimits:
    """Most connections in all, from one address, and accepted at one go; seconds that a client may take to send a
    request, to send the next one, or to read what it is sent.
    """

    total: int
    per_address: int
    at_once: int
    patience: float = PATIENCE_SECONDS


def connection_limits(patience: float = PATIENCE_SECONDS) -> ConnectionLimits:
    """Limits that leave half of the process's descriptors to everything else; raises a low soft limit first."""
    descriptors = _descriptors()
    total = max(2, min(_MOST, descriptors // 2))
    return ConnectionLimits(total, total // 2, max(1, descriptors // 16), patience)


def _descriptors() -> int:
    try:
        import resource  # noqa: PLC0415 - Windows has none
    except ImportError:
        return _UNKNOWN_LIMIT
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft == resource.RLIM_INFINITY:
        return _DESCRIPTORS
    wanted = _DESCRIPTORS if hard == resource.RLIM_INFINITY else min(hard, _DESCRIPTORS)
    if soft >= wanted:
        return soft
    try:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
    except (OSError, ValueError):  # the system has a lower limit of its own
        return soft
    return wanted


class Connection(Protocol):
    """What the book of connections needs of one."""

    has_served: bool

    def abort(self) -> None:
        """Closes it at once; what was not sent yet is lost."""


class ConnectionBook:
    """The open connections by address, and since when the server waits for which client."""

    def __init__(self, limits: ConnectionLimits) -> None:
        self._limits = limits
        self._open: dict[Connection, str] = {}
        self._of_address: Counter[str] = Counter()
        self._waiting: dict[Connection, float] = {}  # longest first

    def admit(self, connection: Connection, host: str) -> bool:
        """Takes in a new connection; where that is one too many, another one that the server waits for is closed.

        False if there is none, because all are being served: the new one is to be closed.
        """
        address = _address(host)
        if self._of_address[address] >= self._limits.per_address:
            has_room = self._drop_one(address)
        else:
            has_room = len(self._open) < self._limits.total or self._drop_one()
        if has_room:
            self._open[connection] = address
            self._of_address[address] += 1
            self._waiting[connection] = time.monotonic()
        return has_room

    def wait_for(self, connection: Connection) -> None:
        """Notes that it is the client's turn: the first call since ``serve`` starts the clock."""
        if connection in self._open:
            self._waiting.setdefault(connection, time.monotonic())

    def serve(self, connection: Connection) -> None:
        """Notes that it is the server's turn: the connection stays however long that takes."""
        self._waiting.pop(connection, None)

    def forget(self, connection: Connection) -> None:
        """Takes a connection out that is closed."""
        self._waiting.pop(connection, None)
        if (address := self._open.pop(connection, None)) is not None:
            self._of_address[address] -= 1
            if not self._of_address[address]:
                del self._of_address[address]

    def drop_overdue(self) -> None:
        """Closes the connections whose clients have kept the server waiting too long."""
        overdue = time.monotonic() - self._limits.patience
        while self._waiting:
            connection, since = next(iter(self._waiting.items()))
            if since > overdue:
                return
            self._drop(connection)

    def _drop_one(self, address: str | None = None) -> bool:
        """Closes the one whose client is slowest, of those that never sent a request if there are any."""
        candidates = [
            connection for connection in self._waiting if address is None or self._open[connection] == address
        ]
        if candidates:
            self._drop(min(candidates, key=lambda connection: connection.has_served))
        return bool(candidates)

    def _drop(self, connection: Connection) -> None:
        self.forget(connection)
        connection.abort()


def _address(host: str) -> str:
    try:
        address = ipaddress.ip_address(host.partition("%")[0])
    except ValueError:
        return host
    if address.version == 4:
        return host
    return str(ipaddress.ip_network((address, _NETWORK_BITS), strict=False))


class BoundedProtocol(H11Protocol):
    """HTTP/1.1 on one connection, entered in the book."""

    def __init__(self, book: ConnectionBook, **parameters: Any) -> None:
        super().__init__(**parameters)
        self._book = book
        self.has_served = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Closes the connection again where it is one too many."""
        super().connection_made(transport)
        if not self._book.admit(self, self.client[0] if self.client else ""):
            transport.write(_FULL)
            transport.close()

    def connection_lost(self, exc: Exception | None) -> None:
        """Ends the request that is being served."""
        self._book.forget(self)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Begins to serve a request once all of it is here."""
        super().data_received(data)
        self._note_turn()

    def on_response_complete(self) -> None:
        """Goes on with the next request."""
        self.has_served = True
        super().on_response_complete()
        self._note_turn()

    def pause_writing(self) -> None:
        """Waits for the client to read."""
        super().pause_writing()
        self._note_turn()

    def resume_writing(self) -> None:
        """Goes on to write."""
        super().resume_writing()
        self._note_turn()

    def abort(self) -> None:
        """Closes the connection at once."""
        self.transport.abort()

    def _note_turn(self) -> None:
        cycle = self.cycle
        if not cycle or cycle.more_body or cycle.response_complete or self.flow.write_paused:
            self._book.wait_for(self)
        else:
            self._book.serve(self)


class Listener(socket.socket):
    """A listening socket that tells asyncio once, not for every connection in the queue, that no descriptor is left.

    asyncio then logs it, and looks again after a second.
    """

    def __init__(self, listening: socket.socket) -> None:
        """Takes ``listening`` over."""
        super().__init__(listening.family, listening.type, listening.proto, listening.detach())
        self._told = float("-inf")

    def accept(self) -> tuple[socket.socket, Any]:
        """Accepts a connection. Raises BlockingIOError where the last look has just failed, and OSError."""
        if time.monotonic() - self._told < _SAME_LOOK_SECONDS:
            raise BlockingIOError
        try:
            return super().accept()
        except OSError as error:
            if error.errno in _NO_DESCRIPTOR:
                self._told = time.monotonic()
            raise
