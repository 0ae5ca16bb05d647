"""Serves any MCP server on stdio: one client, and nothing but the protocol on stdout."""

from __future__ import annotations

import os
import signal
import stat
import sys
from typing import TYPE_CHECKING, Any

import anyio

from simworlds.terminal.lines import write_line

if TYPE_CHECKING:
    from collections.abc import Callable

    from mcp.server.lowlevel import Server


def run_stdio(server: Server[Any], stop: Callable[[], None]) -> None:
    """Serves one client on stdin and stdout until it closes them; other output goes to stderr.

    ``stop`` is called when a signal ends the process; nothing else is cleaned up then.
    """
    if os.isatty(0):
        write_line(
            sys.stderr,
            "Waiting for an MCP client on standard input: clients start this command. Ctrl-C ends it.",
        )
    # Redirected from here to the end, not only while serving: imports and the shutdown may print too, and processes
    # that are started must not read the client's messages.
    source, sink = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    _end_on_signals(stop)
    anyio.run(_serve_pipes if _is_pipe(source) and _is_pipe(sink) else _serve_files, server, source, sink)


def _is_pipe(descriptor: int) -> bool:
    """Whether the event loop can wait for it. Windows has no such pipes."""
    mode = os.fstat(descriptor).st_mode
    return sys.platform != "win32" and (stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode))


async def _serve_pipes(server: Server[Any], source: int, sink: int) -> None:
    from simworlds.mcp_transport.pipes import PipeReader, PipeWriter  # noqa: PLC0415 - not on Windows

    with anyio.CancelScope() as serving:
        await server.run(
            PipeReader(source), PipeWriter(sink, serving.cancel), server.create_initialization_options()
        )


async def _serve_files(server: Server[Any], source: int, sink: int) -> None:
    from mcp.server.stdio import stdio_server  # noqa: PLC0415 - not for pipes

    # Not closed at the end: the thread that waits for a line may still be there.
    lines = open(source, encoding="utf-8", errors="replace", closefd=False)  # noqa: SIM115
    out = open(sink, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    async with stdio_server(anyio.wrap_file(lines), anyio.wrap_file(out)) as (read, write):
        await server.run(read, write, server.create_initialization_options())


def _end_on_signals(stop: Callable[[], None]) -> None:
    """Ends the process at once: a thread that waits for a line on stdin cannot be interrupted."""

    def end(_number: int, _frame: object) -> None:
        stop()
        sys.stderr.flush()
        os._exit(0)

    signal.signal(signal.SIGINT, end)
    signal.signal(signal.SIGTERM, end)
