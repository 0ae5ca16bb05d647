"""Cuts an answer into parts that are the same for every budget, and shows as many as fit.

A part is a few lines. An answer begins with the part that was asked for and goes on as far as the budget allows; it
names the part to go on with. So part 12 begins at the same word, however much of it is asked for at a time.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

PART_TOKENS = 80
_BYTES_PER_TOKEN = 3  # fewer than tokenizers reach with English, Markdown and names: the budget holds
_PART_BYTES = PART_TOKENS * _BYTES_PER_TOKEN


def _bytes(text: str) -> int:
    return len(text) if text.isascii() else len(text.encode(errors="replace"))


def tokens(text: str) -> int:
    """An upper estimate of a text's tokens: one for every three bytes."""
    return math.ceil(_bytes(text) / _BYTES_PER_TOKEN)


def clip(text: str, budget: int) -> str:
    """The beginning of a text within ``budget`` tokens, cut at a word, with an ellipsis where cut."""
    if tokens(text) <= budget:
        return text
    room = max(0, budget * _BYTES_PER_TOKEN - 4)
    cut = text.encode(errors="replace")[:room].decode(errors="ignore")
    return (cut[: cut.rindex(" ")] if " " in cut else cut) + " …"


class AnswerBlock(NamedTuple):
    """A piece of an answer that belongs together; ``name`` is its name in the list of what is left.

    ``plain`` is the documentation's own text, where something was added to it.
    """

    text: str
    name: str = ""
    plain: str = ""


class AnswerPart(NamedTuple):
    """A few lines of a block. ``glue`` is what stands between them and the part before."""

    text: str
    name: str
    glue: str


def cut(blocks: Iterable[AnswerBlock]) -> list[AnswerPart]:
    """The parts of an answer, each of at most ``PART_TOKENS``; an empty answer is one empty part."""
    parts: list[AnswerPart] = []
    for block in blocks:
        size = len if block.text.isascii() else _bytes
        if size(block.text) <= _PART_BYTES:
            parts.append(AnswerPart(block.text, block.name, "\n\n"))
            continue
        glue, used = "\n\n", 0
        held: list[str] = []
        for before, piece in _pieces(block.text, size):
            added = size(piece)
            if held and used + len(before) + added <= _PART_BYTES:
                held += (before, piece)
                used += len(before) + added
                continue
            if held:
                parts.append(AnswerPart("".join(held), block.name, glue))
                glue = before
            held, used = [piece], added
        parts.append(AnswerPart("".join(held), block.name, glue))
    return parts or [AnswerPart("", "", "")]


def _pieces(text: str, size: Callable[[str], int]) -> Iterator[tuple[str, str]]:
    """(what stands before it, a line), or where a line is longer than a part, its words up to there."""
    for line in text.split("\n"):
        before, rest = "\n", line
        while size(rest) > _PART_BYTES:
            head = rest.encode(errors="replace")[:_PART_BYTES].decode(errors="ignore")
            space = head.rfind(" ")
            if space > len(head) // 2:
                yield before, head[:space]
                before, rest = " ", rest[space + 1 :]
            else:
                yield before, head
                before, rest = "", rest[len(head) :]
        yield before, rest


def shown(parts: Sequence[AnswerPart], first: int, budget: int) -> tuple[str, int]:
    """(text, number of the part after it) of as many parts from ``first``, counted from 0, as fit into ``budget``
    tokens: one at least.
    """
    pieces = [parts[first].text]
    used = _bytes(pieces[0])
    number = first + 1
    for part in parts[number:]:
        used += len(part.glue) + _bytes(part.text)
        if used > budget * _BYTES_PER_TOKEN:
            break
        pieces += (part.glue, part.text)
        number += 1
    return "".join(pieces).strip("\n"), number


def names_of(parts: Iterable[AnswerPart]) -> list[str]:
    """The names of the blocks that parts belong to, each once."""
    return [name for name in dict.fromkeys(part.name for part in parts) if name]
