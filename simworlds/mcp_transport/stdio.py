"""Serves any MCP server on stdio: one client, and nothing but the protocol on stdout."""

from __future__ import annotations

import os
import signal
import sys
from io import TextIOWrapper
from typing import TYPE_CHECKING, Any

import anyio
from mcp.server.stdio import stdio_server

if TYPE_CHECKING:
    from collections.abc import Callable

    from mcp.server.lowlevel import Server


def run_stdio(server: Server[Any], stop: Callable[[], None]) -> None:
    """Serves one client on stdin and stdout until it closes them; other output goes to stderr.

    ``stop`` is called when a signal ends the process; nothing else is cleaned up then.
    """
    # Redirected from here to the end, not only while serving: imports and the shutdown may print too.
    wire = os.fdopen(os.dup(1), "wb", closefd=False)
    os.dup2(2, 1)
    _end_on_signals(stop)
    anyio.run(_serve, server, TextIOWrapper(wire, encoding="utf-8"))


async def _serve(server: Server[Any], out: TextIOWrapper) -> None:
    async with stdio_server(stdout=anyio.wrap_file(out)) as (read, write):
        await server.run(read, write, server.create_initialization_options())


def _end_on_signals(stop: Callable[[], None]) -> None:
    """Ends the process at once: the thread that waits for a line on stdin cannot be interrupted."""

    def end(_number: int, _frame: object) -> None:
        stop()
        sys.stderr.flush()
        os._exit(0)

    signal.signal(signal.SIGINT, end)
    signal.signal(signal.SIGTERM, end)
