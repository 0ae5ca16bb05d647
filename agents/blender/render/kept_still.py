"""A still on disk with what it shows and what was said of it, so that it need not be rendered again unchanged."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from simworlds.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path


class KeptStill:
    """The still in ``path``. ``shows`` is all that it depends on, as JSON data."""

    def __init__(self, path: Path, shows: Mapping[str, Any]) -> None:
        self._picture, self._notes = path, path.with_suffix(".json")
        self._shows = json.loads(json.dumps(shows))

    def reply(self) -> tuple[str, dict[str, Any]] | None:
        """What was said of it, as text and data; None if there is no such still any more."""
        try:
            notes = json.loads(self._notes.read_text())
            if notes["shows"] == self._shows and notes["bytes"] == self._picture.stat().st_size:
                return str(notes["text"]), dict(notes["data"])
        except (OSError, ValueError, KeyError, TypeError):
            pass
        return None

    def keep(self, text: str, data: Mapping[str, Any]) -> None:
        """Notes what is said of the still that has just been rendered."""
        size = self._picture.stat().st_size
        notes = {"shows": self._shows, "bytes": size, "text": text, "data": data}
        write_whole(self._notes, json.dumps(notes), durable=False)
