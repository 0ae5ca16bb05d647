"""Overviews of topics (``cloth``, ``uv``): how it is done, then the names by weight, and the pages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.pages.definitions import passage_text
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.lines import first_sentence
from kb_serve.answer.budget import AnswerBlock, clip, tokens
from kb_serve.answer.pages import own_summary, said_of
from kb_serve.answer.steps.order import Steps, numbered
from kb_serve.answer.topic.classes_and_operators import TopicMembers
from kb_serve.answer.topic.meant_pages import TopicPages
from kb_serve.answer.topic.page_settings import TopicSettings
from kb_serve.answer.topic.titles import plain_title, subtree

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_serve.answer.steps.names.topic_names import TopicNames
    from kb_serve.lookups.records import PageEntry, SymbolEntry
    from kb_serve.reader import BaseReader

_EDITOR = f"{TYPES}Space"
_MOST_SETTINGS = 10
_LATEST_MAKER = 5  # among the first steps
STEPS = "how it is done"  # the name of the block that has them
_SET_UP = "Setup"  # title of a page's section
_HOW = "**How it is done**"
_DONE = ("set on `", "` → `", "` makes `", "`obj.")  # in steps that make, set or call something
_OVERVIEW_TOKENS = 1_200
_FIRST = (10, 8, 6, 5, 4, 3)  # entries of each list, as many as fit; the others follow all lists
_LINE_TOKENS = 50


@dataclass(frozen=True, slots=True)
class TopicOverview:
    """The text on a topic, the ids of its main classes and operators, and those of its settings if it has no classes.

    ``more``: what has no room among the ``first`` blocks. ``is_single``: whether it is on a single page; ``says_how``:
    whether the text says how it is done.
    """

    first: tuple[AnswerBlock, ...]
    more: tuple[AnswerBlock, ...]
    members: tuple[str, ...]
    settings: tuple[str, ...]
    is_single: bool
    says_how: bool

    @property
    def blocks(self) -> tuple[AnswerBlock, ...]:
        """The whole text."""
        return (*self.first, *self.more)


class Topics:
    """Finds the topics of one base by the words for them, and tells of each."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._settings = TopicSettings(reader)
        self._pages = TopicPages(reader, self._settings)
        self._members = TopicMembers(reader)

    def find(self, text: str) -> str:
        """The slug of the manual page that a few plain words name; empty for none."""
        return self._pages.find(text)

    def overview(self, slug: str) -> TopicOverview:
        """How it is done, then the classes and operators that belong to the topic by weight, and the pages below."""
        page = self._reader.manual.page_entry(slug)
        assert page is not None
        names = self._members.names(slug, page.title)
        telling = self._introduction(page) or page
        head = "\n\n".join(filter(None, (f"## {page.title}", said_of(telling, self._reader), telling.url)))
        classes, operators = self._entries(names.classes), self._entries(names.operators)
        is_single = not self._reader.manual.page_children(slug)
        settings = self._settings.labelled(slug) if is_single else []
        steps = [*self._how(page, names, settings)]
        blocks = [AnswerBlock(head, "summary"), *self._set_up(slug), *steps]
        lists = (
            ("See also", [*self._sent_to(slug)]),
            ("Classes", [_line(entry) for entry in classes]),
            ("Operators", [_line(entry) for entry in operators]),
            ("Pages", [*self._page_lines(slug)]),
        )
        spent = sum(tokens(block.text) for block in blocks)
        most = next(
            (most for most in _FIRST if spent + _size_of(lists, most) <= _OVERVIEW_TOKENS), _FIRST[-1]
        )
        for title, lines in lists:
            blocks += _list_of(title, lines[:most])
        more = [block for title, lines in lists for block in _list_of(f"More {title.lower()}", lines[most:])]
        members = tuple(entry.path for entry in (*classes[:6], *operators[:4]))
        # Those of a class that is named stand with it.
        named = () if classes else tuple(entry.path for entry in settings)
        return TopicOverview(tuple(blocks), tuple(more), members, named, is_single, says_how=bool(steps))

    def _how(
        self, page: PageEntry, names: TopicNames, settings: Sequence[SymbolEntry]
    ) -> Iterator[AnswerBlock]:
        """The steps, or else where the topic is a value; and what is set on the page without being told in them."""
        steps = Steps(self._reader, names).told()
        if steps:
            yield AnswerBlock("\n".join((_HOW, *numbered(steps))), STEPS)
        elif values := [*self._settings.as_value(plain_title(page), page.slug)]:
            yield AnswerBlock("\n".join((_HOW, *(f"- {value}" for value in values))), "as a value")
        if not any(said in step for step in steps for said in _DONE):
            settings = settings or self._of_chapter(page.slug)
        if steps:  # on a page about an editor how it looks is set, too
            settings = [entry for entry in settings if not self._reader.descends(entry.owner, _EDITOR)]
        told = "".join(steps)
        left = [entry for entry in settings if f"`{entry.name}`" not in told]
        yield from _list_of("Settings", [*self._settings.lines(left[:_MOST_SETTINGS])])

    def _set_up(self, slug: str) -> Iterator[AnswerBlock]:
        """What a page says must be there before: an image node that is baked to."""
        page = self._reader.manual.page(slug)
        for section in page.sections if page else ():
            if section.title == _SET_UP and (said := passage_text(section.text, -1)):
                yield AnswerBlock(f"**{_SET_UP}** (from the manual)\n{said}", "setup")

    def _of_chapter(self, slug: str) -> list[SymbolEntry]:
        """The heaviest settings that the pages of a chapter name beside their labels."""
        pages = subtree(slug, self._reader)
        labelled = dict.fromkeys(entry for page in pages for entry in self._settings.labelled(page))
        return self._reader.usage.heaviest(labelled)[:_MOST_SETTINGS] if len(pages) > 1 else []

    def first_steps(self, text: str, most: int) -> list[str]:
        """The first steps of a topic; more where what its page explains is made in a later one, as a node is in a tree;
        none for what is no topic.
        """
        slug = self.find(text)
        names = self._names(slug)
        lines = numbered(Steps(self._reader, names).told()) if names else []
        made = {f"→ `{path.removeprefix(TYPES)}`" for path in names.explained} if names else set[str]()
        first = next((number for number, line in enumerate(lines, 1) if any(one in line for one in made)), 0)
        return lines[: max(most, first if first <= _LATEST_MAKER else 0)]

    def steps(self, slug: str) -> list[str]:
        """The steps of a page's topic; none for what is no page, and where nothing is made, set or run."""
        names = self._names(slug)
        return Steps(self._reader, names).told() if names else []

    def _names(self, slug: str) -> TopicNames | None:
        page = self._reader.manual.page_entry(slug)
        return self._members.names(slug, page.title) if page else None

    def members(self, slug: str) -> frozenset[str]:
        """All classes and operators that belong to a topic."""
        page = self._reader.manual.page_entry(slug)
        assert page is not None
        names = self._members.names(slug, page.title)
        return frozenset({*names.classes, *names.operators})

    def _introduction(self, page: PageEntry) -> PageEntry | None:
        """The page that says what a page is about which only lists others, if one does."""
        below = self._reader.manual.page_children(page.slug)
        record = self._reader.manual.page(page.slug)
        is_hollow = record is None or not any(section.text for section in record.sections)
        is_told = is_hollow and below and below[0].title == "Introduction" and own_summary(below[0])
        return below[0] if is_told else None

    def _entries(self, paths: Sequence[str] | dict[str, float]) -> list[SymbolEntry]:
        return [entry for path in paths if (entry := self._reader.entry(path))]

    def _sent_to(self, slug: str) -> Iterator[str]:
        """The pages of other chapters that a chapter's first page names and links to, as that on what replaces it."""
        page = self._reader.manual.page(slug)
        if page is None or not page.children or len(page.sections) > 1:
            return
        text = " ".join(section.text for section in page.sections)
        for link in page.links:
            other = (
                None if link.startswith(slug.removesuffix("index")) else self._reader.manual.page_entry(link)
            )
            if other is not None and other.title in text:
                yield self._page_line(other)

    def _page_lines(self, slug: str, depth: int = 2) -> Iterator[str]:
        for child in self._reader.manual.page_children(slug):
            yield self._page_line(child)
            if depth > 1:
                yield from (f"  {line}" for line in self._page_lines(child.slug, depth - 1))

    def _page_line(self, page: PageEntry) -> str:
        said = first_sentence(said_of(page, self._reader))
        return clip(f"`{page.slug}` ({page.title}) {said}", _LINE_TOKENS)


def _line(entry: SymbolEntry) -> str:
    said = first_sentence(entry.line.partition(" — ")[2]) or entry.label
    return f"`{entry.path}`" + (f" — {said}" if said != entry.name else "")


def _size_of(lists: Iterable[tuple[str, Sequence[str]]], most: int) -> int:
    return sum(tokens(block.text) for title, lines in lists for block in _list_of(title, lines[:most]))


def _list_of(title: str, lines: Sequence[str]) -> list[AnswerBlock]:
    if not lines:
        return []
    items = "\n".join(f"  - {line.strip()}" if line.startswith("  ") else f"- {line}" for line in lines)
    return [AnswerBlock(f"**{title}**\n{items}", title.lower())]
