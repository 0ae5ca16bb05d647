"""One Blender for a run that survives crashes: a lost process is replaced, from the last checkpoint."""

from __future__ import annotations

import logging
import secrets
import threading
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any

from agents.blender.files.checkpoints import Checkpoint, Checkpoints
from agents.blender.files.run_folder import SCENE_FILE, RunFolder
from simworlds.folder_lock import locked
from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.errors import (
    BlenderError,
    CannotStart,
    Died,
    LeftBehind,
    LimitExceeded,
    Lost,
    NeverBegan,
    Refusal,
    ToolBroke,
)
from simworlds.sandbox.pictures.picture_decoder import PictureDecoder
from simworlds.sandbox.replies import Reader, T, nothing

if TYPE_CHECKING:
    from collections.abc import Generator

    from simworlds.sandbox.blender_process import Progress, WorkerReply
    from simworlds.sandbox.launch import Launch

OPEN_SECONDS = 120.0
WRITE_SECONDS = 300.0
_WRITE_LEAST = 60.0  # seconds in which a checkpoint is written, if the last one was quick
_WRITE_TIMES = 20.0  # as long as the last one took
_LONGEST_NOTE = 4000
_LOG = logging.getLogger(__name__)


class Supervisor:
    """One Blender for one run, started with ``start`` and ended with ``close``. Calls from several threads take turns.

    ``timeout`` is in seconds everywhere. A call during which Blender is lost raises Lost; by then a new Blender has
    been started from the last checkpoint, as the message says. Raises Refusal if the run is in use.
    """

    def __init__(self, launch: Launch, folder: RunFolder) -> None:
        self.folder = folder
        self.launch = launch
        with ExitStack() as held:
            held.enter_context(locked(folder.root))
            self.checkpoints = Checkpoints(folder)
            self._held = held.pop_all()
        self.pictures = PictureDecoder(launch.sandbox)
        self._process: BlenderProcess | None = None
        self._current: Checkpoint | None = None
        self._note = ""
        self._noted: set[str] = set()
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
        """Starts Blender from the last checkpoint, or with an empty scene. Raises CannotStart."""
        with self._lock:
            if self._process is None:
                self._start()

    def end(self) -> None:
        """From any thread: no further Blender is started from here on."""
        self._ending.set()

    def close(self) -> None:
        """Takes a checkpoint of changes not kept yet, and ends Blender. Nothing can be called afterwards."""
        with self._lock:
            self.end()
            process, self._process = self._process, None
            try:
                if process is not None and process.alive and self.checkpoints.unkept:
                    self._write(process, "at the end")
            except BlenderError as error:
                _LOG.warning("The changes since %s are lost: %s", self.checkpoints.last, error)
            finally:
                if process is not None:
                    process.close()
                self.pictures.close()
                self.launch.clean()
                self._held.close()

    def kill(self) -> None:
        """From any thread: ends Blender at once; unkept changes are lost. The next call starts a new one."""
        process = self._process
        if process is None:
            return
        process.stop()
        if self._lock.acquire(blocking=False):  # otherwise the running call notices
            try:
                process.kill()
            finally:
                self._lock.release()

    @property
    def pid(self) -> int | None:
        """The process that was started (with bubblewrap: bubblewrap's); None when none runs."""
        return self._process.started if self._process is not None else None

    @property
    def inner_pid(self) -> int | None:
        """Blender's own process; None when none runs."""
        return self._process.inner if self._process is not None else None

    def call(  # noqa: PLR0913 - what a caller may want to say of a call
        self,
        tool: str,
        arguments: dict[str, Any],
        read: Reader[T],
        *,
        timeout: float,
        what: str = "",
        changes: bool = False,
        after: str = "",
        always_keep: bool = False,
        progress: Progress | None = None,
        printed: bool = False,
        cancelled: threading.Event | None = None,
    ) -> WorkerReply[T]:
        """Runs a tool in Blender; ``what`` names it in errors. ``read`` makes a value of what it returned.

        ``changes``: it may change the scene, so a checkpoint may be due, described by ``after``; ``always_keep``: take
        one in any case. ``printed``: lines that the tool prints are reported as its progress. Raises BlenderError.
        """
        with self._lock:
            since = self.launch.usage.last_within_limits

            def attempt() -> WorkerReply[T]:
                return self._running().call(
                    tool,
                    arguments,
                    read,
                    timeout=timeout,
                    what=what,
                    progress=progress,
                    printed=printed,
                    cancelled=cancelled,
                )

            try:
                try:
                    reply = attempt()
                except NeverBegan as error:  # nothing of the call was done, so it can be repeated
                    self._start_again(str(error))
                    reply = attempt()
                self._check_left(reply, what or tool)
            except Lost as error:
                recovered = self._recover(error, since)
                if cancelled is not None and cancelled.is_set():
                    self._add_note(str(recovered))  # nobody receives the error
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
        """What happened to Blender that no reply has mentioned yet, in words; "" for nothing."""
        with self._lock:
            note, self._note = self._note, ""
            return note

    def note_once(self, note: str) -> None:
        """Puts a note before the next reply, unless it stood before an earlier one."""
        with self._lock:
            if note not in self._noted:
                self._noted.add(note)
                self._add_note(note)

    @contextmanager
    def alone(self) -> Generator[None]:
        """Keeps calls of other threads out until the body has ended."""
        with self._lock:
            yield

    def keep(self, after: str) -> Checkpoint:
        """The checkpoint of the current state, taken if there is none yet. Raises BlenderError."""
        with self._lock:
            self._running()
            last = self.checkpoints.last
            if last is not None and not self.checkpoints.unkept:
                return last
            return self._keep(after)

    def restore(self, number: int | None = None) -> Checkpoint:
        """Goes back to a checkpoint, the last one by default, in a new Blender: code that has run in the old one can
        have changed that. Raises Refusal if there is no such checkpoint.
        """
        with self._lock:
            checkpoint = self.checkpoints.last if number is None else self.checkpoints.find(number)
            if checkpoint is None:
                kept = ", ".join(
                    str(checkpoint.number) for checkpoint in self.checkpoints.newest_first()[::-1]
                )
                which = "checkpoint" if number is None else f"checkpoint {number}"
                raise Refusal(f"There is no {which}. Available: {kept or 'none'}.")
            if self._process is not None:
                self._process.kill()
            self._process = BlenderProcess(self.launch)
            try:
                self._open(self._process, checkpoint)
            except (Refusal, ToolBroke) as error:
                self._process.kill()
                self.checkpoints.changed(0.0)
                raise Refusal(f"{checkpoint} cannot be opened: {error} {self._restart()}") from error
            except Lost as error:
                raise self._recover(error) from error
            self._current = checkpoint
            if checkpoint == self.checkpoints.last:
                self.checkpoints.returned()
            else:
                self.checkpoints.changed(0.0)
                self._keep(f"back to checkpoint {checkpoint.number}")
            return checkpoint

    # Checkpoints

    def _write(self, process: BlenderProcess, after: str) -> Checkpoint:
        # By a name that code cannot know beforehand, and so cannot have occupied.
        name = f"{secrets.token_hex(8)}.blend"
        folder = self.folder.workspace.for_blender()
        arguments = {"path": self.folder.private.for_blender(name), "folder": folder}
        seconds = min(WRITE_SECONDS, max(_WRITE_LEAST, _WRITE_TIMES * self.checkpoints.cost))
        try:
            # A full disk is an error of the writing, and costs only this checkpoint.
            reply = process.call(
                "write", arguments, nothing, timeout=seconds, what="writing the scene out", limited=False
            )
        except ToolBroke as error:
            raise Refusal(f"The scene cannot be written out: {error}.") from error
        return self.checkpoints.keep(name, after, reply.seconds)

    def _keep(self, after: str) -> Checkpoint:
        assert self._process is not None
        try:
            self._current = self._write(self._process, after)
        except Refusal as error:
            last = self.checkpoints.last
            raise Refusal(
                f"No checkpoint could be taken: {error} Blender still runs, and the scene is unchanged; "
                f"{f'{last} is unchanged too' if last else 'there is no earlier checkpoint'}."
            ) from error
        except Lost as error:
            raise self._recover(error) from error
        return self._current

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
        """Starts a process at the newest checkpoint that can be opened; returns why newer ones cannot."""
        faults: list[str] = []
        for checkpoint in (*self.checkpoints.newest_first(), None):
            # The first attempt may be killed by what killed the process before, or for lack of memory.
            for attempt in (1, 2):
                if self._ending.is_set():
                    raise CannotStart("this session is being ended")
                try:
                    self._start_at(checkpoint, newest=not faults)
                except (Lost, Refusal, ToolBroke, CannotStart) as error:
                    if attempt == 1 and isinstance(error.__cause__ or error, Died):
                        continue
                    if isinstance(error, CannotStart):
                        raise
                    output = getattr(error, "printed", "")
                    faults.append(f"{checkpoint or 'an empty scene'}: {error} {output}".strip())
                    break
                return faults
        raise CannotStart(f"Blender starts, but cannot open {'; '.join(faults)[:2000]}")

    def _start_at(self, checkpoint: Checkpoint | None, *, newest: bool) -> None:
        process = self._process = BlenderProcess(self.launch)
        try:
            self._open(process, checkpoint)
            self._current = checkpoint
            self.checkpoints.returned()
            if checkpoint is None or not newest:  # the scene is always that of the newest checkpoint
                after = "an empty scene" if checkpoint is None else f"back to checkpoint {checkpoint.number}"
                self._current = self._write(process, after)
        except BaseException:
            process.kill()
            raise

    def _open(self, process: BlenderProcess, checkpoint: Checkpoint | None) -> None:
        """Opens a checkpoint at the path of the run's own file, so that files beside that are found.

        ``process`` is a new one: no code has run in it that could put another file in that place.
        """
        workspace = self.folder.workspace
        arguments: dict[str, Any] = {"path": None, "folder": workspace.for_blender()}
        if checkpoint is not None:
            workspace.put(checkpoint.path, SCENE_FILE)
            arguments["path"] = workspace.for_blender(SCENE_FILE)
        what = f"opening {checkpoint or 'an empty scene'}"
        process.call("open", arguments, nothing, timeout=OPEN_SECONDS, what=what, limited=False)

    def _check_left(self, reply: WorkerReply[Any], what: str) -> None:
        """Raises LeftBehind for a call that returned, but not whole."""
        if reply.left:
            assert self._process is not None
            self._process.kill()
            raise LeftBehind(
                f"When {what} returned, it left {' and '.join(reply.left)}, which would break later calls. "
                "Blender was stopped",
                (reply.stdout + reply.stderr)[-2000:],
            )

    def _recover(self, error: Lost, since: int | None = None) -> Lost:
        """Starts Blender again; returns ``error`` with what the scene is now.

        ``since``: when usage was last within its limits; after LimitExceeded, files written since then are removed.
        """
        undone = ""
        if isinstance(error, LimitExceeded) and since is not None:
            for folder in self.launch.folders:
                folder.remove_since(since)
            undone = " The files that it wrote were removed."
        return type(error)(f"{error}.{undone} {self._restart()}", error.printed, error.ending)

    def _restart(self) -> str:
        """Starts Blender again; says in words what the scene is now."""
        lost = self.checkpoints.unkept
        try:
            return self._describe_scene(lost, self._start())
        except CannotStart as error:
            return f"A new Blender could not be started: {error}."

    def _start_again(self, why: str) -> None:
        """Starts Blender again between two calls, with a note for the next reply. Raises CannotStart."""
        lost = self.checkpoints.unkept
        self._add_note(f"{why}. {self._describe_scene(lost, self._start())}")

    def _add_note(self, note: str) -> None:
        self._note = f"{self._note} {note}".strip()[-_LONGEST_NOTE:]

    def _describe_scene(self, lost: int, faults: list[str]) -> str:
        where = f"A new Blender was started from {self._current}"
        if faults:
            return f"{where}, because later checkpoints cannot be opened: {'; '.join(faults)[:1000]}."
        if lost:
            calls = "last call" if lost == 1 else f"last {lost} calls"
            return f"{where}; the changes of the {calls} before it are lost too."
        return f"{where}, which is the scene as it was before."
