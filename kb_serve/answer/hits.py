"""The symbols and pages that an answer is about, as its caller gets them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.pages.page import PAGE_SOURCES
from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_serve.rank.ranked_id import RankedId
    from kb_serve.reader import BaseReader


@value_class
class Hit:
    """A symbol or page that the answer is about. ``id`` is a symbol path or a page slug."""

    id: str
    kind: str
    title: str
    score: float
    url: str = ""

    @property
    def is_page(self) -> bool:
        """Whether it is a page, not a symbol."""
        return self.kind in PAGE_SOURCES


def hits_of(rows: Sequence[RankedId], reader: BaseReader) -> tuple[Hit, ...]:
    """What was found, by its ids; all is read at once."""
    pages = {row.id for row in rows if reader.manual.is_page(row.id)}
    symbols = [row.id for row in rows if row.id not in pages]
    reader.manual.page_entry.load(pages)
    reader.entry.load(symbols)
    reader.manual.manual_url.load(symbols)
    return tuple(_hit(row, reader) for row in rows)


def _hit(row: RankedId, reader: BaseReader) -> Hit:
    score = round(row.score, 3)
    page = reader.manual.page_entry(row.id) if reader.manual.is_page(row.id) else None
    if page:
        url = page.url + (f"#{row.anchor}" if row.anchor else "")
        return Hit(row.id, page.source, page.title, score, url)
    entry = reader.entry(row.id)
    if entry is None:
        return Hit(row.id, "unknown", row.id, score)
    return Hit(row.id, entry.kind, entry.label or entry.name, score, reader.manual.manual_url(row.id))
