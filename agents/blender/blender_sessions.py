"""Which client works with which Blender: every one with its own, in a run's folder of its own."""

from __future__ import annotations

import asyncio
import logging
import shutil
import sys
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import anyio
import anyio.to_thread

from agents.blender.launch import make_launch, runs_folder
from agents.blender.run_folder import RunFolder, new_run
from agents.blender.supervisor import Supervisor
from agents.blender.tools.base import ToolContext, parse, perform
from simworlds.sandbox.errors import BlenderError, CannotStart, Refusal

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from agents.blender.tools.base import BlenderTool, Call, Docs, Result
    from simworlds.sandbox.confined_command import Sandbox

CLOSE_SECONDS = 5.0
_LEAVE_SECONDS = 60.0  # for who leaves while the server goes on: a large scene takes long to write
_LOOK_SECONDS = 30.0  # between two looks at who has been idle, at most

_LOG = logging.getLogger(__name__)


def _on_stderr(line: str) -> None:
    sys.stderr.write(f"{line}\n")
    sys.stderr.flush()


@dataclass(frozen=True, slots=True)
class SessionSetup:
    """What every studio is set up with.

    ``run`` is the folder to work in; None: a fresh one for each client. ``read``: folders that Blender may read.
    ``tell`` gets what its user should know, in a line.
    """

    sandbox: Sandbox
    version: str | None = None
    blender_exe: Path | None = None
    read: tuple[Path, ...] = ()
    run: Path | None = None
    tell: Callable[[str], object] = _on_stderr


class BlenderSession:
    """One client's Blender, and the thread that works with it: calls are run one by one, in the order they come in.

    ``folder`` is the run to go on with; None: a new one, or the one of the set-up.
    """

    def __init__(self, setup: SessionSetup, folder: RunFolder | None = None) -> None:
        self.folder = folder
        self._setup = setup
        self._blender: Supervisor | None = None
        self._ended = False
        self._unused = False
        self._closing: Future[None] | None = None
        self._lock = threading.Lock()
        self._waiting: set[threading.Event] = set()
        self._used = time.monotonic()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="blender")

    @property
    def idle(self) -> float:
        """Seconds since the last call; 0 while one runs."""
        return 0.0 if self._waiting else time.monotonic() - self._used

    def start(self) -> None:
        """Starts Blender in the background; what goes wrong is logged, and told to whoever calls a tool."""
        self._thread.submit(self._started)

    async def use(
        self, tool: BlenderTool, arguments: dict[str, Any] | None, call: Call, about: Callable[[str], Docs]
    ) -> Result:
        """Calls a tool, to which ``about`` gives a way to look up things of this Blender's version.

        Cancelled, it gives the call up: Blender is killed and put back. Raises BlenderError.
        """
        self._waiting.add(call.cancelled)
        try:
            try:
                future = self._thread.submit(self._use, tool, arguments, call, about)
            except RuntimeError as error:
                raise Refusal("This session has been ended.") from error
            return await asyncio.wrap_future(future)
        except asyncio.CancelledError:
            call.cancelled.set()
            raise
        finally:
            self._waiting.discard(call.cancelled)
            self._used = time.monotonic()

    def give_up(self) -> None:
        """From any thread: whatever runs is to end, and nothing is begun any more."""
        self._ended = True
        for cancelled in tuple(self._waiting):
            cancelled.set()
        if self._blender is not None:
            self._blender.end()

    def close(self, seconds: float = CLOSE_SECONDS) -> None:
        """From any thread but its own: gives up what runs, keeps the scene, ends Blender, within ``seconds``."""
        self.give_up()
        with self._lock:
            if self._closing is None:
                self._closing = self._thread.submit(self._close)
                self._thread.shutdown(wait=False)
        try:
            self._closing.result(seconds)
        except TimeoutError:
            if self._blender is not None:
                self._blender.kill()
        except Exception:
            _LOG.exception("Blender could not be ended as it should")

    # In the studio's own thread

    def _started(self) -> None:
        try:
            self._running()
        except BlenderError as error:
            _LOG.error("%s", error)
        except Exception:
            _LOG.exception("Blender could not be started")

    def _use(
        self, tool: BlenderTool, arguments: dict[str, Any] | None, call: Call, about: Callable[[str], Docs]
    ) -> Result:
        asked = parse(tool, arguments)
        blender = self._running()
        if call.cancelled.is_set():
            raise Refusal(f"{tool.name} was given up before it began.")
        self._unused = False
        return perform(tool, ToolContext(blender, about(blender.launch.runtime.version)), asked, call)

    def _running(self) -> Supervisor:
        if self._ended:
            raise Refusal("This session has been ended.")
        if self._blender is None:
            self._blender = self._begin()
            self._blender.start()
        return self._blender

    def _begin(self) -> Supervisor:
        setup = self._setup
        try:
            if self.folder is None:
                self._unused = setup.run is None
                self.folder = RunFolder.make(setup.run) if setup.run else new_run(runs_folder())
            launch = make_launch(
                self.folder.workspace,
                version=setup.version,
                blender_exe=setup.blender_exe,
                sandbox=setup.sandbox,
                read=setup.read,
            )
        except OSError as error:
            raise CannotStart(f"There is no folder to work in: {error}") from error
        try:
            blender = Supervisor(launch, self.folder)
        except BaseException:
            launch.clean()
            raise
        setup.tell(f"Blender {launch.runtime.version} works in {self.folder.root}")
        return blender

    def _close(self) -> None:
        if self._blender is not None:
            self._blender.close()
        if self._unused and self.folder is not None:  # nobody has asked anything of it
            shutil.rmtree(self.folder.root, ignore_errors=True)


