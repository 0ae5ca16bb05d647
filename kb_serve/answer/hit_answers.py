"""What an answer tells of its hits: all of what a query names, the best of what was found, each of what is compared."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

from kb_serve.answer.asked.animated import animated
from kb_serve.answer.budget import AnswerBlock, tokens
from kb_serve.answer.facts.asked_values import asked_of, asked_words
from kb_serve.answer.hit_lines import NAMES
from kb_serve.answer.pages import MANUALS_WORDS
from kb_serve.answer.query_text import is_plain
from kb_serve.answer.ways.made_things import made_with

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from kb_serve.answer.facts.asked_values import AskedOf, AskedValue
    from kb_serve.answer.hit_blocks import HitBlocks
    from kb_serve.answer.hit_lines import HitLines
    from kb_serve.answer.hits import Hit
    from kb_serve.answer.render import MarkdownRenderer
    from kb_serve.rank.ranked_id import RankedId
    from kb_serve.reader import BaseReader

_LONG_WORDS = 250  # tokens of the manual's words on a symbol from which on other names go before them


class HitAnswers:
    """Tells of hits from one base. Each hit goes with the row, of the same place, that ranked it."""

    def __init__(
        self, reader: BaseReader, renderer: MarkdownRenderer, lines: HitLines, blocks: HitBlocks
    ) -> None:
        self._reader = reader
        self._renderer = renderer
        self._lines = lines
        self._blocks = blocks

    def named(
        self,
        hits: Sequence[Hit],
        rows: Sequence[RankedId],
        text: str,
        arguments: Collection[str],
        members: Sequence[str],
    ) -> Iterator[AnswerBlock]:
        """All of what a query names, with the ``arguments`` of its code, or those that its words speak of, and
        ``members`` that the query names as well ahead of the others; and a line for what else was found.
        """
        asked = asked_words(text)
        given = [*self._renderer.arguments(hits[0].id, arguments)]
        found = self._lines.asked(hits[0], asked) if is_plain(text) and not given else ()
        told, names = self._asked_arguments(hits[0], found)
        yield from given
        yield from self._renderer.sockets(hits[0].id, text)
        whole = self._blocks.whole(hits[0], rows[0], asked_of((), arguments if given else names))
        yield from islice(whole, 1)
        yield from told
        yield from self._animated(asked, hits, members)
        yield from self._lines.asked_members(hits[0], members)
        yield from _names_before_long(whole, [*self._others(hits, rows, members)])

    def found(
        self,
        hits: Sequence[Hit],
        rows: Sequence[RankedId],
        asked: Sequence[str],
        members: Sequence[str],
    ) -> Iterator[AnswerBlock]:
        """The best hit in brief, its members that are asked for, and the others. A page says how, but code needs names:
        they follow its heading.
        """
        found = self._lines.asked(hits[0], asked)
        told, names = self._asked_arguments(hits[0], found)
        own = f"{hits[0].id}."
        near = tuple(name for name in rows[0].members if own + name not in members)
        excerpt = self._blocks.excerpt(hits[0], rows[0]._replace(members=near), asked_of(found, names))
        others = [*self._others(hits, rows, members, asked)]
        yield next(excerpt)
        yield from self._animated(asked, hits, members)
        yield from self._lines.asked_members(hits[0], members)
        yield from told
        yield from self._made(hits[0], asked_of(found))
        if hits[0].is_page:
            yield from (block for block in others if block.name == NAMES)
            others = [block for block in others if block.name != NAMES]
        yield from excerpt
        yield from others

    def compared(
        self,
        hits: Sequence[Hit],
        rows: Sequence[RankedId],
        asked: Sequence[str],
        members: Sequence[str],
        sides: int,
    ) -> Iterator[AnswerBlock]:
        """What each of the first hits is, one for each of the ``sides``, then more of each, and what else was found."""
        told = {row.id for row in rows[:sides]}
        more: list[AnswerBlock] = []
        for hit, row in zip(hits[:sides], rows, strict=False):
            head, *rest = self._blocks.excerpt(hit, row._replace(members=()))
            yield head
            more += [AnswerBlock(f"### `{hit.id}`", hit.id), *rest] if rest else ()
        yield from self._lines.asked_members(hits[0], [path for path in members if path not in told])
        yield from more
        yield from self._others(hits, rows, members, asked, told=sides)

    def _asked_arguments(
        self, hit: Hit, found: Sequence[AskedValue]
    ) -> tuple[list[AnswerBlock], Collection[str]]:
        """The arguments of which a question has ``found`` values or words, and their names, unless all of them fit."""
        names = {value.argument for value in found if value.argument}
        told = [*self._renderer.arguments(hit.id, names, unless_all_fit=True)]
        return told, names if told else ()

    def _others(
        self,
        hits: Sequence[Hit],
        rows: Sequence[RankedId],
        members: Sequence[str],
        asked: Sequence[str] = (),
        told: int = 1,
    ) -> Iterator[AnswerBlock]:
        """A line for each hit behind the first ones that are ``told``. The ``members`` that are asked for are not among
        them; behind a page they are their first.
        """
        left = [place for place in range(told, len(hits)) if hits[place].id not in members]
        first = members if hits[0].is_page else ()
        return self._lines.further(
            [hits[place] for place in left], [rows[place] for place in left], asked, first=first
        )

    def _animated(
        self, asked: Sequence[str], hits: Sequence[Hit], members: Sequence[str]
    ) -> Iterator[AnswerBlock]:
        """How the best hit is animated, or a member that is asked for."""
        return animated(asked, (hits[0].id, *members), (hit.id for hit in hits), self._reader)

    def _made(self, hit: Hit, asked: AskedOf) -> Iterator[AnswerBlock]:
        """What the best hit makes with the values that are asked for."""
        symbol = self._reader.symbol(hit.id) if asked.values else None
        return made_with(symbol, asked.values, self._reader) if symbol else iter(())


def _names_before_long(whole: Iterable[AnswerBlock], others: Sequence[AnswerBlock]) -> Iterator[AnswerBlock]:
    """The blocks of what a query names, with what else was found; the names of that go before a long text of the
    manual: whoever asks for several wants these, and what it says can be read on.
    """
    late: list[AnswerBlock] = []
    for block in whole:
        is_long = block.name == MANUALS_WORDS and tokens(block.text) > _LONG_WORDS
        if is_long and others:
            late.append(block)
        else:
            yield block
    if late:
        yield from (block for block in others if block.name == NAMES)
        yield from late
        others = [block for block in others if block.name != NAMES]
    yield from others
