"""Streamable HTTP for any MCP server: who may reach it, and who may ask."""

from __future__ import annotations

import contextlib
import hmac
import ipaddress
import signal
import socket
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

import uvicorn
from mcp.server.transport_security import TransportSecuritySettings
from starlette.datastructures import Headers
from starlette.responses import Response

from kb_serve.errors import KBServeError

if TYPE_CHECKING:
    from collections.abc import Callable

    from starlette.types import ASGIApp, Receive, Scope, Send

PATH = "/mcp"
_LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
_ANY = {"0.0.0.0", "::"}  # noqa: S104 - compared with, not bound to
_BACKLOG = 1024
_GRACE_SECONDS = 3


class CannotServe(KBServeError):  # noqa: N818 - reads as the state it names
    """The server cannot be started as asked."""


@dataclass(frozen=True, slots=True)
class Address:
    """Where to listen, and who is let in.

    ``port`` 0 takes a free one. ``token`` is what clients must send as a bearer token. ``names`` are host
    names by which clients reach the server, besides ``host`` and this machine's own.
    """

    host: str = "127.0.0.1"
    port: int = 0
    token: str = ""
    names: tuple[str, ...] = ()


def run_http(
    make_app: Callable[[str, TransportSecuritySettings], ASGIApp], address: Address, what: str
) -> None:
    """Serves until Ctrl-C or SIGTERM. Raises CannotServe, saying what to do.

    ``make_app`` makes the application from the path where it is to answer, and the host names and origins that it
    is to let in. ``what`` is served, in words for stderr.
    """
    check(address)
    listener = _listen(address)
    config = uvicorn.Config(
        _guarded(make_app(PATH, _security(address)), address),
        log_level="warning",
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=_GRACE_SECONDS,
    )
    server = uvicorn.Server(config)
    sys.stderr.write(f"Serving {what} at {url(address.host, listener)}\n")
    sys.stderr.flush()
    # uvicorn raises the signal that ended it once more, when all is done; that must not look like a crash.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        server.run(sockets=[listener])
    except KeyboardInterrupt:
        pass
    finally:
        listener.close()


def check(address: Address) -> None:
    """Refuses to let the network in without a token. Raises CannotServe."""
    if not address.token and not is_loopback(address.host):
        raise CannotServe(
            f"On {address.host} others could reach the server: that takes a token. Set SIMWORLDS_TOKEN (or "
            "give --token) to a secret, which clients send as 'Authorization: Bearer …'; to make one: "
            "python -c 'import secrets; print(secrets.token_urlsafe())'. Without a token, stay on 127.0.0.1."
        )


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach ``host``."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _guarded(app: ASGIApp, address: Address) -> ASGIApp:
    return RequireToken(app, address.token) if address.token else app


def url(host: str, listener: socket.socket) -> str:
    """The address for a client on this machine."""
    port = listener.getsockname()[1]
    return f"http://{f'[{host}]' if ':' in host else host}:{port}{PATH}"


class RequireToken:
    """Lets requests through that carry the bearer token."""

    def __init__(self, app: ASGIApp, token: str) -> None:
        self._app = app
        self._token = token.encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """ASGI."""
        if scope["type"] == "http" and not self._carries_token(Headers(scope=scope)):
            refusal = Response(
                "Send the server's token: Authorization: Bearer …\n",
                status_code=401,
                headers={"WWW-Authenticate": "Bearer"},
            )
            await refusal(scope, receive, send)
            return
        await self._app(scope, receive, send)

    def _carries_token(self, headers: Headers) -> bool:
        scheme, _, token = headers.get("authorization", "").partition(" ")
        # Compared as a whole: how long it takes must not tell how much of a guess is right.
        right = hmac.compare_digest(token.strip().encode("latin-1"), self._token)
        return right and scheme.lower() == "bearer"


def _security(address: Address) -> TransportSecuritySettings:
    """Lets in who uses a name of this server: another one would be a web page's that points here."""
    names = dict.fromkeys([*_LOOPBACK, *_bracketed(address.host), *address.names])
    if address.host in _ANY:
        names |= dict.fromkeys(_own_names())
    hosts = [entry for name in names for entry in (name, f"{name}:*")]
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
    found = [name, socket.getfqdn()]
    with contextlib.suppress(OSError):
        found += [str(entry[4][0]) for entry in socket.getaddrinfo(name, None)]
    return [entry for one in found for entry in _bracketed(one)]


def _listen(address: Address) -> socket.socket:
    family = socket.AF_INET6 if ":" in address.host else socket.AF_INET
    try:
        listener = socket.create_server((address.host, address.port), family=family, backlog=_BACKLOG)
    except OSError as error:
        raise CannotServe(
            f"Cannot listen on {address.host}, port {address.port}: {error.strerror or error}. "
            "Give another one (--host, --port)."
        ) from error
    # Connections inherit it. asyncio sets it only on sockets that name their protocol, and without it each
    # answer, sent in two pieces, waits 40 ms for the client to acknowledge the first.
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return listener
