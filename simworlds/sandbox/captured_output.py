"""The beginning and the end of what a process prints."""

from __future__ import annotations

HEAD_BYTES = 12_000
TAIL_BYTES = 12_000
LONGEST_LINE = 400


class CapturedOutput:
    """Takes any amount of bytes, and keeps the first and the last of them."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forgets everything."""
        self._head = bytearray()
        self._tail = bytearray()
        self._dropped = 0
        self._line = bytearray()
        self.lines, self.last_line = 0, ""  # complete lines, and the last one that is not empty

    def add(self, data: bytes) -> None:
        """Adds output."""
        self._count_lines(data)
        room = HEAD_BYTES - len(self._head)
        if room > 0:
            self._head += data[:room]
            data = data[room:]
        self._tail += data
        if (over := len(self._tail) - TAIL_BYTES) > 0:
            del self._tail[:over]
            self._dropped += over

    def _count_lines(self, data: bytes) -> None:
        *lines, rest = data.split(b"\n")
        if lines:
            self.lines += len(lines)
            lines[0] = bytes(self._line) + lines[0]
            self._line.clear()
            filled = (line for line in reversed(lines) if line.strip())
            self.last_line = next(filled, self.last_line.encode()).decode("utf-8", "replace")[:LONGEST_LINE]
        self._line += rest[: LONGEST_LINE - len(self._line)]

    @property
    def text(self) -> str:
        """The kept output as text, with the number of bytes left out."""
        gap = f"\n… {self._dropped:,} bytes left out …\n" if self._dropped else ""
        head, tail = bytes(self._head), bytes(self._tail)
        if not gap:
            return (head + tail).decode("utf-8", "replace")
        return head.decode("utf-8", "replace") + gap + tail.decode("utf-8", "replace")
