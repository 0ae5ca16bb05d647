"""The command ``simworlds`` in a process of its own, which ends with this one."""

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

_GRACE_SECONDS = (2.0, 20.0)  # after the first Ctrl-C, which asks for a stop, and the second: for one now
_LAST_WORDS = 300
_NOTHING = "it said nothing"


def simworlds_command() -> list[str]:
    """The command ``simworlds`` of this environment, or the same run from the source."""
    installed = Path(sys.executable).with_name("simworlds")
    if installed.is_file():
        return [str(installed)]
    return [sys.executable, "-c", "from simworlds.cli import main; main(prog_name='simworlds')"]


def called(words: Sequence[str], log: Path) -> int:
    """The exit code of a ``simworlds`` that ends with this process, and with it all that it started.

    What it says is added to ``log``.
    """
    with log.open("ab") as said:
        process = spawn(
            ending_with_this([*simworlds_command(), *words]), stdout=said, stderr=subprocess.STDOUT
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


def last_words(log: Path) -> str:
    """The end of what a command said, in one line."""
    with suppress(OSError):
        said = " ".join(log.read_bytes()[-4000:].decode(errors="replace").split())
        return said[-_LAST_WORDS:] or _NOTHING
    return _NOTHING
