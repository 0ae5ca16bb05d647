"""Serves any MCP server over streamable HTTP, with a bearer token and a check of host names."""

from __future__ import annotations

import contextlib
import hmac
import math
import re
import signal
import socket
import sys
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import uvicorn
from mcp.server.transport_security import TransportSecuritySettings
from starlette.datastructures import Headers
from starlette.responses import Response

from simworlds.errors import UserError
from simworlds.loopback import is_loopback
from simworlds.mcp_transport.connections import (
    PATIENCE_SECONDS,
    BoundedProtocol,
    ConnectionBook,
    Listener,
    connection_limits,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from starlette.types import ASGIApp, Receive, Scope, Send

PATH = "/mcp"
_LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
_ANY = {"0.0.0.0", "::"}  # noqa: S104 - compared with, not bound to
_HERE = "127.0.0.1"  # by which this machine reaches a server on any address
_HOSTS = {b"host", b"origin"}
_HOST = re.compile(r"(?:[\w.-]+|\[[0-9a-fA-F:.]+\])(?::\d{1,5})?")  # as a client sends it
_BACKLOG = 1024
_GRACE_SECONDS = 3


class CannotServe(UserError):  # noqa: N818 - reads as the state it names
    """The server cannot start with this address or token, or cannot go on."""


@dataclass(frozen=True, slots=True)
class Address:
    """Where to listen, and which clients are accepted.

    ``port`` 0 takes a free one. Clients must send ``token`` as a bearer token, if there is one. ``names`` are
    further host names of the server, besides ``host`` and this machine's own.
    """

    host: str = "127.0.0.1"
    port: int = 0
    token: str = ""
    names: tuple[str, ...] = ()


def run_http(
    make_app: Callable[[str, TransportSecuritySettings], ASGIApp],
    address: Address,
    what: str,
    patience: float = PATIENCE_SECONDS,
) -> None:
    """Serves until Ctrl-C or SIGTERM. Raises CannotServe, saying what to do.

    ``make_app`` makes the application from the path where it answers, and the host names and origins that it
    accepts. ``what`` names the service on stderr. A client that keeps the server waiting for ``patience`` seconds is
    disconnected.
    """
    check(address)
    listener = _listen(address)
    limits = connection_limits(patience)
    book = ConnectionBook(limits)
    config = uvicorn.Config(
        _guarded(make_app(PATH, _security(address)), address),
        # What is installed beside uvicorn must not take the connections over: only these are bounded.
        loop="asyncio",
        http=partial(BoundedProtocol, book),  # pyright: ignore[reportArgumentType] - is only called
        ws="none",
        lifespan="on",
        backlog=limits.at_once,
        log_level="error",  # anybody can cause warnings
        use_colors=False,
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=_GRACE_SECONDS,
        # uvicorn's own 5 s are what clients' pools keep an idle connection for: a request sent at that moment is lost.
        timeout_keep_alive=math.ceil(patience),
    )
    server = _Server(config, book)
    sys.stderr.write(f"Serving {what} at {url(address.host, listener)}\n")
    sys.stderr.flush()
    # uvicorn raises the signal that ended it again after the shutdown; that must not look like a crash.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        server.run(sockets=[listener])
    except KeyboardInterrupt:
        pass
    finally:
        listener.close()
    if server.has_lost_app:
        raise CannotServe(f"The server of {what} ended after an error of its own. Start it again.")


class _Server(uvicorn.Server):
    """A server that looks after its connections, and ends with its application."""

    def __init__(self, config: uvicorn.Config, book: ConnectionBook) -> None:
        super().__init__(config)
        self._book = book
        self.has_lost_app = False

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begins to serve."""
        await super().startup(sockets)
        for listener in sockets or ():
            listener.listen(_BACKLOG)  # asyncio has set it to the number that it accepts at one go

    async def on_tick(self, counter: int) -> bool:
        """Whether to end; called ten times a second."""
        self._book.drop_overdue()
        # Without what runs beside the requests, each of them would fail.
        self.has_lost_app = self.lifespan.shutdown_event.is_set()
        return self.has_lost_app or await super().on_tick(counter)


def check(address: Address) -> None:
    """Raises CannotServe for an address that other machines can reach, unless there is a token, and for further names
    that no client can send.
    """
    for name in address.names:
        if _HOST.fullmatch(name) is None:
            raise CannotServe(
                f"--allow-host {name!r} is not a host name. Write it as docs.example.org, without https:// and path; "
                "an IPv6 address in brackets."
            )
    if not address.token.strip() and not is_loopback(address.host):
        raise CannotServe(
            f"Other machines can reach the server on {address.host}, so it needs a token. Set SIMWORLDS_TOKEN (or "
            "--token) to a secret, which clients send as 'Authorization: Bearer …'. To make one: "
            "python -c 'import secrets; print(secrets.token_urlsafe())'. To do without, serve on 127.0.0.1."
        )


def _guarded(app: ASGIApp, address: Address) -> ASGIApp:
    return _small_hosts(RequireToken(app, address.token.strip()) if address.token.strip() else app)


def _small_hosts(app: ASGIApp) -> ASGIApp:
    """The names of hosts in small letters, as they are compared."""

    async def call(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            headers = [(key, value.lower() if key in _HOSTS else value) for key, value in scope["headers"]]
            scope = {**scope, "headers": headers}
        await app(scope, receive, send)

    return call


def url(host: str, listener: socket.socket) -> str:
    """The URL for clients on this machine."""
    port = listener.getsockname()[1]
    host = _HERE if host in _ANY else host
    return f"http://{f'[{host}]' if ':' in host else host}:{port}{PATH}"


class RequireToken:
    """Answers 401 to requests without the bearer token; passes on the others."""

    def __init__(self, app: ASGIApp, token: str) -> None:
        self._app = app
        self._token = token.encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """ASGI."""
        if scope["type"] == "http" and not self._carries_token(Headers(scope=scope)):
            refusal = Response(
                "Unauthorized: send the server's token in the header 'Authorization: Bearer …'.\n",
                status_code=401,
                headers={"WWW-Authenticate": "Bearer"},
            )
            await refusal(scope, receive, send)
            return
        await self._app(scope, receive, send)

    def _carries_token(self, headers: Headers) -> bool:
        scheme, _, sent = headers.get("authorization", "").partition(" ")
        token = sent.encode(
            "latin-1"
        ).strip()  # of bytes: letters of other alphabets may look like blanks here
        # In constant time: how long it takes must not tell how much of a guess is right.
        is_right = hmac.compare_digest(token, self._token)
        return is_right and scheme.lower() == "bearer"


def _security(address: Address) -> TransportSecuritySettings:
    """Accepts requests whose Host header is one of this server's names (others would be DNS rebinding)."""
    names = dict.fromkeys([*_LOOPBACK, *_bracketed(address.host), *address.names])
    if address.host in _ANY:
        names |= dict.fromkeys(_own_names())
    # Clients send names in small letters, and Windows calls itself in capitals.
    lower = dict.fromkeys(name.lower() for name in names)
    hosts = [entry for name in lower for entry in (name, f"{name}:*")]
    return TransportSecuritySettings(
        enable_dns_rebinding_protection=True,
        allowed_hosts=hosts,
        allowed_origins=[f"{scheme}://{host}" for host in hosts for scheme in ("http", "https")],
    )


def _bracketed(host: str) -> list[str]:
    if host in _ANY:
        return []
    return [f"[{host}]" if ":" in host else host]


def _own_names() -> list[str]:
    name = socket.gethostname()
    names = [name, socket.getfqdn()]
    with contextlib.suppress(OSError):
        names += [str(entry[4][0]) for entry in socket.getaddrinfo(name, None)]
    return [bracketed for known in names for bracketed in _bracketed(known)]


def _listen(address: Address) -> Listener:
    family = socket.AF_INET6 if ":" in address.host else socket.AF_INET
    try:
        listener = socket.create_server(
            (address.host, address.port),
            family=family,
            backlog=_BACKLOG,
            dualstack_ipv6=address.host in _ANY and family == socket.AF_INET6 and socket.has_dualstack_ipv6(),
        )
    except OSError as error:
        raise CannotServe(
            f"Cannot listen on {address.host}, port {address.port}: {error.strerror or error}. "
            "Choose another one with --host or --port."
        ) from error
    # Connections inherit it. asyncio sets it only on sockets with an explicit protocol; without it each answer,
    # sent in two pieces, waits 40 ms for the client to acknowledge the first.
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return Listener(listener)
