"""Text that takes a terminal over if it is printed as it is, and how to tell that it was."""

from __future__ import annotations

import os
import pty
import re
import subprocess
import unicodedata
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

CLIPBOARD, LINK, COLOUR = "\x1b]52;c;QUFB\x07", "\x1b]8;;evil:\x1b\\", "\x1b[31;5;7m"
HOSTILE = f"evil{CLIPBOARD}{LINK}{COLOUR}\x9b2J\u202elive\u2066\x08\r\x7f[/red]\x0b"
_BIDI = {"LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"}
# What our own console writes on a terminal: colours, moves of the cursor, erased lines.
_OWN = re.compile(r"\x1b\[(?:[0-9;]*m|\?25[lh]|[0-9]*[ABCDGK])|\r")


def steering(printed: str, *, is_terminal: bool = False) -> list[str]:
    """What in ``printed`` could steer a terminal, except our own styles where it went to one."""
    for part in (CLIPBOARD, LINK, COLOUR):
        if part in printed:
            return [part]
    rest = _OWN.sub("", printed) if is_terminal else printed
    return [
        letter
        for letter in rest
        if letter not in "\n\t"
        and (
            unicodedata.category(letter) in {"Cc", "Cs", "Zl", "Zp"}
            or unicodedata.bidirectional(letter) in _BIDI
        )
    ]


def on_terminal(command: Sequence[str], environment: Mapping[str, str]) -> str:
    """All that a command writes when its output is a terminal."""
    ours, theirs = pty.openpty()
    try:
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=theirs,
            stderr=theirs,
            env={**environment, "TERM": "xterm-256color", "COLUMNS": "220"},
        )
    finally:
        os.close(theirs)
    data = b""
    with process:
        try:
            while chunk := os.read(ours, 1 << 16):
                data += chunk
        except OSError:  # how Linux says that the other side is closed
            pass
        finally:
            os.close(ours)
    return data.decode("utf-8", "surrogateescape")
