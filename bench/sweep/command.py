"""Runs the command ``simworlds`` as a process that ends with this one."""

from __future__ import annotations

import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.end_with_parent import ending_with_this
from simworlds.processes import end_group, spawn

if TYPE_CHECKING:
    from collections.abc import Sequence

_GRACE_SECONDS = (2.0, 20.0)  # after the first Ctrl-C, which asks it to stop, and the second, which insists
_LAST_CHARACTERS = 300
_NOTHING = "it printed nothing"


def simworlds_command() -> list[str]:
    """The command ``simworlds`` of this environment, or the same run from the source."""
    installed = Path(sys.executable).with_name("simworlds")
    if installed.is_file():
        return [str(installed)]
    return [sys.executable, "-m", "simworlds"]


def run_simworlds(words: Sequence[str], log: Path) -> int:
    """Runs ``simworlds`` and returns its exit code. Whatever it starts ends with this process.

    Its output is appended to ``log``.
    """
    with log.open("ab") as output:
        process = spawn(
            ending_with_this([*simworlds_command(), *words]), stdout=output, stderr=subprocess.STDOUT
        )
    try:
        return process.wait()
    except KeyboardInterrupt:
        for seconds in _GRACE_SECONDS:
            process.send_signal(signal.SIGINT)
            with suppress(subprocess.TimeoutExpired):
                process.wait(seconds)
                break
        raise
    finally:
        end_group(process)


def last_output(log: Path) -> str:
    """The end of a command's output, in one line."""
    with suppress(OSError):
        text = " ".join(log.read_bytes()[-4000:].decode(errors="replace").split())
        return text[-_LAST_CHARACTERS:] or _NOTHING
    return _NOTHING
