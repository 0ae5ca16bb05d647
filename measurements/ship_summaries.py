"""Writes what ships of summaries: ``python -m measurements.ship_summaries BASE [STORE MODEL]``.

Keeps what ships for the pages of a base, and adds what ``MODEL`` wrote for others, from a summary store. A phrase that
does not find its own page among the first ten of that base is dropped, as doc2query-- does (Gospodinov et al. 2023): it
would only mislead. So the base must have been built with these very summaries.
"""

from __future__ import annotations

import sqlite3
import sys
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from kb_build.summaries.prompt import PROMPT_VERSION
from kb_build.summaries.shipped import ShippedSummary, file_name, shipped_summaries
from kb_build.summaries.store import SummaryStore
from kb_build.summaries.types import summary_key
from kb_serve.knowledge_base import KnowledgeBase
from measurements.ship_phrases import finds
from simworlds.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kb_build.pages.page import Page
    from kb_build.summaries.types import PageSummary

_FOLDER = Path(__file__).parents[1] / "corpora" / "summaries"


def main(base: str, store: str = "", model: str = "") -> None:
    """Writes the file and prints how much was dropped."""
    files: dict[str, list[ShippedSummary]] = {}
    phrases = 0
    with KnowledgeBase(Path(base)) as knowledge:
        pages = [page for slug in _slugs(Path(base)) if (page := knowledge.page(slug))]
        written = {**(_bought(pages, Path(store), model) if store else {}), **shipped_summaries(pages)}
        version = knowledge.meta["minor"]
        for page in pages:
            if (summary := written.get(page.slug)) is None:
                continue
            found = tuple(text for text in summary.phrases if finds(knowledge, text, page.slug))
            row = ShippedSummary(page.slug, page.content_hash, summary.model, summary.text, found)
            files.setdefault(file_name(version, page.slug), []).append(row)
            phrases += len(summary.phrases)
    for name, rows in files.items():
        write_whole(_FOLDER / name, "".join(f"{row.to_line()}\n" for row in rows))
    rows = [row for some in files.values() for row in some]
    kept = sum(len(row.phrases) for row in rows)
    print(f"{len(rows)} of {len(pages)} pages; {kept} of {phrases} phrases find their page")


def _bought(pages: Sequence[Page], store: Path, model: str) -> Mapping[str, PageSummary]:
    keys = {page.slug: summary_key(page.content_hash, PROMPT_VERSION, model) for page in pages}
    summaries = SummaryStore(store).get(keys.values())
    return {slug: summaries[key] for slug, key in keys.items() if key in summaries}


def _slugs(base: Path) -> list[str]:
    with closing(sqlite3.connect(f"{base.resolve().as_uri()}?mode=ro", uri=True)) as connection:
        return [slug for (slug,) in connection.execute("SELECT slug FROM pages ORDER BY slug")]


if __name__ == "__main__":
    main(*sys.argv[1:])
