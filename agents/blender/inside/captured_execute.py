# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs code, and tells what it prints apart from what Blender itself prints."""

import contextlib
import os
import sys

from .execute import execute

_LONGEST = 1_000_000  # characters


def execute_captured(arguments, report):
    """As ``execute``; ``printed`` is what Python wrote to its standard output.

    ``targets`` are paths that the code may write to; their folders are made.
    """
    for path in arguments["targets"]:
        with contextlib.suppress(OSError):
            os.makedirs(os.path.dirname(path), exist_ok=True)
    tee = _Tee(sys.stdout)
    sys.stdout = tee
    try:
        result = execute(arguments, report)
    finally:
        sys.stdout = tee.stream
    return {**result, "printed": tee.text}


class _Tee:
    """A stream that passes everything on and keeps a copy; code may do with it what it does with the real one."""

    def __init__(self, stream):
        self.stream = stream
        self._parts = []
        self._length = 0

    @property
    def text(self):
        """The copy."""
        more = self._length - _LONGEST
        return "".join(self._parts) + (f"\n… {more:,} characters left out …\n" if more > 0 else "")

    def write(self, text):
        written = self.stream.write(text)
        if room := max(0, _LONGEST - self._length):
            self._parts.append(text[:room])
        self._length += len(text)
        return written

    def writelines(self, lines):
        for line in lines:
            self.write(line)

    def __getattr__(self, name):
        return getattr(self.stream, name)
