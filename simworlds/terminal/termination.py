"""What a command does when it is told to end."""

from __future__ import annotations

import signal
from typing import NoReturn


def unwind_on_termination() -> None:
    """Lets SIGTERM unwind like Ctrl-C: nothing that is half done stays, nor a child process."""
    signal.signal(signal.SIGTERM, _interrupt)


def _interrupt(_number: int, _frame: object) -> NoReturn:
    raise KeyboardInterrupt
