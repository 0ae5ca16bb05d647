"""What an answer tells of its best hit: all, or the beginning."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_serve.answer.budget import AnswerBlock, tokens
from kb_serve.answer.facts.asked_values import ASKED_NOTHING
from kb_serve.answer.pages import page_blocks

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.answer.facts.asked_values import AskedOf
    from kb_serve.answer.hit_lines import HitLines
    from kb_serve.answer.hits import Hit
    from kb_serve.answer.render import MarkdownRenderer
    from kb_serve.rank.ranked_id import RankedId
    from kb_serve.reader import BaseReader

_EXCERPT_TOKENS = 300  # of the best of several candidates
_SHORT_PAGE = 500  # tokens of one that is shown to its end
_LEAST_SAID = 30
_NOTHING = re.compile(r"This \w+ has no [\w ]+\.\s*")


class HitBlocks:
    """Tells of what was found best in one base."""

    def __init__(self, reader: BaseReader, renderer: MarkdownRenderer, lines: HitLines) -> None:
        self._reader = reader
        self._renderer = renderer
        self._lines = lines

    def whole(self, hit: Hit, row: RankedId, asked: AskedOf = ASKED_NOTHING) -> Iterator[AnswerBlock]:
        """All that is told of a hit, the most useful first."""
        if self._reader.manual.is_page(hit.id):
            yield from page_blocks(hit.id, self._reader, row.anchor)
        elif symbol := self._reader.symbol(hit.id):
            yield from self._renderer.symbol(symbol, asked)

    def excerpt(self, hit: Hit, row: RankedId, asked: AskedOf = ASKED_NOTHING) -> Iterator[AnswerBlock]:
        """The beginning of the best hit: its description, or the heading and the section that matches, the members
        that do, and as much more as is short; a short page to its end. Sections that only say in which panel something
        is are not counted, nor are the names that stand with labels: they must not take the place of what was asked.
        """
        blocks = self.whole(hit, row, asked)
        is_short = False
        if hit.is_page:
            blocks = [block for block in blocks if not _says_nothing(block.text)]
            is_short = sum(tokens(block.plain or block.text) for block in blocks) <= _SHORT_PAGE
        said = 0
        for number, block in enumerate(blocks):
            size = tokens(block.plain or block.text)
            if number > 1 and said + size > _EXCERPT_TOKENS and said > _LEAST_SAID and not is_short:
                return
            said += size if number and not _is_box(block.text) else 0
            yield block
            if number == 0 and row.members:
                yield AnswerBlock(
                    "**Nearest**\n" + "\n".join(self._lines.members(hit.id, row.members)), "nearest members"
                )


def _says_nothing(text: str) -> bool:
    """Whether a section only says that there is nothing to say: a node without inputs."""
    return _NOTHING.fullmatch(text.partition("\n\n")[2]) is not None


def _is_box(text: str) -> bool:
    """Whether a section holds nothing below its heading but a box, as the one that names its panel."""
    body = text.partition("\n\n")[2]
    return all(line.startswith(">") for line in body.split("\n") if line)
