"""Pages of documentation, and how they are written as JSON. A leaf module."""

from __future__ import annotations

import hashlib
from dataclasses import fields
from typing import Any, Literal, get_args

from simworlds.schemas.value_class import value_class

PageSource = Literal["manual", "guide", "template"]
PAGE_SOURCES: tuple[PageSource, ...] = get_args(PageSource)


@value_class
class Section:
    """A titled part of a page: the unit of retrieval.

    ``text`` is Markdown without the heading itself; definition lists, field lists, notes, tables and code are
    kept, pictures become their captions. ``level`` is 1 for the page's title section. ``marks`` are the places in it
    that addresses of symbols lead to (``bpy-types-clothsettings-quality``), each with its line of ``text`` counted
    from 0; -1 is the heading.
    """

    anchor: str
    title: str
    level: int
    text: str
    marks: tuple[tuple[str, int], ...] = ()


@value_class
class Page:
    """One page of the manual, one guide, or one script template.

    ``slug`` is the page's address without suffix (``physics/cloth/settings/collisions``,
    ``info_gotchas_meshes``); ``version`` is the documentation's own, which may differ from Blender's.
    ``breadcrumbs`` are the titles of the pages above it, outermost first; ``children`` the slugs below it, in
    order; ``links`` the slugs that its text refers to.
    """

    slug: str
    source: PageSource
    version: str
    title: str
    sections: tuple[Section, ...]
    breadcrumbs: tuple[str, ...] = ()
    children: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    url: str = ""
    warnings: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The whole page as Markdown, headings included."""
        parts: list[str] = []
        for section in self.sections:
            parts.append(f"{'#' * max(1, section.level)} {section.title}")
            if section.text:
                parts.append(section.text)
        return "\n\n".join(parts)

    @property
    def content_hash(self) -> str:
        """SHA-256 of the text with its white space folded: equal for equal content, whatever the layout."""
        return hashlib.sha256(" ".join(self.text.split()).encode(errors="replace")).hexdigest()


_DEFAULTS = tuple((field.name, field.default) for field in fields(Page))


def page_to_json(page: Page) -> dict[str, Any]:
    """A page as a JSON-ready dictionary, without the fields that hold their default value."""
    values = {name: value for name, default in _DEFAULTS if (value := getattr(page, name)) != default}
    return {**values, "sections": [_section_row(section) for section in page.sections]}


def _section_row(section: Section) -> dict[str, Any]:
    """A section's fields; of thousands most have no marks."""
    plain = {"anchor": section.anchor, "title": section.title, "level": section.level, "text": section.text}
    return {**plain, "marks": section.marks} if section.marks else plain


def _section(row: dict[str, Any]) -> Section:
    marks = tuple((str(name), int(line)) for name, line in row.get("marks", ()))
    values: dict[str, Any] = {**row, "marks": marks}
    return Section(**values)


def page_from_json(data: dict[str, Any]) -> Page:
    """The inverse of :func:`page_to_json`. Raises TypeError on unknown fields."""
    values: dict[str, Any] = {
        **data,
        "sections": tuple(map(_section, data.get("sections", []))),
        "breadcrumbs": tuple(data.get("breadcrumbs", ())),
        "children": tuple(data.get("children", ())),
        "links": tuple(data.get("links", ())),
        "warnings": tuple(data.get("warnings", ())),
    }
    return Page(**values)
