"""The command ``simworlds`` in a process of its own, which ends with this one."""

from __future__ import annotations

import os
import signal
import subprocess
from contextlib import suppress
from typing import TYPE_CHECKING

from bench.setting import simworlds
from simworlds.end_with_parent import ending_with_this

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

_GRACE_SECONDS = (2.0, 20.0)  # after the first Ctrl-C, which asks for a stop, and the second: for one now
_LAST_WORDS = 300
_NOTHING = "it said nothing"


def called(words: Sequence[str], log: Path) -> int:
    """The exit code of a ``simworlds`` that ends with this process, and with it all that it started.

    What it says is added to ``log``.
    """
    with log.open("ab") as said:
        process = subprocess.Popen(
            ending_with_this([*simworlds(), *words]),
            stdin=subprocess.DEVNULL,
            stdout=said,
            stderr=subprocess.STDOUT,
            start_new_session=True,
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
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def last_words(log: Path) -> str:
    """The end of what a command said, in one line."""
    with suppress(OSError):
        said = " ".join(log.read_bytes()[-4000:].decode(errors="replace").split())
        return said[-_LAST_WORDS:] or _NOTHING
    return _NOTHING
