"""Topic words (``cloth``, ``rigid body``, ``uv``): an overview of what belongs together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.analysis import key
from kb_build.schema import FORM_LABEL, FORM_SHORT
from kb_serve.budget import Block
from kb_serve.render import first_sentence

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import PageEntry, Reader

_MAX_WORDS = 4
_MOST = 40


@dataclass(frozen=True, slots=True)
class Overview:
    """What is said of a topic, and the ids it names in the order of their use."""

    blocks: tuple[Block, ...]
    members: tuple[str, ...]


class Topics:
    """Finds the manual's page for a topic and what Blender's own table ties to it."""

    def __init__(self, reader: Reader) -> None:
        self._reader = reader

    def find(self, text: str) -> str:
        """The slug of the chapter that a few words name; empty when they name none.

        A chapter is a page with pages below it; of several with one title, the one with most below it.
        """
        plain = text.strip().strip("`'\"?!.").lower()
        if len(plain.split()) > _MAX_WORDS or any(char in plain for char in "._()[]="):
            return ""
        chapters = [
            (self._size(slug), slug)
            for form, slug in self._reader.by_key(key(plain))
            if form in {FORM_LABEL, FORM_SHORT} and self._reader.page_entry(slug) and self._children(slug)
        ]
        chapters += [
            (self._size(entry.slug), entry.slug)
            for entry in self._reader.pages_ending_in(plain.replace(" ", "_"))
            if self._children(entry.slug)
        ]
        return max(chapters)[1] if chapters else ""

    def _children(self, slug: str) -> list[PageEntry]:
        return self._reader.page_children(slug)

    def _size(self, slug: str) -> int:
        """How many symbols and pages hang on a chapter: what people mean is rarely the smaller one."""
        below = self._subtree(slug)
        return len(below) + sum(len(self._reader.symbols_of_page(child)) for child in below)

    def _subtree(self, slug: str, depth: int = 3) -> list[str]:
        slugs = [slug]
        for child in self._children(slug) if depth else ():
            slugs += self._subtree(child.slug, depth - 1)
        return slugs

    def overview(self, slug: str) -> Overview:
        """The chapter, its pages, and the classes, operators and modifiers that belong to it."""
        page = self._reader.page_entry(slug)
        assert page is not None
        symbols = list(
            dict.fromkeys(
                path for below in self._subtree(slug) for path in self._reader.symbols_of_page(below)
            )
        )
        entries = [entry for path in symbols if (entry := self._reader.entry(path))]
        classes = [entry for entry in entries if entry.kind == "class" and entry.group == "data"]
        classes.sort(key=lambda entry: ("Modifier" not in entry.name, -len(self._reader.members(entry.path))))
        operators = [entry for entry in entries if entry.kind == "operator"]
        blocks = [Block(f"## {page.title}\n\n{page.summary}\n\n{page.url}", "summary")]
        blocks += _listed(
            "Classes",
            [f"`{e.path}` — {first_sentence(e.line.partition(' — ')[2]) or e.label}" for e in classes],
        )
        blocks += _listed(
            "Operators",
            [f"`{e.path}` — {first_sentence(e.line.partition(' — ')[2]) or e.label}" for e in operators],
        )
        blocks += _listed("Pages", list(self._page_lines(slug)))
        return Overview(tuple(blocks), tuple(entry.path for entry in (*classes[:6], *operators[:4])))

    def _page_lines(self, slug: str, depth: int = 2) -> Iterator[str]:
        for child in self._children(slug):
            yield f"`{child.slug}` ({child.title}) {first_sentence(child.summary)}"
            if depth > 1:
                yield from (f"  {line}" for line in self._page_lines(child.slug, depth - 1))


def _listed(title: str, lines: list[str]) -> list[Block]:
    if not lines:
        return []
    shown = "\n".join(
        f"- {line}" if not line.startswith("  ") else f"  - {line.strip()}" for line in lines[:_MOST]
    )
    more = f"\n- … {len(lines) - _MOST} more" if len(lines) > _MOST else ""
    return [Block(f"**{title}**\n{shown}{more}", title.lower())]
