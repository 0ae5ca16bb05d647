"""Output for programs that must be what a file holds, to the byte: diffs, code."""

from __future__ import annotations

import re
import sys
from typing import Any

from simworlds.terminal.streams import unguarded, visible

_LINE_END = re.compile(r"(\r?\n)")


def print_exact(data: bytes, encoding: str = "utf-8") -> None:
    """Prints bytes as they are; on a terminal their text, visible but for the ends of lines."""
    stream: Any = unguarded(sys.stdout)
    if stream is None:  # a program without a terminal may have none
        return
    if stream.isatty():
        parts = _LINE_END.split(data.decode(encoding, "replace"))
        text = "".join(part if number % 2 else visible(part) for number, part in enumerate(parts))
        stream.write(text.encode(stream.encoding, "replace").decode(stream.encoding))
    else:
        stream.flush()
        stream.buffer.write(data)
    stream.flush()
