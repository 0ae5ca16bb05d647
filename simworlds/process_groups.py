"""Commands that cannot outlive their caller's patience."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

_TAIL_BYTES = 4_000
_TAIL_LINES = 15


class CommandFailed(Exception):  # noqa: N818 - reads as the state it names
    """A command ended badly or had to be ended; ``tail`` is the end of what it printed."""

    def __init__(self, fault: str, tail: str) -> None:
        self.tail = tail
        super().__init__(f"{fault}; it said: {tail}" if tail else f"{fault}, and said nothing")


def run_group(command: list[str], *, environment: dict[str, str], timeout: float, log: Path) -> None:
    """Run a command in a process group of its own, its output in the file ``log``.

    The whole group is killed when the command has not ended after ``timeout`` seconds, or when the caller is
    interrupted. Raises CommandFailed for a timeout, a command that cannot start, and any exit code but 0.
    """
    with log.open("wb") as output:
        try:
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                env=environment,
                start_new_session=True,
            )
        except OSError as error:
            raise CommandFailed(f"{command[0]} cannot be started ({error})", "") from error
        try:
            code = process.wait(timeout)
        except subprocess.TimeoutExpired:
            raise CommandFailed(f"it was stopped after {timeout:.0f} s", _tail(log)) from None
        finally:
            _kill_group(process)
    if code != 0:
        raise CommandFailed(_ending(code), _tail(log))


def _kill_group(process: subprocess.Popen[bytes]) -> None:
    """End the command if it still runs, and whatever it left running."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _ending(code: int) -> str:
    if code >= 0:
        return f"it ended with exit code {code}"
    try:
        return f"it was ended by {signal.Signals(-code).name}"
    except ValueError:
        return f"it was ended by signal {-code}"


def _tail(log: Path) -> str:
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - _TAIL_BYTES))
        lines = file.read().decode(errors="replace").strip().splitlines()
    return "\n".join(lines[-_TAIL_LINES:])
