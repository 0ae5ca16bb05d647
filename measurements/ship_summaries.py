"""Writes what ships of summaries: ``python -m measurements.ship_summaries BASE STORE MODEL``.

Takes from a summary store what ``MODEL`` wrote for the pages of a base, and writes corpora/summaries. A phrase that does
not find its own page among the first ten of that base is dropped, as doc2query-- does (Gospodinov et al. 2023): it
would only mislead. The base must have been built with these very summaries (``simworlds kb build --summaries claude``).
"""

from __future__ import annotations

import sqlite3
import sys
from contextlib import closing
from pathlib import Path

from kb_build.summaries.prompt import PROMPT_VERSION
from kb_build.summaries.shipped import ShippedSummary, file_name
from kb_build.summaries.store import SummaryStore
from kb_build.summaries.types import summary_key
from kb_serve.knowledge_base import KnowledgeBase
from simworlds.files import write_whole

_FIRST = 10
_FOLDER = Path(__file__).parents[1] / "corpora" / "summaries"


def main(base: str, store: str, model: str) -> None:
    """Writes the file and prints how much was dropped."""
    with KnowledgeBase(Path(base)) as knowledge:
        pages = [page for slug in _slugs(Path(base)) if (page := knowledge.page(slug))]
        keys = {page.slug: summary_key(page.content_hash, PROMPT_VERSION, model) for page in pages}
        written = SummaryStore(Path(store)).get(keys.values())
        version = knowledge.meta["minor"]
        rows: list[ShippedSummary] = []
        phrases = kept = 0
        for page in pages:
            if (summary := written.get(keys[page.slug])) is None:
                continue
            finding = tuple(text for text in summary.phrases if _finds(knowledge, text, page.slug))
            rows.append(ShippedSummary(page.slug, page.content_hash, model, summary.text, finding))
            phrases, kept = phrases + len(summary.phrases), kept + len(finding)
    text = "".join(f"{row.to_line()}\n" for row in rows)
    write_whole(_FOLDER / file_name(version), text.encode())
    print(f"{len(rows)} of {len(pages)} pages; {kept} of {phrases} phrases find their page")


def _slugs(base: Path) -> list[str]:
    with closing(sqlite3.connect(f"{base.resolve().as_uri()}?mode=ro", uri=True)) as connection:
        return [slug for (slug,) in connection.execute("SELECT slug FROM pages ORDER BY slug")]


def _finds(knowledge: KnowledgeBase, phrase: str, slug: str) -> bool:
    return slug in (hit.id for hit in knowledge.query(phrase, limit=_FIRST).hits)


if __name__ == "__main__":
    main(*sys.argv[1:])
