"""A small application behind ``run_http``, as a process of its own: ``python small_server.py PATIENCE DESCRIPTORS``."""

from __future__ import annotations

import asyncio
import resource
import socket
import subprocess
import sys
from typing import TYPE_CHECKING, Any

from simworlds.mcp_transport.http import Address, CannotServe, run_http

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from mcp.server.transport_security import TransportSecuritySettings
    from starlette.types import ASGIApp

LARGE = 8 * 1024 * 1024


class SmallServer:
    """The process from outside."""

    def __init__(
        self, log: Path, *, patience: float = 60.0, descriptors: int = 128, script: str = __file__
    ) -> None:
        self._log = log
        with log.open("w") as stderr:
            self.process = subprocess.Popen(
                [sys.executable, script, str(patience), str(descriptors)],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=stderr,
                text=True,
            )
        assert self.process.stdout is not None
        self.port = int(self.process.stdout.readline())

    def __enter__(self) -> SmallServer:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate()

    @property
    def log(self) -> str:
        """What it has printed on stderr."""
        return self._log.read_text()

    def connect(self, content: bytes = b"", *, source: str = "127.0.0.1") -> socket.socket:
        """A connection on which ``content`` was sent."""
        connection = socket.create_connection(("127.0.0.1", self.port), 30, source_address=(source, 0))
        connection.sendall(content)
        return connection

    def get(self, path: str = "/", *, source: str = "127.0.0.1") -> str:
        """All that comes back for a request, on a connection of its own."""
        with self.connect(request(path, "Connection: close"), source=source) as connection:
            return read(connection)


def request(path: str = "/", *headers: str) -> bytes:
    """A GET request."""
    return "\r\n".join([f"GET {path} HTTP/1.1", "Host: x", *headers, "", ""]).encode()


def read(connection: socket.socket) -> str:
    """What comes until the server closes the connection."""
    content = bytearray()
    while True:
        try:
            piece = connection.recv(65536)
        except ConnectionError:
            break
        if not piece:
            break
        content += piece
    return content.decode()


def is_ok(connection: socket.socket) -> bool:
    """Whether the answer ``ok`` comes; leaves the connection open."""
    return begins(connection) and connection.recv(2) == b"ok"


def begins(connection: socket.socket) -> bool:
    """Whether an answer comes; its body is left."""
    content = b""
    while not content.endswith(b"\r\n\r\n") and (piece := connection.recv(1)):
        content += piece
    return content.startswith(b"HTTP/1.1 200 ")


class _App:
    """``/``: ``ok`` for a whole request; ``/large``: LARGE bytes; ``/wait``: no body until ``/go``; ``/break``: the
    end of the application; ``/open``: takes all descriptors; ``/close``: gives them back.
    """

    def __init__(self) -> None:
        self._go = asyncio.Event()
        self._broken = asyncio.Event()
        self._taken: list[Any] = []

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        if scope["type"] == "lifespan":
            await receive()
            await send({"type": "lifespan.startup.complete"})
            ended, broken = asyncio.ensure_future(receive()), asyncio.ensure_future(self._broken.wait())
            await asyncio.wait([ended, broken], return_when=asyncio.FIRST_COMPLETED)
            if self._broken.is_set():
                raise RuntimeError("broken on request")
            await send({"type": "lifespan.shutdown.complete"})
            return
        message = await receive()
        while message.get("more_body"):
            message = await receive()
        if message["type"] == "http.disconnect":
            return
        body = b"ok"
        match scope["path"]:
            case "/large":
                body = b"x" * LARGE
            case "/go":
                self._go.set()
            case "/break":
                self._broken.set()
            case "/open":
                self._take_all()
            case "/close":
                while self._taken:
                    self._taken.pop().close()
            case _:
                pass
        length = (b"content-length", str(len(body)).encode())
        await send({"type": "http.response.start", "status": 200, "headers": [length]})
        if scope["path"] == "/wait":
            await self._go.wait()
        await send({"type": "http.response.body", "body": body})

    def _take_all(self) -> None:
        try:
            while True:
                self._taken.append(open("/dev/null"))  # noqa: PTH123, SIM115 - kept open
        except OSError:
            pass


def serve(make_app: Callable[[str, TransportSecuritySettings], ASGIApp]) -> None:
    """Serves as the arguments of the process say; prints the port."""
    patience, descriptors = float(sys.argv[1]), int(sys.argv[2])
    resource.setrlimit(resource.RLIMIT_NOFILE, (descriptors, descriptors))
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]

    def announced(path: str, security: TransportSecuritySettings) -> ASGIApp:
        sys.stdout.write(f"{port}\n")  # connections are taken from here on
        sys.stdout.flush()
        return make_app(path, security)

    try:
        run_http(announced, Address(port=port), "a test", patience)
    except CannotServe as error:
        sys.exit(f"Error: {error}")


if __name__ == "__main__":
    serve(lambda _path, _security: _App())
