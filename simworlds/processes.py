"""Processes that are started, watched and ended with everything that they have started."""

from __future__ import annotations

import queue
import signal
import subprocess
import threading
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, cast

from simworlds.operating_system import SYSTEM

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

_TAIL_BYTES = 4_000
_TAIL_LINES = 15


class CommandFailed(Exception):  # noqa: N818 - reads as the state it names
    """A command ended badly or had to be ended; ``tail`` is the end of what it printed."""

    def __init__(self, fault: str, tail: str) -> None:
        self.tail = tail
        super().__init__(f"{fault}; it said: {tail}" if tail else f"{fault}, and said nothing")


class CommandTimedOut(CommandFailed):
    """A command was stopped at its deadline."""


class _Spawner:
    """A thread that never ends, to start processes in.

    On Linux, a process that asks to end with its parent ends with the *thread* that started it. A thread that serves
    one call and ends would take its processes with it.
    """

    def __init__(self) -> None:
        self._jobs: queue.SimpleQueue[
            tuple[Callable[[], subprocess.Popen[bytes]], Future[subprocess.Popen[bytes]]]
        ] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    def run(self, start: Callable[[], subprocess.Popen[bytes]]) -> subprocess.Popen[bytes]:
        with self._lock:
            if self._thread is None or not self._thread.is_alive():
                self._thread = threading.Thread(target=self._serve, name="spawner", daemon=True)
                self._thread.start()
        future: Future[subprocess.Popen[bytes]] = Future()
        self._jobs.put((start, future))
        return future.result()

    def _serve(self) -> None:
        while True:
            start, future = self._jobs.get()
            try:
                future.set_result(start())
            except BaseException as error:
                future.set_exception(error)
            del start, future


_spawner = _Spawner()


def spawn(command: Sequence[str], **popen: Any) -> subprocess.Popen[bytes]:
    """Starts a command in a process group of its own; ``popen``: further arguments of subprocess.Popen.

    The thread that starts it never ends, so a command that ends with its parent ends with this whole process. Without
    ``stdin``, the command has none. Raises OSError.
    """
    return _spawner.run(lambda: _start(command, popen))


def _start(command: Sequence[str], popen: dict[str, Any]) -> subprocess.Popen[bytes]:
    given: dict[str, Any] = {"stdin": subprocess.DEVNULL, **popen, **SYSTEM.own_group()}
    return cast("subprocess.Popen[bytes]", subprocess.Popen(list(command), **given))


def kill_group(pid: int) -> None:
    """Kills a process that was started in a group of its own, and whatever it left running in that group."""
    SYSTEM.kill_group(pid)


def end_group(process: subprocess.Popen[bytes]) -> None:
    """Kills a process that ``spawn`` started, with its group, and waits until it is gone."""
    kill_group(process.pid)
    process.wait()


def run_group(
    command: Sequence[str],
    *,
    environment: dict[str, str],
    timeout: float,
    log: Path,
    folder: Path | None = None,
) -> None:
    """Runs a command in a process group of its own, in ``folder``, its output in the file ``log``.

    The whole group is killed when the command has ended, when it has not ended after ``timeout`` seconds, and when the
    caller is interrupted. Raises CommandTimedOut, and CommandFailed for a command that cannot start or ends with any
    exit code but 0.
    """
    with log.open("wb") as output:
        try:
            # By this thread, which waits for it: a thread of the spawner's would keep the caller from forking later.
            given = {"stdout": output, "stderr": subprocess.STDOUT, "env": environment, "cwd": folder}
            process = _start(command, given)
        except OSError as error:
            raise CommandFailed(f"{command[0]} cannot be started ({error})", "") from error
        try:
            code = process.wait(timeout)
        except subprocess.TimeoutExpired:
            raise CommandTimedOut(f"it was stopped after {timeout:.0f} s", _tail(log)) from None
        finally:
            end_group(process)
    if code != 0:
        raise CommandFailed(describe_exit(code), _tail(log))


def signal_name(code: int) -> str:
    """The name of the signal that ended a process with this (negative) exit code, as ``"SIGKILL"``."""
    try:
        return signal.Signals(-code).name
    except ValueError:
        return f"signal {-code}"


def describe_exit(code: int) -> str:
    """How a process ended, by its exit code as subprocess tells it."""
    return f"it ended with exit code {code}" if code >= 0 else f"it was ended by {signal_name(code)}"


def _tail(log: Path) -> str:
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - _TAIL_BYTES))
        lines = file.read().decode(errors="replace").strip().splitlines()
    return "\n".join(lines[-_TAIL_LINES:])
