"""Looks up pages, and what they say of symbols."""

from __future__ import annotations

import json
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

from kb_build.pages.page import Page, page_from_json
from kb_serve.lookups.kept_rows import KeptRows, grouped
from kb_serve.lookups.records import PAGE_COLUMNS, PageEntry

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_serve.lookups.base_file import BaseFile


class ManualLookups:
    """The pages of one base: of the manual, and of the guides and templates."""

    def __init__(self, file: BaseFile) -> None:
        self._file = file
        # A page's row, or None; the pages right below one, in the manual's order.
        self.page_entry = KeptRows(self._page_entries, None, 500)
        self.page_children = KeptRows(self._page_children, (), 100)
        # The targets of a symbol's links to the manual; the URL of the first that is a page.
        self.manual_links = KeptRows(self._manual_links, (), 500)
        self.manual_url = KeptRows(self._manual_urls, "", 500)
        # What scripts write for a page's labels: (section, line) → the names in Markdown; line -1 is the heading.
        self.label_names = KeptRows(self._label_names, {}, 100)
        # A page with its sections, or None. It is looked at several times while it is answered with.
        self.page = lru_cache(maxsize=8)(self._page)

    @cached_property
    def slugs(self) -> frozenset[str]:
        """The slugs of all pages."""
        return frozenset(slug for (slug,) in self._file.rows("SELECT slug FROM pages"))

    def is_page(self, identifier: str) -> bool:
        """Whether an id is a page's slug, and not a symbol's path."""
        return identifier in self.slugs

    @cached_property
    def missing_sources(self) -> list[str]:
        """What the documentation that the base was built without is to it: its manual."""
        return [row["role"] for row in json.loads(self._file.meta.get("missing", "[]"))]

    def _page_entries(self, slugs: Sequence[str]) -> dict[str, PageEntry | None]:
        rows = self._file.rows_of(f"SELECT {PAGE_COLUMNS} FROM pages WHERE slug", slugs)
        return {row[0]: PageEntry._make(row) for row in rows}

    def _page_children(self, slugs: Sequence[str]) -> dict[str, tuple[PageEntry, ...]]:
        rows = self._file.rows_of(
            f"SELECT parent, {PAGE_COLUMNS} FROM pages WHERE parent", slugs, "parent, position"
        )
        return grouped((row[0], PageEntry._make(row[1:])) for row in rows)

    def _page(self, slug: str) -> Page | None:
        rows = self._file.rows("SELECT record FROM pages WHERE slug = ?", slug)
        return self._file.record(page_from_json, rows[0][0]) if rows else None

    def _manual_links(self, sources: Sequence[str]) -> dict[str, tuple[str, ...]]:
        sql = "SELECT source, target FROM links WHERE kind = 'manual' AND source"
        return grouped(self._file.rows_of(sql, sources, "place"))

    def _manual_urls(self, sources: Sequence[str]) -> dict[str, str]:
        sql = """SELECT links.source, url || substr(target, instr(target || '#', '#')) FROM links
            JOIN pages ON slug = substr(target, 1, instr(target || '#', '#') - 1)
            WHERE kind = 'manual' AND links.source"""
        return dict(self._file.rows_of(sql, sources, "place DESC"))

    def _label_names(self, slugs: Sequence[str]) -> dict[str, dict[tuple[int, int], str]]:
        rows = self._file.rows_of("SELECT slug, section, line, names FROM label_names WHERE slug", slugs)
        names: dict[str, dict[tuple[int, int], str]] = {}
        for slug, section, line, text in rows:
            names.setdefault(slug, {})[section, line] = text
        return names

    def passage(self, path: str) -> tuple[str, int, int] | None:
        """(slug, number of the section, line of its text) of the place in the manual that is about a symbol."""
        rows = self._file.rows("SELECT slug, section, line FROM passages WHERE path = ?", path)
        return rows[0] if rows else None

    def passage_text(self, path: str) -> tuple[str, str, str]:
        """(slug, headings, text) of that place; all empty where there is none."""
        rows: list[tuple[str, str, str]] = self._file.rows(
            "SELECT slug, headings, text FROM passages WHERE path = ?", path
        )
        return rows[0] if rows else ("", "", "")

    def symbols_of_page(self, slug: str) -> list[str]:
        """The symbols that a page explains, by Blender's own table."""
        return [row[0] for row in self._file.rows("SELECT symbol FROM explained WHERE slug = ?", slug)]
