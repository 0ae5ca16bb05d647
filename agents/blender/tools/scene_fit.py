"""Fits the sections of a readout into a token budget, and counts what is left out."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

BYTES_PER_TOKEN = 3
JSON_BYTES_PER_TOKEN = 12  # of the structured data, which is never read whole
HEADING = 20  # tokens at most, of a section's heading and the blank line before it
_LEAST_ROOM = 60  # tokens, for the beginning of an item to be worth showing
_PIECES = re.compile(r"[^\W\d_]{1,5}|\d{1,3}|[^\s\w]|_|\n")


def tokens(text: str) -> int:
    """An upper estimate of a text's tokens: one for three bytes, more for digits and signs."""
    return max(math.ceil(len(text.encode(errors="replace")) / BYTES_PER_TOKEN), len(_PIECES.findall(text)))


@dataclass(frozen=True, slots=True)
class ReadoutItem:
    """What is shown or left out as a whole: its text, the same as JSON, and how many entries it stands for."""

    text: str
    data: dict[str, Any]
    count: int = 1

    @property
    def cost(self) -> int:
        """Tokens of the text, or those that the JSON counts as, if more."""
        size = len(json.dumps(self.data, ensure_ascii=False, separators=(",", ":")).encode(errors="replace"))
        return max(tokens(self.text) + 1, math.ceil(size / JSON_BYTES_PER_TOKEN))


@dataclass(slots=True)
class ReadoutSection:
    """A section of the readout; ``weight``: its share when there is not enough room for all."""

    name: str
    items: Sequence[ReadoutItem]
    weight: int = 1
    unread: int = 0
    shown: list[ReadoutItem] = field(default_factory=list[ReadoutItem])

    @property
    def left_out(self) -> int:
        """How many entries after the shown ones are left out."""
        return sum(item.count for item in self.items[len(self.shown) :]) + self.unread


def share_tokens(sections: Sequence[ReadoutSection], room: int, footer: int) -> None:
    """Gives each section what it needs if there is enough room, else its share. Sets ``shown``.

    ``footer``: tokens of the line below a section that is not shown whole.
    """
    left = room - HEADING * len(sections)
    needs = {section.name: sum(item.cost for item in section.items) for section in sections}
    waiting = list(sections)
    while waiting:
        weights, free = sum(section.weight for section in waiting), left - footer * len(waiting)
        content = [section for section in waiting if needs[section.name] * weights <= free * section.weight]
        if not content:
            break
        for section in content:
            left -= needs[section.name]
            section.shown = list(section.items)
        waiting = [section for section in waiting if section not in content]
    left -= footer * len(waiting)
    weights, shared = sum(section.weight for section in waiting), left
    for section in waiting:
        left -= _fill(section, shared * section.weight // weights)
    for section in waiting:  # an item too large for its section's share may fit into what others left
        left -= _fill(section, left)
    for section in waiting:
        # A single section has all the room; among several, the call that shows it is named instead.
        if not section.shown and len(sections) == 1 and (first := _cut(section.items[0], left)) is not None:
            section.shown.append(first)


def _fill(section: ReadoutSection, room: int) -> int:
    """Shows as many more items as fit; returns their cost."""
    used = 0
    for item in section.items[len(section.shown) :]:
        if used + item.cost > room:
            break
        used += item.cost
        section.shown.append(item)
    return used


def _cut(item: ReadoutItem, room: int) -> ReadoutItem | None:
    """The beginning of an item that is too large for the whole readout; None if not even that fits."""
    note = "  … cut: raise max_tokens"
    kept: list[str] = []
    used = tokens(note) + 2
    for line in item.text.splitlines():
        used += tokens(line) + 1
        if used > room:
            break
        kept.append(line)
    if not kept:
        if room < _LEAST_ROOM:
            return None
        kept = [item.text[: room // 2]]
    return ReadoutItem("\n".join([*kept, note]), {"name": item.data.get("name"), "cut": True}, item.count)
