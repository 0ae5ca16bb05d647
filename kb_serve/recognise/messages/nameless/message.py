"""What is known of a message that names nothing of the API."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class NamelessMessage:
    """The parts of a message that are always the same, the symbols and pages that it is about, most likely first, and
    what helps. A message with one of the parts ``without`` is another one.

    It is told only of a Blender that has the first of the symbols, and not ``lacking``, if that names another one.
    """

    parts: tuple[str, ...]
    paths: tuple[str, ...]
    help: str
    without: tuple[str, ...] = ()
    lacking: str = ""

    def is_in(self, query: str) -> bool:
        """Whether a query holds the message."""
        return all(part in query for part in self.parts) and not any(part in query for part in self.without)
