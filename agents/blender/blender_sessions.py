"""The clients of a server: each has its own Blender, in its own run folder."""

from __future__ import annotations

import asyncio
import logging
import shutil
import sys
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, cast

import anyio
import anyio.to_thread

from agents.blender.files.run_folder import RunFolder, new_run
from agents.blender.jobs import SessionJobs
from agents.blender.launch import make_launch, runs_folder
from agents.blender.supervisor import Supervisor
from agents.blender.tools import job
from agents.blender.tools.base import ToolContext, parse, perform
from simworlds.sandbox.errors import BlenderError, CannotStart, Refusal

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from agents.blender.assets.library import AssetLibrary
    from agents.blender.tools.base import BlenderTool, Call, Knowledge, Result
    from simworlds.sandbox.confinement.confined_command import Sandbox

CLOSE_SECONDS = 5.0
_LEAVE_SECONDS = 60.0  # to close one session while the server runs: a large scene takes long to write
_MOST_LEFT = 100  # sessions that were closed, whose clients may come back
_CHECK_SECONDS = 30.0  # at most, between two checks for idle sessions

_LOG = logging.getLogger(__name__)


def _on_stderr(line: str) -> None:
    sys.stderr.write(f"{line}\n")
    sys.stderr.flush()


@dataclass(frozen=True, slots=True)
class SessionSetup:
    """How sessions are set up.

    ``run`` is the folder to work in; None: a new one for each client. ``read``: folders that Blender may read.
    ``assets``: the user's asset library, which it may read too; ``online``: more may be fetched into
    it. ``tell`` gets lines for the server's user.
    """

    sandbox: Sandbox
    version: str | None = None
    blender_exe: Path | None = None
    read: tuple[Path, ...] = ()
    run: Path | None = None
    assets: Path | None = None
    online: bool = False
    tell: Callable[[str], object] = _on_stderr

    @property
    def readable(self) -> tuple[Path, ...]:
        """All folders that Blender may read."""
        return (*self.read, *([self.assets] if self.assets is not None else []))


class BlenderSession:
    """One client's Blender, with a thread that runs its calls one by one, in order.

    ``folder`` is the run to continue; None: the one of ``setup``, or a new one. ``jobs``: those of an earlier session
    of the client, whose results it may still fetch.
    """

    def __init__(
        self, setup: SessionSetup, folder: RunFolder | None = None, jobs: SessionJobs | None = None
    ) -> None:
        self.folder = folder
        self.jobs = jobs or SessionJobs()
        self._setup = setup
        self._blender: Supervisor | None = None
        self._ended = False
        self._unused = False
        self._closing: Future[None] | None = None
        self._lock = threading.Lock()
        self._waiting: set[threading.Event] = set()
        self._used = time.monotonic()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="blender")
        self._assets: AssetLibrary | None = None
        if setup.assets is not None:
            from agents.blender.assets.library import open_library  # noqa: PLC0415 - slows the start
            from agents.blender.assets.poly_haven import PolyHaven  # noqa: PLC0415

            self._assets = open_library(setup.assets, PolyHaven() if setup.online else None)

    @property
    def idle(self) -> float:
        """Seconds since the last call; 0 while one runs."""
        return 0.0 if self._waiting else time.monotonic() - self._used

    def start(self) -> None:
        """Starts Blender in the background. Errors are logged, and raised again by the first call."""
        self._thread.submit(self._started)

    async def use(
        self,
        tool: BlenderTool,
        arguments: dict[str, Any] | None,
        call: Call,
        about: Callable[[str], Knowledge],
    ) -> Result:
        """Calls a tool; ``about`` gives the knowledge base of a Blender version.

        If this is cancelled, so is the call: Blender is killed and restarted. Jobs go on. Raises BlenderError.
        """
        try:
            if tool is job.TOOL:
                asked = cast("job.JobArguments", parse(tool, arguments))
                return await self.jobs.use(asked, call, partial(self._submit, about=about))
            self.jobs.check_free(tool.name)
            return await asyncio.wrap_future(self._submit(tool, arguments, call, about))
        except asyncio.CancelledError:
            call.cancelled.set()
            raise
        finally:
            self._used = time.monotonic()

    def _submit(
        self,
        tool: BlenderTool,
        arguments: dict[str, Any] | None,
        call: Call,
        about: Callable[[str], Knowledge],
    ) -> Future[Result]:
        """Lets the session's thread run a call after those before it. Raises Refusal."""

        def end(_future: Future[Result]) -> None:
            self._waiting.discard(call.cancelled)
            self._used = time.monotonic()

        self._waiting.add(call.cancelled)
        try:
            future = self._thread.submit(self._use, tool, arguments, call, about)
        except RuntimeError as error:
            self._waiting.discard(call.cancelled)
            raise Refusal("This session has ended.") from error
        future.add_done_callback(end)
        return future

    def cancel(self) -> None:
        """From any thread: cancels running and waiting calls; new ones are refused."""
        self._ended = True
        for cancelled in tuple(self._waiting):
            cancelled.set()
        if self._blender is not None:
            self._blender.end()

    def close(self, seconds: float = CLOSE_SECONDS) -> None:
        """From any other thread: cancels calls, keeps the scene and ends Blender, within ``seconds``."""
        self.cancel()
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
            _LOG.exception("Blender could not be closed properly")

    # In the session's own thread

    def _started(self) -> None:
        try:
            self._running()
        except BlenderError as error:
            _LOG.error("%s", error)
        except Exception:
            _LOG.exception("Blender could not be started")

    def _use(
        self,
        tool: BlenderTool,
        arguments: dict[str, Any] | None,
        call: Call,
        about: Callable[[str], Knowledge],
    ) -> Result:
        parsed = parse(tool, arguments)
        blender = self._running()
        if call.cancelled.is_set():
            raise Refusal(f"{tool.name} was cancelled before it began.")
        self._unused = False
        call.begin()
        if call.job:
            blender.keep(f"before {call.job}")
        known = about(blender.launch.runtime.version)
        return perform(tool, ToolContext(blender, known.docs, known.check, self._assets), parsed, call)

    def _running(self) -> Supervisor:
        if self._ended:
            raise Refusal("This session has ended.")
        if self._blender is None:
            self._blender = self._begin()
            self._blender.start()
        return self._blender

    def _begin(self) -> Supervisor:
        setup = self._setup
        try:
            folder = self._in_folder()
            launch = make_launch(
                folder.workspace,
                version=setup.version,
                blender_exe=setup.blender_exe,
                sandbox=setup.sandbox,
                read=setup.readable,
            )
            # Refuses a folder that another session works in, and leaves it as it is.
            blender = Supervisor(launch, folder)
        except OSError as error:
            root = setup.run or runs_folder()
            why = f"{error.filename or root}: {error.strerror or error}"
            raise CannotStart(f"The run folder {root} cannot be used: {why}.") from error
        setup.tell(f"Blender {launch.runtime.version} works in {folder.root}")
        return blender

    def _in_folder(self) -> RunFolder:
        """The session's folder, made if there is none yet. Raises OSError."""
        if self.folder is None:
            self._unused = self._setup.run is None
            self.folder = RunFolder.make(self._setup.run) if self._setup.run else new_run(runs_folder())
        return self.folder

    def _close(self) -> None:
        if self._blender is not None:
            self._blender.close()
        if self._unused and self.folder is not None:
            shutil.rmtree(self.folder.root, ignore_errors=True)


