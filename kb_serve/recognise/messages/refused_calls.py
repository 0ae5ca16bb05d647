"""Recognises what Blender says to calls that were tried while the base was built."""

from __future__ import annotations

import re
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_FEW = 3


class RefusedCalls:
    """Finds in one base the functions that refuse a call so."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    @cached_property
    def _refusals(self) -> list[tuple[str, re.Pattern[str], str]]:
        """(a part of the message, the whole of it, the function that says it) of each refused call."""
        found: list[tuple[str, re.Pattern[str], str]] = []
        for message, path in self._reader.rows("SELECT message, path FROM refusals"):
            parts = message.split("…")
            pattern = r"\S.{0,80}?".join(map(re.escape, parts))
            found.append((max(parts, key=len), re.compile(pattern), path))
        return found

    def recognise(self, query: str, recognition: Recognition) -> None:
        """What Blender says to calls that were tried while the base was built: the functions, the usual one first."""
        paths = [path for part, whole, path in self._refusals if part in query and whole.search(query)]
        if recognition.removed or any(match.sure >= 0.95 for match in recognition.matches):
            return  # what the message names is known
        weights = self._reader.usage.weights(paths) if paths else {}
        for rank, path in enumerate(sorted(paths, key=lambda path: -weights.get(path, 0.0))[:_FEW]):
            recognition.add(path, 0.98 - 0.01 * rank, "error message")
