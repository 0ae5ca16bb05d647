"""What is known of a message that names nothing of the API."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache

_QUOTES = str.maketrans("", "", "'\"")
_NAME_FIRST = re.compile(r"(['\"])\w+\1 ")


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
        """Whether a query holds the message, be it typed without the quotes of a name."""
        bare = bare_query(query)

        def has(part: str) -> bool:
            return part in query or bool((own := bare_part(part)) and own in bare)

        return all(map(has, self.parts)) and not any(map(has, self.without))


def bare_query(query: str) -> str:
    """A query without quotes, with a space before its first word."""
    return f" {query.translate(_QUOTES)}"


@cache
def bare_part(part: str) -> str:
    """A part without the quotes of the name that it begins with, where a word begins; empty for others, which quotes
    tell from other messages.
    """
    return f" {part.translate(_QUOTES)}" if _NAME_FIRST.match(part) else ""
