"""One server of documentation for many sessions, each of which would start its own: that takes as long as a Blender."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mcp.client.stdio import StdioServerParameters, stdio_client
from mcp.client.streamable_http import streamable_http_client

from agents.blender import docs_client

if TYPE_CHECKING:
    import pytest


def share_docs(patch: pytest.MonkeyPatch, url: str) -> None:
    """Has the sessions of this process ask the server at ``url``; those of other options than none start their own."""

    def connected(server: StdioServerParameters, **more: Any) -> Any:
        return streamable_http_client(url) if server.args[-1] == "serve" else stdio_client(server, **more)

    patch.setattr(docs_client, "stdio_client", connected)
