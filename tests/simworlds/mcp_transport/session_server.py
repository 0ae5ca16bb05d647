"""An MCP server with sessions, as a process of its own; most four unfinished ones, for SECONDS (its first argument)."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import mcp_types as types
from mcp.server.lowlevel import Server
from small_server import serve

from simworlds.mcp_transport.sessions import EndUnfinishedSessions

if TYPE_CHECKING:
    from mcp.server.transport_security import TransportSecuritySettings
    from starlette.types import ASGIApp

UNFINISHED = 4
SESSIONS = 6


async def _no_tools(_context: Any, _params: Any) -> types.ListToolsResult:
    return types.ListToolsResult(tools=[])


def _make_app(path: str, security: TransportSecuritySettings) -> ASGIApp:
    app = Server("test", on_list_tools=_no_tools).streamable_http_app(
        streamable_http_path=path, max_sessions=SESSIONS, transport_security=security
    )
    return EndUnfinishedSessions(app, path, most=UNFINISHED, seconds=float(sys.argv[1]))


if __name__ == "__main__":
    serve(_make_app)
