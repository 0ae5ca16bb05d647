"""What may reach a terminal: standard output and error that show control characters instead of sending them.

Names in files, pages, plans and answers of models may hold escape sequences, which retitle or clear a terminal, write
to the clipboard, or forge lines. The command guards its streams before anything else, so that no print, no log line,
no error and no traceback can forget to.
"""

from __future__ import annotations

import os
import re
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Any, TextIO, cast

if TYPE_CHECKING:
    from collections.abc import Iterable

# Control characters (all but tab and new line), separators and directions of text, halves of characters.
STEERING = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)


def visible(text: str) -> str:
    r"""The text with what could steer a terminal written out, as \u001b: in a string of JSON, that is the same."""
    return STEERING.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


class GuardedStream:
    """A text stream that writes only what is ``visible``; everything else is the stream's own.

    It has no ``buffer``: bytes could not be guarded.
    """

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def write(self, text: str) -> int:
        """Writes the visible text; letters that the stream cannot encode are replaced."""
        encoding = self.stream.encoding or "utf-8"
        self.stream.write(visible(text).encode(encoding, "replace").decode(encoding))
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        """Writes them one by one."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        if name == "buffer":
            raise AttributeError(name)
        return getattr(self.stream, name)


def guard_streams() -> None:
    """Guards standard output and error, until the process ends."""
    sys.stdout, sys.stderr = _guarded(sys.stdout), _guarded(sys.stderr)


def discard_output() -> None:
    """Has what both streams still hold go nowhere: when the process ends, Python would try again to write it."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # one without a descriptor holds nothing
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, stream.fileno())
            os.close(nowhere)


def unguarded(stream: TextIO) -> TextIO:
    """The stream itself, for a writer with escapes of its own, such as simworlds.terminal.console."""
    return stream.stream if isinstance(stream, GuardedStream) else stream


def _guarded(stream: TextIO | None) -> TextIO:
    if isinstance(stream, GuardedStream):
        return stream
    # A program without a terminal may have no streams at all, and they may be closed.
    return cast("TextIO", GuardedStream(stream or _nowhere()))


def _nowhere() -> TextIO:
    return open(os.open(os.devnull, os.O_WRONLY), "w", encoding="utf-8", closefd=False)
