"""Pages of the manual and of guides as Markdown, and what they say of symbols."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.pages.definitions import with_names
from kb_build.schema import BY_MODEL
from kb_build.symbols.lines import first_sentence
from kb_serve.answer.budget import AnswerBlock

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kb_build.pages.page import Section
    from kb_serve.lookups.records import PageEntry
    from kb_serve.reader import BaseReader

_SHORT_PAGE = 80  # letters
_OUTLINE = 16  # sections that a heading lists
# What the manual says of a setting may be true of one engine only.
ENGINES = {"render/eevee/": "EEVEE", "render/cycles/": "Cycles", "render/workbench/": "Workbench"}
_OF_ANGLES = "ROTATION"  # RNA's unit of radians
_DEGREES = re.compile(r"\d\s*°|\bdegrees?\b", re.IGNORECASE)
_IN_DEGREES = " · it speaks of degrees, as the window shows them: a script sets radians"
MANUALS_WORDS = "the manual's words"  # what the block is called


def page_blocks(slug: str, reader: BaseReader, anchor: str = "") -> Iterator[AnswerBlock]:
    """A page of the manual or a guide; the section ``anchor`` comes first."""
    page, entry = reader.manual.page(slug), reader.manual.page_entry(slug)
    if page is None or entry is None:
        return
    names = reader.manual.label_names(slug)
    above = " › ".join((*page.breadcrumbs, page.title))
    head = f"## {above}{_beside(names, 0, -1)}\n\n{page.url or slug}"
    if len(page.sections) > 2:
        head += f"\n\nSections: {outline(page.sections[1:])}"
    yield AnswerBlock(head, "heading")
    sections = sorted(enumerate(page.sections), key=lambda item: not _leads_to(anchor, item[1]))
    for number, section in sections:
        if section.text:
            heading = f"{'#' * min(6, section.level + 2)} {section.title}"
            plain = f"{heading}\n\n{section.text}"
            if number:  # the page's own name stands in its head
                heading += _beside(names, number, -1)
            text = f"{heading}\n\n{with_names(section.text, number, names)}"
            yield AnswerBlock(text, section.title, plain)
    below = reader.manual.page_children(slug)
    if below:
        yield AnswerBlock(
            "**Pages below**\n" + "\n".join(_page_line(page, reader) for page in below), "pages below"
        )
    elif sum(len(section.text) for section in page.sections) < _SHORT_PAGE:  # it only says where to look
        linked = [entry for link in page.links if (entry := reader.manual.page_entry(link))]
        if linked:
            yield AnswerBlock("**See**\n" + "\n".join(_page_line(page, reader) for page in linked), "see")


def _page_line(page: PageEntry, reader: BaseReader) -> str:
    """A page on one line: its address, its title, and what it says."""
    return f"- `{page.slug}` ({page.title}) {first_sentence(said_of(page, reader))}".rstrip()


def passage_block(path: str, reader: BaseReader, unit: str = "") -> Iterator[AnswerBlock]:
    """What the manual says about a symbol, and in which ``unit`` a script sets it where the window shows another."""
    slug, headings, text = reader.manual.passage_text(path)
    if text:
        engine = next((f"{name} › " for start, name in ENGINES.items() if slug.startswith(start)), "")
        aside = _IN_DEGREES if unit == _OF_ANGLES and _DEGREES.search(text) else ""
        yield AnswerBlock(f"**In the manual** ({engine}{headings}){aside}\n{text}", MANUALS_WORDS)


def said_of(page: PageEntry, reader: BaseReader) -> str:
    """A page's summary; of a page that only lists others, which these are."""
    if summary := own_summary(page):
        return summary
    titles = ", ".join(child.title for child in reader.manual.page_children(page.slug))
    return f"Contents: {titles}" if titles else ""


def own_summary(page: PageEntry) -> str:
    """A page's summary, marked where it is not of its own sentences; empty for a page that only lists others."""
    said = page.summary.removeprefix(page.title).lstrip(". ")
    if not said or said.startswith("Contents: "):
        return ""
    return page.summary if page.summary_method == "extractive" else f"{BY_MODEL}{page.summary}"


def _beside(names: Mapping[tuple[int, int], str], section: int, line: int) -> str:
    """What is added to a label: the names that scripts have for it."""
    name = names.get((section, line))
    return f" · {name}" if name else ""


def outline(sections: Sequence[Section]) -> str:
    """The titles of sections; of many, those of the highest level, as far as there is room for them."""
    highest = min(section.level for section in sections)
    many = len(sections) > _OUTLINE
    titles = [section.title for section in sections if not many or section.level == highest]
    left = len(sections) - len(titles[:_OUTLINE])
    return ", ".join(titles[:_OUTLINE]) + (f", and {left} more" if left else "")


def _leads_to(anchor: str, section: Section) -> bool:
    return bool(anchor) and (section.anchor == anchor or any(name == anchor for name, _ in section.marks))
