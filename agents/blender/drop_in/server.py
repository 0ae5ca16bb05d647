"""Stands in for blender-mcp's add-on: its socket, with a supervised Blender behind it instead of an open one."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import signal
import socket
import sys
from typing import TYPE_CHECKING

from agents.blender.blender_sessions import BlenderSession
from agents.blender.drop_in.commands import Commands, failure
from agents.blender.drop_in.connections import Connections
from simworlds.sandbox.errors import CannotStart
from simworlds.sandbox.launch import find_blender

if TYPE_CHECKING:
    from agents.blender.blender_sessions import SessionSetup
    from agents.blender.drop_in.screenshot_places import ScreenshotPlaces

PORT = 9876
"""Where clients of blender-mcp look unless they are told otherwise."""
_HOST = "127.0.0.1"  # nothing else: the protocol knows no password


def run_drop_in(setup: SessionSetup, port: int, seconds: float, places: ScreenshotPlaces) -> None:
    """Serves until Ctrl-C or SIGTERM, then keeps the scene. Raises CannotStart, saying what to do.

    ``seconds``: how long code may run. Port 0 takes a free one. All clients work in one scene, as in one open Blender.
    """
    version = find_blender(setup.version, setup.blender_exe).version
    with contextlib.closing(_listen(port)) as listener:
        session = BlenderSession(setup)
        session.start()
        taken = listener.getsockname()[1]
        _say(f"Serving Blender {version} to clients of blender-mcp at {_HOST}:{taken}. Ctrl-C ends it.")
        if taken != PORT:
            _say(f"Start these clients with BLENDER_PORT={taken}.")
        asyncio.run(_serve(listener, session, Commands(session, version, seconds, places)))
    if session.folder is not None and session.folder.root.exists():
        _say(f"Ended. To go on with this scene: --run {session.folder.root}")


async def _serve(listener: socket.socket, session: BlenderSession, commands: Commands) -> None:
    ending = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, ending.set)
    await Connections(commands.answer, failure).serve(listener, ending, session.close)


def _listen(port: int) -> socket.socket:
    """The socket on which clients are awaited. Raises CannotStart."""
    try:
        return socket.create_server((_HOST, port))
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise CannotStart(
                f"Port {port} is taken, perhaps by blender-mcp's add-on in an open Blender, or by another simworlds. "
                f"Stop that, or choose another port with --port and give it to the client as BLENDER_PORT."
            ) from error
        raise CannotStart(
            f"Port {port} cannot be used: {error.strerror}. Choose another with --port."
        ) from error


def _say(line: str) -> None:
    sys.stderr.write(f"{line}\n")
    sys.stderr.flush()