class BlenderSessions:
    """The studios of a server, by client: at most so many at once, each closed after ``idle`` seconds without a call.

    A client whose studio was closed that way finds its run as it was left.
    """

    def __init__(self, setup: SessionSetup, *, at_most: int = 1, idle: float | None = None) -> None:
        self._setup = setup
        self._at_most = 1 if setup.run else at_most
        self._idle = idle
        self._open: dict[str, BlenderSession] = {}
        self._left: dict[str, RunFolder] = {}
        self._ended = False
        self._lock = anyio.Lock()

    def start(self, client: str) -> None:
        """Starts a client's Blender in the background, before anybody asks. Raises Refusal."""
        self._admit()
        session = self._open[client] = BlenderSession(self._setup)
        session.start()

    async def get(self, client: str) -> BlenderSession:
        """The client's studio. Raises Refusal when it has none and there are too many."""
        if (found := self._open.get(client)) is not None:
            return found
        # Who is just leaving is waited for.
        async with self._lock:
            if client not in self._open:
                self._admit()
                self._open[client] = BlenderSession(self._setup, self._left.pop(client, None))
            return self._open[client]

    def _admit(self) -> None:
        if self._ended:
            raise Refusal("This server is ending.")
        if len(self._open) < self._at_most:
            return
        if self._setup.run:
            raise Refusal(
                f"This server works in one folder, {self._setup.run}, and another session has it. End that "
                "session, or start the server without --run: every session then has a folder of its own."
            )
        raise Refusal(
            f"{len(self._open)} sessions have a Blender open here, and no more may (--sessions). End one of "
            "them, or wait until one has been idle for long enough."
        )

    async def end(self, client: str) -> None:
        """The client has left: closes its studio, if it has one."""
        await self._close(client)
        self._left.pop(client, None)

    async def watch(self) -> None:
        """Closes idle studios until it is cancelled."""
        if self._idle is None:
            return
        while True:
            await anyio.sleep(min(self._idle / 4, _LOOK_SECONDS))
            for client in [client for client, session in self._open.items() if session.idle > self._idle]:
                await self._close(client, self._idle)

    async def _close(self, client: str, idle: float = 0.0) -> None:
        async with self._lock:
            session = self._open.get(client)
            if session is None or session.idle < idle:
                return
            del self._open[client]
            with anyio.CancelScope(shield=True):
                await anyio.to_thread.run_sync(session.close, _LEAVE_SECONDS)
            if session.folder is not None:
                self._left[client] = session.folder

    def close(self, seconds: float = CLOSE_SECONDS) -> None:
        """Closes all studios for good, within ``seconds``."""
        self._ended = True
        deadline = time.monotonic() + seconds
        sessions = tuple(self._open.values())
        for session in sessions:
            session.give_up()
        for session in sessions:
            session.close(max(0.1, deadline - time.monotonic()))
