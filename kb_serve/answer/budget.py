"""Cuts an answer into parts that are the same for every budget, and shows as many as fit.

A part is a few lines. An answer begins with the part that was asked for and goes on as far as the budget allows; it
names the part to go on with. So part 12 begins at the same word, however much of it is asked for at a time.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

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
    """A few lines of a block, of ``size`` bytes. ``glue`` is what stands between them and the part before."""

    text: str
    name: str
    glue: str
    size: int


def cut(blocks: Iterable[AnswerBlock]) -> list[AnswerPart]:
    """The parts of an answer, each of at most ``PART_TOKENS``; an empty answer is one empty part."""
    parts: list[AnswerPart] = []
    for text, name, _ in blocks:
        encoded = text.encode(errors="replace")
        if len(encoded) <= _PART_BYTES:
            parts.append(AnswerPart(text, name, "\n\n", len(encoded)))
            continue
        glue, used = "\n\n", 0
        held: list[str] = []
        for line, size in zip(text.split("\n"), map(len, encoded.split(b"\n")), strict=True):
            for before, piece, added in _pieces(line) if size > _PART_BYTES else (("\n", line, size),):
                if held and used + len(before) + added <= _PART_BYTES:
                    held += (before, piece)
                    used += len(before) + added
                    continue
                if held:
                    parts.append(AnswerPart("".join(held), name, glue, used))
                    glue = before
                held, used = [piece], added
        parts.append(AnswerPart("".join(held), name, glue, used))
    return parts or [AnswerPart("", "", "", 0)]


def _pieces(line: str) -> Iterator[tuple[str, str, int]]:
    """The words of a line up to where it is longer than a part: what stands before them, they, and their size."""
    before, rest = "\n", line
    while _bytes(rest) > _PART_BYTES:
        head = rest.encode(errors="replace")[:_PART_BYTES].decode(errors="ignore")
        space = head.rfind(" ")
        end, after = (space, " ") if space > len(head) // 2 else (len(head), "")
        yield before, head[:end], _bytes(head[:end])
        before, rest = after, rest[end + len(after) :]
    yield before, rest, _bytes(rest)


def shown(parts: Sequence[AnswerPart], first: int, budget: int) -> tuple[str, int]:
    """(text, number of the part after it) of as many parts from ``first``, counted from 0, as fit into ``budget``
    tokens: one at least.
    """
    pieces = [parts[first].text]
    left = budget * _BYTES_PER_TOKEN - parts[first].size
    number = first + 1
    for text, _, glue, size in parts[number:]:
        left -= len(glue) + size
        if left < 0:
            break
        pieces += (glue, text)
        number += 1
    return "".join(pieces).strip("\n"), number


def names_of(parts: Iterable[AnswerPart]) -> list[str]:
    """The names of the blocks that parts belong to, each once."""
    return [name for name in dict.fromkeys(part.name for part in parts) if name]
