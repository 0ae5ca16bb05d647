"""Fits the sections of a readout into a number of tokens, and counts what is left out."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

BYTES_PER_TOKEN = 3
JSON_BYTES_PER_TOKEN = 12  # of the structured form, which is never read whole
HEADING = 20  # tokens, at most, of a section's heading and the blank line before it
_LEAST_ROOM = 60  # tokens, for the beginning of a piece to be worth showing
_PIECES = re.compile(r"[^\W\d_]{1,5}|\d{1,3}|[^\s\w]|_|\n")


def tokens(text: str) -> int:
    """An upper estimate of a text's tokens: one for three bytes; figures and signs are shorter pieces."""
    return max(math.ceil(len(text.encode(errors="replace")) / BYTES_PER_TOKEN), len(_PIECES.findall(text)))


@dataclass(frozen=True, slots=True)
class ReadoutItem:
    """What is told or left out as a whole: its text, the same as JSON, and how many things it stands for."""

    text: str
    data: dict[str, Any]
    count: int = 1

    @property
    def cost(self) -> int:
        """Tokens of the text, or what the JSON counts for if that is more."""
        size = len(json.dumps(self.data, ensure_ascii=False, separators=(",", ":")).encode(errors="replace"))
        return max(tokens(self.text) + 1, math.ceil(size / JSON_BYTES_PER_TOKEN))


@dataclass(slots=True)
class ReadoutSection:
    """A part of the readout; ``weight``: its share of room that does not suffice for all."""

    name: str
    items: Sequence[ReadoutItem]
    weight: int = 1
    unread: int = 0
    shown: list[ReadoutItem] = field(default_factory=list[ReadoutItem])

    @property
    def left_out(self) -> int:
        """How many things behind the shown ones are not told."""
        return sum(piece.count for piece in self.items[len(self.shown) :]) + self.unread


def share_tokens(sections: Sequence[ReadoutSection], room: int, footer: int) -> None:
    """Gives each section what it needs where there is enough, and its share of the rest where there is not.

    ``footer``: tokens for the line below a section that is not shown whole. Sets ``shown``.
    """
    left = room - HEADING * len(sections)
    needs = {section.name: sum(piece.cost for piece in section.items) for section in sections}
    waiting = list(sections)
    while waiting:
        weights, free = sum(section.weight for section in waiting), left - footer * len(waiting)
        content = [one for one in waiting if needs[one.name] * weights <= free * one.weight]
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
    for section in waiting:  # what one share was too small for may fit into what others have left
        left -= _fill(section, left)
    for section in waiting:
        # Alone it has all the room there is; among others the call that shows it is named instead.
        if not section.shown and len(sections) == 1 and (first := _cut(section.items[0], left)) is not None:
            section.shown.append(first)


def _fill(section: ReadoutSection, room: int) -> int:
    """Shows as many more pieces as fit; returns what they cost."""
    used = 0
    for piece in section.items[len(section.shown) :]:
        if used + piece.cost > room:
            break
        used += piece.cost
        section.shown.append(piece)
    return used


def _cut(piece: ReadoutItem, room: int) -> ReadoutItem | None:
    """The beginning of a piece that is larger than all the room there is; None where not even that fits."""
    note = "  … cut: raise max_tokens"
    kept: list[str] = []
    used = tokens(note) + 2
    for line in piece.text.splitlines():
        used += tokens(line) + 1
        if used > room:
            break
        kept.append(line)
    if not kept:
        if room < _LEAST_ROOM:
            return None
        kept = [piece.text[: room // 2]]
    return ReadoutItem("\n".join([*kept, note]), {"name": piece.data.get("name"), "cut": True}, piece.count)
