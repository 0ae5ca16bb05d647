"""What the base's search is compared with: plain rankings of the very same documents.

A document is a unit of the base (a section of a page, or a symbol); its words are the base's own (stems, stop
words left out, identifiers taken apart), so that what differs is the ranking alone. A name counts three times.
"""

from __future__ import annotations

import sqlite3
from contextlib import closing
from functools import cache, cached_property
from itertools import chain
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import numpy as np
from rank_bm25 import BM25Okapi

from kb_build.index.analysis import terms
from kb_build.index.documents import Document, make_units
from kb_build.index.query_expansions import query_expansions
from kb_build.schema import unpack
from kb_build.summaries.methods import summarise
from kb_build.symbols.records import Link, symbol_from_json
from kb_serve.knowledge_base import KnowledgeBase

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

NAME_WEIGHT = 3
CANDIDATES = 200
_DEPTH = 50  # documents looked at for the first ids: sections of one page are one id


def read_units(base: Path, expansions: Mapping[str, str] | None = None) -> list[Document]:
    """The documents of a base, made anew from its records; with other ``expansions`` than its own, if given."""
    with closing(sqlite3.connect(f"file:{quote(str(base.resolve()))}?mode=ro", uri=True)) as connection:
        symbols = [
            symbol_from_json(unpack(record))
            for (record,) in connection.execute("SELECT record FROM symbols ORDER BY id")
        ]
        links = [Link(*row) for row in connection.execute("SELECT source, target, kind FROM links")]
        slugs = connection.execute("SELECT slug FROM pages").fetchall()
    with KnowledgeBase(base) as knowledge:
        pages = [page for (slug,) in slugs if (page := knowledge.page(slug)) is not None]
    summaries = summarise(pages).by_slug
    used = query_expansions(summaries) if expansions is None else expansions
    return make_units(symbols, pages, links, summaries, used)


class Baselines:
    """The three rankings. They share one set of documents."""

    def __init__(self, units: Sequence[Document]) -> None:
        self._refs = [unit.ref for unit in units]
        analysed = cache(terms)

        def found(texts: Iterable[str]) -> list[str]:
            return list(chain.from_iterable(analysed(text) for text in texts if text))

        self._names = [found((*unit.name, *unit.heading)) for unit in units]
        self._rests = [found((*unit.context, *unit.body, *unit.related, *unit.expansions)) for unit in units]
        self._index = sqlite3.connect(":memory:")
        self._index.execute("CREATE VIRTUAL TABLE flat USING fts5 (name, rest, content='', detail=full)")
        self._index.executemany(
            "INSERT INTO flat (rowid, name, rest) VALUES (?, ?, ?)",
            (
                (number, " ".join(name), " ".join(rest))
                for number, (name, rest) in enumerate(zip(self._names, self._rests, strict=True))
            ),
        )

    @cached_property
    def _okapi(self) -> Any:
        return BM25Okapi(
            [name * NAME_WEIGHT + rest for name, rest in zip(self._names, self._rests, strict=True)]
        )

    def close(self) -> None:
        """Frees the index."""
        self._index.close()

    def fts5(self, query: str) -> list[str]:
        """Ids by FTS5's own bm25, any word of the query."""
        return self._ids(self._candidates(query, _DEPTH))

    def rank_bm25(self, query: str) -> list[str]:
        """Ids by rank-bm25's BM25Okapi over every document."""
        scores = np.asarray(self._okapi.get_scores(terms(query)))
        best = np.argsort(-scores, kind="stable")[:_DEPTH]
        return self._ids(int(number) for number in best if scores[number] > 0)

    def rank_bm25_over_fts5(self, query: str) -> list[str]:
        """Ids by rank-bm25's BM25Okapi, over FTS5's candidates only."""
        candidates = self._candidates(query, CANDIDATES)
        if not candidates:
            return []
        scores = np.asarray(self._okapi.get_batch_scores(terms(query), candidates))
        return self._ids(candidates[int(place)] for place in np.argsort(-scores, kind="stable")[:_DEPTH])

    def _candidates(self, query: str, limit: int) -> list[int]:
        words = dict.fromkeys(terms(query))
        if not words:
            return []
        anything = " OR ".join(f'"{word}"' for word in words)
        rows = self._index.execute(
            "SELECT rowid FROM flat WHERE flat MATCH ? ORDER BY bm25(flat, ?, 1.0) LIMIT ?",
            (anything, float(NAME_WEIGHT), limit),
        )
        return [number for (number,) in rows]

    def _ids(self, numbers: Iterable[int]) -> list[str]:
        return list(dict.fromkeys(self._refs[number] for number in numbers))