class BlenderSessions:
    """The sessions of a server by client: ``at_most`` at once, each closed after ``idle`` seconds without a call.

    A client whose session was closed that way continues its run with the next call. ``new`` makes a session.
    """

    def __init__(
        self,
        setup: SessionSetup,
        *,
        at_most: int = 1,
        idle: float | None = None,
        new: Callable[[SessionSetup, RunFolder | None, SessionJobs | None], BlenderSession] = BlenderSession,
    ) -> None:
        self._setup = setup
        self._new = new
        self._at_most = 1 if setup.run else at_most
        self._idle = idle
        self._open: dict[str, BlenderSession] = {}
        self._left: dict[str, tuple[RunFolder, SessionJobs]] = {}
        self._ended = False
        self._lock = anyio.Lock()

    @property
    def has_assets(self) -> bool:
        """Whether there is an asset library."""
        return self._setup.assets is not None

    @property
    def is_online(self) -> bool:
        """Whether more assets may be fetched into the library."""
        return self.has_assets and self._setup.online

    def start(self, client: str) -> None:
        """Starts a client's Blender in the background, before its first call. Raises Refusal."""
        self._admit()
        session = self._open[client] = self._new(self._setup, None, None)
        session.start()

    async def get(self, client: str) -> BlenderSession:
        """The client's session, a new one if it has none. Raises Refusal if there are too many."""
        if (session := self._open.get(client)) is not None:
            return session
        # Waits for a session that is being closed.
        async with self._lock:
            if client not in self._open:
                self._admit()
                folder, jobs = self._left.pop(client, (None, None))
                self._open[client] = self._new(self._setup, folder, jobs)
            return self._open[client]

    def _admit(self) -> None:
        if self._ended:
            raise Refusal("This server is shutting down.")
        if len(self._open) < self._at_most:
            return
        if self._setup.run:
            raise Refusal(
                f"Another session is using this server's only folder, {self._setup.run}. End that session, or start "
                "the server without --run, which gives every session its own folder."
            )
        raise Refusal(
            f"All {len(self._open)} sessions that this server allows (--sessions) are in use. End one of them, or "
            "wait until an idle one is closed."
        )

    async def end(self, client: str) -> None:
        """Closes the session of a client that has left, if it has one."""
        await self._close(client)
        self._left.pop(client, None)

    async def watch(self) -> None:
        """Closes idle sessions until it is cancelled."""
        if self._idle is None:
            return
        while True:
            await anyio.sleep(min(self._idle / 4, _CHECK_SECONDS))
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
                self._left[client] = session.folder, session.jobs
            while len(self._left) > _MOST_LEFT:
                del self._left[next(iter(self._left))]  # the one that was left first

    def close(self, seconds: float = CLOSE_SECONDS) -> None:
        """Closes all sessions for good, within ``seconds``."""
        self._ended = True
        deadline = time.monotonic() + seconds
        sessions = tuple(self._open.values())
        for session in sessions:
            session.cancel()
        for session in sessions:
            session.close(max(0.1, deadline - time.monotonic()))
