"""Where long work shows how it goes: on a terminal that can be redrawn, or as lines in a log."""

from __future__ import annotations

import os
from contextlib import suppress
from typing import TYPE_CHECKING

from simworlds.terminal.streams import visible

if TYPE_CHECKING:
    from typing import TextIO


def is_terminal(stream: TextIO) -> bool:
    """Whether the stream is a terminal on which a view can be redrawn."""
    return stream.isatty() and os.environ.get("TERM", "").lower() not in ("dumb", "unknown")


def write_line(stream: TextIO, line: str) -> None:
    """Writes a visible line. Does nothing when the reader is gone; what the stream cannot encode is replaced."""
    encoding = getattr(stream, "encoding", None) or "utf-8"
    with suppress(OSError, ValueError):
        stream.write(f"{visible(line)}\n".encode(encoding, "replace").decode(encoding))
        stream.flush()
