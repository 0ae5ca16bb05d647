"""Makes pages, with their place in the hierarchy, of what a reader found in each file."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING

from kb_build.pages.page import Page, PageSource, Section

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

ROOT = "index"
MOST_WARNINGS = 20
_MOST_LINKS = 1_000
_MOST_ABOVE = 20
_LONGEST_TITLE = 300
_URLS: dict[PageSource, str] = {
    "manual": "https://docs.blender.org/manual/en/{version}/{slug}.html",
    "guide": "https://docs.blender.org/api/{version}/{slug}.html",
}


@dataclass(frozen=True, slots=True)
class PageText:
    """One file as a reader understood it. ``links`` and ``children`` may name slugs that do not exist."""

    slug: str
    sections: tuple[Section, ...]
    children: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def assemble(texts: Iterable[PageText], *, source: PageSource, version: str) -> list[Page]:
    """Pages sorted by slug. Breadcrumbs come from who lists whom as a child: the first to do so, walking down
    from the page ``index``, is the parent. The front page itself stands above everything and is left out.
    """
    by_slug = {text.slug: text for text in texts}
    titles = {slug: _title(text) for slug, text in by_slug.items()}
    children = {slug: _existing(text.children, by_slug, slug) for slug, text in by_slug.items()}
    parents = _parents(children)
    pages: list[Page] = []
    for slug in sorted(by_slug):
        text = by_slug[slug]
        first, *rest = text.sections
        sections = (
            text.sections
            if first.title
            else (Section(anchor=first.anchor, title=titles[slug], level=first.level, text=first.text), *rest)
        )
        pages.append(
            Page(
                slug=slug,
                source=source,
                version=version,
                title=titles[slug],
                sections=sections,
                breadcrumbs=tuple(titles[above] for above in _ancestors(slug, parents)),
                children=children[slug],
                links=_existing(text.links, by_slug, slug),
                url=_URLS[source].format(version=version, slug=slug) if source in _URLS else "",
                warnings=tuple(dict.fromkeys(text.warnings))[:MOST_WARNINGS],
            )
        )
    return pages


def _title(text: PageText) -> str:
    if text.sections and text.sections[0].title:
        return text.sections[0].title[:_LONGEST_TITLE]
    parts = [part for part in text.slug.split("/") if part != ROOT] or [text.slug]
    return re.sub(r"[_-]+", " ", parts[-1]).strip().title()


def _existing(slugs: Iterable[str], by_slug: Mapping[str, PageText], own: str) -> tuple[str, ...]:
    existing = (slug for slug in dict.fromkeys(slugs) if slug in by_slug and slug != own)
    return tuple(islice(existing, _MOST_LINKS))


def _parents(children: Mapping[str, tuple[str, ...]]) -> dict[str, str]:
    """For each page the one above it. Loops are cut where they close."""
    listed = {child for below in children.values() for child in below}
    tops = [ROOT] if ROOT in children else []
    tops += [slug for slug in sorted(children) if slug not in listed and slug != ROOT]
    parents: dict[str, str] = {}
    seen: set[str] = set()
    for top in [*tops, *sorted(children)]:
        stack = [top] if top not in seen else []
        while stack:
            slug = stack.pop()
            if slug in seen:
                continue
            seen.add(slug)
            for child in reversed(children[slug]):
                if child not in seen:
                    parents[child] = slug
                    stack.append(child)
    return parents


def _ancestors(slug: str, parents: Mapping[str, str]) -> list[str]:
    above: list[str] = []
    while (slug := parents.get(slug, "")) and slug != ROOT and slug not in above and len(above) < _MOST_ABOVE:
        above.insert(0, slug)
    return above
