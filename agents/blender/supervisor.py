"""Blender as its callers know it: every call is answered, whatever becomes of the process behind it."""

from __future__ import annotations

import logging
import threading
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any

from agents.blender.checkpoints import WRITTEN, Checkpoint, Checkpoints
from agents.blender.run_folder import SCENE_FILE, RunFolder
from simworlds.folder_lock import locked
from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.errors import (
    BlenderError,
    CannotStart,
    Died,
    LeftBehind,
    Lost,
    NeverBegan,
    OutOfBounds,
    Refusal,
    ToolBroke,
)
from simworlds.sandbox.usage import remove_since

if TYPE_CHECKING:
    from collections.abc import Generator

    from simworlds.sandbox.blender_process import Progress, Reply
    from simworlds.sandbox.launch import Launch

OPEN_SECONDS = 120.0
WRITE_SECONDS = 300.0
_LONGEST_NOTE = 4000
_LOG = logging.getLogger(__name__)


class Supervisor:
    """One Blender for one run, started with ``start`` and ended with ``close``. Calls from several threads wait.

    ``timeout`` is in seconds everywhere. A call that costs Blender its life raises Lost; by then another Blender
    stands where the last checkpoint does, and the message says so. Raises Refusal while another one has the run.
    """

    def __init__(self, launch: Launch, folder: RunFolder) -> None:
        self.folder = folder
        self.launch = launch
        with ExitStack() as held:
            held.enter_context(locked(folder.root))
            self.checkpoints = Checkpoints(folder)
            self._held = held.pop_all()
        self._process: BlenderProcess | None = None
        self._stands: Checkpoint | None = None
        self._note = ""
        self._ending = threading.Event()
        self._lock = threading.RLock()

    def __enter__(self) -> Supervisor:
        try:
            self.start()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def start(self) -> None:
        """Starts Blender where the run stood, or with an empty scene. Raises CannotStart."""
        with self._lock:
            if self._process is None:
                self._start()

    def end(self) -> None:
        """From any thread: from here on no Blender is started any more, whatever becomes of this one."""
        self._ending.set()

    def close(self) -> None:
        """Keeps what has not been kept, and ends Blender. Nothing can be called afterwards."""
        with self._lock:
            self.end()
            process, self._process = self._process, None
            try:
                if process is not None and process.alive and self.checkpoints.unkept:
                    self._write(process, "at the end")
            except BlenderError as error:
                _LOG.warning("What was done since %s is lost: %s", self.checkpoints.last, error)
            finally:
                if process is not None:
                    process.close()
                self.launch.clean()
                self._held.close()

    def kill(self) -> None:
        """From any thread: ends Blender at once; what has not been kept is lost. The next call starts another."""
        process = self._process
        if process is None:
            return
        process.stop()
        if self._lock.acquire(blocking=False):  # otherwise the call that it is in notices
            try:
                process.kill()
            finally:
                self._lock.release()

    @property
    def pid(self) -> int | None:
        """The process that was started (behind bubblewrap: bubblewrap's), None when none runs."""
        return self._process.started if self._process is not None else None

    @property
    def inner_pid(self) -> int | None:
        """Blender's process itself, None when none runs."""
        return self._process.inner if self._process is not None else None

    def call(  # noqa: PLR0913 - what a caller may want to say of a call
        self,
        tool: str,
        arguments: dict[str, Any],
        *,
        timeout: float,
        what: str = "",
        changes: bool = False,
        after: str = "",
        always_keep: bool = False,
        progress: Progress | None = None,
        given_up: threading.Event | None = None,
    ) -> Reply:
        """Runs a tool in Blender; ``what`` is how errors speak of it.

        ``changes``: it may change the scene, so that a checkpoint may be due afterwards, which is called ``after``;
        ``always_keep``: one is taken in any case. Raises BlenderError.
        """
        with self._lock:
            since = self.launch.bounds.fine

            def attempt() -> Reply:
                return self._running().call(
                    tool, arguments, timeout=timeout, what=what, progress=progress, given_up=given_up
                )

            try:
                try:
                    reply = attempt()
                except NeverBegan as error:  # nothing of the call was done: it can be made again
                    self._start_again(str(error))
                    reply = attempt()
                self._check_left(reply, what or tool)
            except Lost as error:
                recovered = self._recovered(error, since)
                if given_up is not None and given_up.is_set():
                    self._add_note(str(recovered))  # nobody hears the error
                raise recovered from error
            except (Refusal, ToolBroke):
                if changes:
                    self.checkpoints.changed(0.0)
                raise
            if changes:
                self.checkpoints.changed(reply.seconds)
                if always_keep:
                    self._keep(after or tool)
                elif self.checkpoints.due:
                    self._try_to_keep(after or tool)
            return reply

    def take_note(self) -> str:
        """In words, what has happened to Blender since this was asked last, and no call has told; "" for nothing."""
        with self._lock:
            note, self._note = self._note, ""
            return note

    @contextmanager
    def alone(self) -> Generator[None]:
        """Keeps other threads' calls out from between several of one's own."""
        with self._lock:
            yield

    def keep(self, after: str) -> Checkpoint:
        """A checkpoint of the state as it is now. Raises BlenderError."""
        with self._lock:
            self._running()
            last = self.checkpoints.last
            if last is not None and not self.checkpoints.unkept:
                return last
            return self._keep(after)

    def restore(self, number: int | None = None) -> Checkpoint:
        """Puts Blender back to a checkpoint, the last one by default. Raises Refusal if it is not kept."""
        with self._lock:
            checkpoint = self.checkpoints.last if number is None else self.checkpoints.find(number)
            if checkpoint is None:
                kept = ", ".join(str(one.number) for one in self.checkpoints.newest_first()[::-1])
                which = "checkpoint" if number is None else f"checkpoint {number}"
                raise Refusal(f"There is no {which}; kept are {kept or 'none'}.")
            process = self._running()
            try:
                self._open(process, checkpoint)
            except (Refusal, ToolBroke) as error:
                process.kill()
                self.checkpoints.changed(0.0)
                raise Refusal(f"{checkpoint} cannot be opened: {error} {self._restarted()}") from error
            except Lost as error:
                raise self._recovered(error) from error
            self._stands = checkpoint
            if checkpoint == self.checkpoints.last:
                self.checkpoints.returned()
            else:
                self.checkpoints.changed(0.0)
                self._keep(f"back to checkpoint {checkpoint.number}")
            return checkpoint

    # Checkpoints

    def _write(self, process: BlenderProcess, after: str) -> Checkpoint:
        arguments = {"path": str(self.launch.private / WRITTEN), "folder": str(self.folder.workspace)}
        try:
            # A disk that runs full is an error of the writing, and costs nothing but this checkpoint.
            reply = process.call(
                "write", arguments, timeout=WRITE_SECONDS, what="writing the scene out", bounded=False
            )
        except ToolBroke as error:
            raise Refusal(f"The scene cannot be written out: {error}.") from error
        return self.checkpoints.keep(after, reply.seconds)

    def _keep(self, after: str) -> Checkpoint:
        assert self._process is not None
        try:
            self._stands = self._write(self._process, after)
        except Refusal as error:
            last = self.checkpoints.last
            raise Refusal(
                f"The state cannot be kept: {error} Blender is well and the scene as it was; "
                f"{f'{last} is untouched' if last else 'there is no checkpoint'}."
            ) from error
        except Lost as error:
            raise self._recovered(error) from error
        return self._stands

    def _try_to_keep(self, after: str) -> None:
        try:
            self._keep(after)
        except Refusal as error:
            self._add_note(str(error))

    # The process

    def _running(self) -> BlenderProcess:
        """The process, started again if it has ended since the last call."""
        process = self._process
        if process is not None and not process.alive:
            process.kill()
            self._start_again("Blender had ended since the last call")
        elif process is None:
            self._start()
        assert self._process is not None
        if not self._process.alive:
            note, self._note = self._note, ""
            raise CannotStart(note or "Blender ends as soon as it is started")
        return self._process

    def _start(self) -> list[str]:
        """A new process, at the newest checkpoint that can be opened; returns why newer ones cannot."""
        faults: list[str] = []
        for checkpoint in (*self.checkpoints.newest_first(), None):
            for attempt in (
                1,
                2,
            ):  # the first may be killed by whoever killed the one before, or for want of memory
                if self._ending.is_set():
                    raise CannotStart("this session is being ended")
                try:
                    self._start_at(checkpoint, newest=not faults)
                except (Lost, Refusal, ToolBroke, CannotStart) as error:
                    if attempt == 1 and isinstance(error.__cause__ or error, Died):
                        continue
                    if isinstance(error, CannotStart):
                        raise
                    said = getattr(error, "printed", "")
                    faults.append(f"{checkpoint or 'an empty scene'}: {error} {said}".strip())
                    break
                return faults
        raise CannotStart(f"Blender runs, but cannot open {'; '.join(faults)[:2000]}")

    def _start_at(self, checkpoint: Checkpoint | None, *, newest: bool) -> None:
        process = self._process = BlenderProcess(self.launch)
        try:
            self._open(process, checkpoint)
            self._stands = checkpoint
            self.checkpoints.returned()
            if checkpoint is None or not newest:  # Blender stands where the newest one is, always
                after = "an empty scene" if checkpoint is None else f"back to checkpoint {checkpoint.number}"
                self._stands = self._write(process, after)
        except BaseException:
            process.kill()
            raise

    def _open(self, process: BlenderProcess, checkpoint: Checkpoint | None) -> None:
        """Opens a checkpoint in the place of the run's own file, so that what lies beside that is found."""
        arguments: dict[str, Any] = {"path": None, "folder": str(self.folder.workspace)}
        if checkpoint is not None:
            arguments["path"] = str(self.folder.put(checkpoint.path, SCENE_FILE))
        what = f"opening {checkpoint or 'an empty scene'}"
        process.call("open", arguments, timeout=OPEN_SECONDS, what=what, bounded=False)

    def _check_left(self, reply: Reply, what: str) -> None:
        """Raises LeftBehind for a call that returned, but not whole."""
        if reply.left:
            assert self._process is not None
            self._process.kill()
            raise LeftBehind(
                f"When {what} returned, it left {' and '.join(reply.left)}, which would spoil the calls after it. "
                "Blender was stopped",
                (reply.stdout + reply.stderr)[-2000:],
            )

    def _recovered(self, error: Lost, since: int | None = None) -> Lost:
        """``error``, with where Blender stands after a new one was started.

        ``since``: when the limits were last kept; past them, what was written since then is removed.
        """
        undone = ""
        if isinstance(error, OutOfBounds) and since is not None:
            for folder in self.launch.folders:
                remove_since(folder, since)
            undone = " The files that it wrote were removed."
        return type(error)(f"{error}.{undone} {self._restarted()}", error.printed, error.ending)

    def _restarted(self) -> str:
        """Starts Blender again; tells in words where it stands."""
        lost = self.checkpoints.unkept
        try:
            return self._standing(lost, self._start())
        except CannotStart as error:
            return f"Another Blender could not be started: {error}."

    def _start_again(self, why: str) -> None:
        """Starts Blender again between two calls, and notes it for the reply of the next. Raises CannotStart."""
        lost = self.checkpoints.unkept
        self._add_note(f"{why}. {self._standing(lost, self._start())}")

    def _add_note(self, note: str) -> None:
        self._note = f"{self._note} {note}".strip()[-_LONGEST_NOTE:]

    def _standing(self, lost: int, faults: list[str]) -> str:
        where = f"A new Blender stands at {self._stands}"
        if faults:
            return f"{where}, for what came later cannot be opened: {'; '.join(faults)[:1000]}."
        if lost:
            calls = "last call" if lost == 1 else f"last {lost} calls"
            return f"{where}; what the {calls} before had changed since then is lost, too."
        return f"{where}, which is how the scene was before."
