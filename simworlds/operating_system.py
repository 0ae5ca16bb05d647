"""What differs between Linux, macOS and Windows, in one place: ends of processes, locks, priorities, layouts.

Everything else of the project may be written as if there were one system. ``POSIX`` and ``WINDOWS`` are told apart by
what they do, not by names, so that tests can try either on any machine.
"""

from __future__ import annotations

import contextlib
import os
import shlex
import signal
import subprocess
import sys
import threading
import time
from typing import IO, TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

_LOCK_SECONDS = 0.05
_STILL_ACTIVE = 259  # of GetExitCodeProcess
_ASK_ONLY = 0x1000  # PROCESS_QUERY_LIMITED_INFORMATION
_REFUSED = 5  # ERROR_ACCESS_DENIED
_NEW_GROUP = 0x0200  # CREATE_NEW_PROCESS_GROUP
_BELOW_NORMAL = 0x4000


class System(Protocol):
    """An operating system, as far as the project needs to know which one it is.

    ``limits_processes``: whether a process can be forked and held to limits, as reading untrusted pages takes.
    """

    limits_processes: bool

    def is_running(self, pid: int) -> bool:
        """Whether there is a process of that number."""
        ...

    def own_group(self) -> Mapping[str, Any]:
        """The arguments of subprocess.Popen that give a process a group of its own, which Ctrl-C does not reach."""
        ...

    def kill_group(self, pid: int) -> None:
        """Kills a process that was started in a group of its own, with all that it started. It may be gone."""
        ...

    def lock(self, file: IO[Any], *, wait: bool) -> None:
        """Locks an open file for this process until it is closed. Raises OSError while another has it, or waits."""
        ...

    def yield_to_others(self) -> None:
        """Lowers this process's priority, as far as the system lets it."""
        ...

    def cores(self) -> int:
        """How many cores this process may use, as far as the system tells."""
        ...

    def python_in(self, environment: Path) -> Path:
        """The interpreter of a virtual environment."""
        ...

    def script_in(self, environment: Path, name: str) -> Path:
        """A command that a package has put into a virtual environment."""
        ...

    def quoted(self, word: str) -> str:
        """A word as it is typed in the system's own shell."""
        ...

    def repeat(self, call: Callable[[], None], seconds: float) -> Callable[[], None]:
        """Calls ``call`` every so many seconds, while other code works, until the function that it gives is called.

        No thread does this where processes are forked: a child could not be forked safely then.
        """
        ...


