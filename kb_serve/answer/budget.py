"""Fits an answer into a number of tokens, part by part."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

_WORTH_FILLING = 0.25  # of a part: where less is left, a block begins in the next part
_BYTES_PER_TOKEN = 3  # fewer than tokenizers reach with English, Markdown and names: the budget holds


def tokens(text: str) -> int:
    """An upper estimate of a text's tokens: one for every three bytes."""
    return math.ceil(len(text.encode(errors="replace")) / _BYTES_PER_TOKEN)


def clip(text: str, budget: int) -> str:
    """The beginning of a text within ``budget`` tokens, cut at a word, with an ellipsis where cut."""
    if tokens(text) <= budget:
        return text
    room = max(0, budget * _BYTES_PER_TOKEN - 4)
    cut = text.encode(errors="replace")[:room].decode(errors="ignore")
    return (cut[: cut.rindex(" ")] if " " in cut else cut) + " …"


@dataclass(frozen=True, slots=True)
class AnswerBlock:
    """A piece of an answer that belongs together; ``name`` is its name in the list of what is left."""

    text: str
    name: str = ""


def _split(text: str, room: int) -> tuple[str, str]:
    """(what fits into ``room`` tokens, the rest), cut between lines; between words where one line is too long."""
    limit = room * _BYTES_PER_TOKEN
    start = text[: limit + 1]  # a character takes at least a byte: all that fits is in here
    position = used = 0
    for line in start.split("\n"):
        used += len(line.encode(errors="replace")) + 1
        if used > limit:
            break
        position += len(line) + 1
    if position:
        return text[: position - 1], text[position:]
    head = start.encode(errors="replace")[:limit].decode(errors="ignore")
    at = head.rfind(" ")
    head = head[:at] if at > len(head) // 2 else head
    return head, text[len(head) :].lstrip(" ")


def paginate(blocks: Sequence[AnswerBlock], budget: int) -> list[tuple[str, list[str]]]:
    """(text, names of the blocks that are left) for every part, each within ``budget`` tokens.

    Blocks keep their order. One that does not fit continues in the next part, or moves there whole if there was
    little room.
    """
    parts: list[tuple[str, list[str]]] = []
    current = ""
    for number, block in enumerate(blocks):
        later = [other.name for other in blocks[number:] if other.name]
        rest = block.text
        while rest:
            room = budget - tokens(f"{current}\n\n") if current else budget
            if len(rest) <= room * _BYTES_PER_TOKEN and tokens(rest) <= room:
                current = f"{current}\n\n{rest}" if current else rest
                break
            if room >= _WORTH_FILLING * budget:
                head, rest = _split(rest, room)
                current = f"{current}\n\n{head}" if current else head
            parts.append((current, later))
            current = ""
    parts.append((current, []))
    return parts
