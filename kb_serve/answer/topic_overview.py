"""Overviews of topics (``cloth``, ``rigid body``, ``uv``): their pages, classes and operators."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms, topic_key
from kb_serve.answer.budget import AnswerBlock
from kb_serve.answer.render import first_sentence

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader, PageEntry, SymbolEntry

ASIDE_PAGES = ("contribute/", "addons/", "interface/controls/")
_MAX_WORDS = 4
_MOST = 200  # entries of one list


@dataclass(frozen=True, slots=True)
class TopicOverview:
    """The text on a topic, and the ids of its main classes and operators."""

    blocks: tuple[AnswerBlock, ...]
    members: tuple[str, ...]


class Topics:
    """Finds the manual page of a topic, and the symbols that Blender's own table links to it."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def find(self, text: str) -> str:
        """The slug of the manual page that a few plain words name; empty for none.

        Of several pages with that title, in singular or plural, the one with the most pages and symbols; a page
        without any is not a topic.
        """
        plain = text.strip().strip("`'\"?!.")
        if len(plain.split()) > _MAX_WORDS or any(char in plain for char in "._()[]=/"):
            return ""
        if plain != plain.lower() and self._is_class(plain):
            return ""
        slugs = {slug for _, slug in self._reader.by_key(topic_key(plain))}
        slugs |= {slug for _, slug in self._reader.by_key(key(plain)) if self._children(slug)}
        sizes = {slug: self._size(slug) for slug in slugs if self._is_topic(slug)}
        return max(sizes, key=lambda slug: (sizes[slug], slug)) if sizes else ""

    def _is_class(self, text: str) -> bool:
        """Whether a text in capitals may mean a class: ``Camera``, ``Particle System``, unlike ``Rigid Body``."""
        entries = (self._reader.entry(identifier) for _, identifier in self._reader.by_key(key(text)))
        return any(entry is not None and entry.kind == "class" for entry in entries)

    def _is_topic(self, slug: str) -> bool:
        page = self._reader.page_entry(slug)
        if page is None or page.source != "manual" or slug.startswith(ASIDE_PAGES):
            return False
        return bool(self._children(slug) or self._reader.symbols_of_page(slug))

    def _children(self, slug: str) -> list[PageEntry]:
        return self._reader.page_children(slug)

    def _size(self, slug: str) -> int:
        """The number of pages and symbols below a page: people rarely mean the smaller chapter."""
        below = self._subtree(slug)
        return len(below) + sum(len(self._reader.symbols_of_page(child)) for child in below)

    def _subtree(self, slug: str, depth: int = 3) -> list[str]:
        slugs = [slug]
        for child in self._children(slug) if depth else ():
            slugs += self._subtree(child.slug, depth - 1)
        return slugs

    def overview(self, slug: str) -> TopicOverview:
        """The page's summary, the pages below it, and the classes and operators that belong to it."""
        page = self._reader.page_entry(slug)
        assert page is not None
        words = set(terms(page.title))
        names = {key(page.title), key(slug.removesuffix("/index").rpartition("/")[2])}
        explained = [path for below in self._subtree(slug) for path in self._reader.symbols_of_page(below)]
        named = [path for name in sorted(names) for path in self._reader.classes_named(name)]
        named += [path for name in sorted(names) for path in self._reader.operators_of(name)]
        entries = [
            entry for path in dict.fromkeys((*explained, *named)) if (entry := self._reader.entry(path))
        ]
        classes = [entry for entry in entries if entry.kind == "class" and entry.group == "data"]
        classes.sort(key=lambda entry: self._order(entry, words))
        operators = [entry for entry in entries if entry.kind == "operator"]
        operators.sort(key=lambda entry: key(entry.owner.rpartition(".")[2]) not in names)
        blocks = [AnswerBlock(f"## {page.title}\n\n{page.summary}\n\n{page.url}", "summary")]
        blocks += _list_of("Classes", [_line(entry) for entry in classes])
        blocks += _list_of("Operators", [_line(entry) for entry in operators])
        blocks += _list_of("Pages", list(self._page_lines(slug)))
        return TopicOverview(tuple(blocks), tuple(entry.path for entry in (*classes[:6], *operators[:4])))

    def _order(self, entry: SymbolEntry, words: set[str]) -> tuple[bool, bool, int]:
        """Sorts classes with the topic's name first, and modifiers before their settings."""
        return (
            not words <= set(terms(entry.name)),
            not entry.name.endswith("Modifier"),
            -len(self._reader.members(entry.path)),
        )

    def _page_lines(self, slug: str, depth: int = 2) -> Iterator[str]:
        for child in self._children(slug):
            yield f"`{child.slug}` ({child.title}) {first_sentence(child.summary)}"
            if depth > 1:
                yield from (f"  {line}" for line in self._page_lines(child.slug, depth - 1))


def _line(entry: SymbolEntry) -> str:
    return f"`{entry.path}` — {first_sentence(entry.line.partition(' — ')[2]) or entry.label}"


def _list_of(title: str, lines: list[str]) -> list[AnswerBlock]:
    if not lines:
        return []
    items = "\n".join(
        f"- {line}" if not line.startswith("  ") else f"  - {line.strip()}" for line in lines[:_MOST]
    )
    more = f"\n- … {len(lines) - _MOST} more" if len(lines) > _MOST else ""
    return [AnswerBlock(f"**{title}**\n{items}{more}", title.lower())]