class Posix:
    """Linux and macOS."""

    limits_processes: bool = True

    def is_running(self, pid: int) -> bool:
        """See System."""
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return False
        except (OSError, OverflowError):
            return True  # another user's
        return True

    def own_group(self) -> Mapping[str, Any]:
        """See System."""
        return {"start_new_session": True}

    def kill_group(self, pid: int) -> None:
        """See System."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(pid, signal.SIGKILL)

    def lock(self, file: IO[Any], *, wait: bool) -> None:
        """See System."""
        import fcntl  # noqa: PLC0415 - not on Windows

        fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))

    def yield_to_others(self) -> None:
        """See System."""
        os.nice(10)

    def cores(self) -> int:
        """See System. macOS knows no affinity."""
        affinity = getattr(os, "sched_getaffinity", None)
        return len(affinity(0)) if affinity is not None else os.cpu_count() or 1

    def python_in(self, environment: Path) -> Path:
        """See System."""
        return environment / "bin" / "python"

    def script_in(self, environment: Path, name: str) -> Path:
        """See System."""
        return environment / "bin" / name

    def quoted(self, word: str) -> str:
        """See System."""
        return shlex.quote(word)

    def repeat(self, call: Callable[[], None], seconds: float) -> Callable[[], None]:
        """See System. A timer of the process calls; only the main thread has one, and not where it is in use."""
        free = signal.getsignal(signal.SIGALRM) is signal.SIG_DFL
        if not free or threading.current_thread() is not threading.main_thread():
            return lambda: None
        signal.signal(signal.SIGALRM, lambda _number, _frame: call())
        signal.setitimer(signal.ITIMER_REAL, seconds, seconds)

        def stop() -> None:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, signal.SIG_DFL)

        return stop


class Windows:
    """Windows, by the calls that are given: its own, or a test's.

    ``kernel`` is kernel32.dll, ``locking`` is msvcrt.locking, ``run`` starts a command and waits for it.
    """

    limits_processes: bool = False

    def __init__(
        self,
        kernel: Callable[[], Any] = lambda: __import__("ctypes").windll.kernel32,
        locking: Callable[[int, int, int], None] | None = None,
        run: Callable[[list[str]], object] | None = None,
    ) -> None:
        self._kernel = kernel
        self._locking = locking
        self._run = run or _run_quietly

    def is_running(self, pid: int) -> bool:
        """See System. ``os.kill(pid, 0)`` would send Ctrl-C there."""
        kernel = self._kernel()
        handle = kernel.OpenProcess(_ASK_ONLY, False, pid)
        if not handle:
            return bool(kernel.GetLastError() == _REFUSED)  # another user's
        try:
            code = _Number()
            known = kernel.GetExitCodeProcess(handle, code.reference())
            return not known or code.value == _STILL_ACTIVE
        finally:
            kernel.CloseHandle(handle)

    def own_group(self) -> Mapping[str, Any]:
        """See System."""
        return {"creationflags": _NEW_GROUP}

    def kill_group(self, pid: int) -> None:
        """See System. There are no groups to kill: taskkill follows the children's parents."""
        with contextlib.suppress(OSError):
            self._run(["taskkill", "/F", "/T", "/PID", str(pid)])

    def lock(self, file: IO[Any], *, wait: bool) -> None:
        """See System. Waiting is by trying again: msvcrt's own gives up after ten seconds."""
        while True:
            try:
                self._lock_once(file.fileno())
            except OSError:
                if not wait:
                    raise
                time.sleep(_LOCK_SECONDS)
            else:
                return

    def _lock_once(self, descriptor: int) -> None:
        locking, mode = self._locking, 2  # LK_NBLCK
        if locking is None:
            locking = __import__("msvcrt").locking
        assert locking is not None
        os.lseek(descriptor, 0, os.SEEK_SET)  # a lock is on bytes from the current place on
        locking(descriptor, mode, 1)

    def yield_to_others(self) -> None:
        """See System."""
        kernel = self._kernel()
        kernel.SetPriorityClass(kernel.GetCurrentProcess(), _BELOW_NORMAL)

    def cores(self) -> int:
        """See System."""
        return os.cpu_count() or 1

    def python_in(self, environment: Path) -> Path:
        """See System."""
        return environment / "Scripts" / "python.exe"

    def script_in(self, environment: Path, name: str) -> Path:
        """See System."""
        return environment / "Scripts" / f"{name}.exe"

    def quoted(self, word: str) -> str:
        """See System."""
        return subprocess.list2cmdline([word])

    def repeat(self, call: Callable[[], None], seconds: float) -> Callable[[], None]:
        """See System. Nothing is forked there."""
        stopped = threading.Event()

        def run() -> None:
            while not stopped.wait(seconds):
                call()

        thread = threading.Thread(target=run, daemon=True)
        thread.start()

        def stop() -> None:
            stopped.set()
            thread.join()

        return stop


class _Number:
    """A number that a call writes to."""

    def __init__(self) -> None:
        import ctypes  # noqa: PLC0415 - only on Windows

        self._held = ctypes.c_ulong(0)

    def reference(self) -> Any:
        import ctypes  # noqa: PLC0415 - only on Windows

        return ctypes.pointer(self._held)

    @property
    def value(self) -> int:
        return int(self._held.value)


def _run_quietly(command: list[str]) -> object:
    return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)


def system_of(platform: str) -> System:
    """The system that ``sys.platform`` names."""
    return Windows() if platform == "win32" else Posix()


SYSTEM: System = system_of(sys.platform)
