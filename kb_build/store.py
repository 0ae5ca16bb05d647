"""Writes a knowledge base as one SQLite file, atomically."""

from __future__ import annotations

import json
import os
import sqlite3
from array import array
from collections import Counter
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING

import sqlite_utils

from kb_build.errors import StoreError
from kb_build.index.documents import Document, kind_of, make_units, topic_documents
from kb_build.index.everyday_words import lend, load_everyday_words, unknown_of
from kb_build.index.label_names import find_label_names
from kb_build.index.operator_labels import find_labelled_operators, passages_of
from kb_build.index.panel_passages import find_panel_passages
from kb_build.index.passage_texts import passage_rows
from kb_build.index.passages import find_passages
from kb_build.index.postings import (
    TOPIC_B,
    UNIT_B,
    PostingList,
    document_postings,
    pack_postings,
    phrase_postings,
    vocabulary,
)
from kb_build.index.query_expansions import load_query_expansions, page_expansions, placed_expansions
from kb_build.index.stem_numbers import StemNumbers
from kb_build.index.value_names import find_value_names
from kb_build.index.weights import symbol_weights
from kb_build.pages.page import PAGE_SOURCES, Page, page_to_json
from kb_build.recipes.rows import recipe_rows, recipe_words
from kb_build.schema import (
    APPLICATION_ID,
    DDL,
    DOCUMENT_KINDS,
    INDEXES,
    SCHEMA_VERSION,
    TOPICS,
    UNITS,
    pack,
)
from kb_build.symbols.tables import SymbolTables, symbol_tables
from kb_build.versions.removed_symbols import RemovedSymbols
from simworlds.files import staged_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from kb_build.blender.buttons import Button
    from kb_build.recipes.tables import Recipe
    from kb_build.summaries.types import PageSummary
    from kb_build.symbols.records import Link, Symbol
    from kb_build.usage.examples import Uses


_MEMBERS = frozenset({"property", "function", "socket"})
_FEW_CALLED_SO = 3


@dataclass(frozen=True, slots=True)
class Contents:
    """Everything that goes into one base.

    ``summaries`` are by slug, ``buttons`` by operator. ``removed_symbols`` and ``tables`` are called as late as can be:
    they may still be computed meanwhile. Without ``tables``, they are made of symbols and pages, as if no script used
    the symbols.
    """

    symbols: Sequence[Symbol]
    pages: Sequence[Page]
    links: Sequence[Link]
    meta: Mapping[str, str]
    summaries: Mapping[str, PageSummary] = field(default_factory=dict[str, "PageSummary"])
    removed_symbols: Callable[[], RemovedSymbols] = RemovedSymbols
    still_works: Sequence[tuple[str, str]] = ()
    tables: Callable[[], SymbolTables] | None = None
    buttons: Mapping[str, Sequence[Button]] = field(default_factory=dict[str, "Sequence[Button]"])
    recipes: Sequence[Recipe] = ()


def _insert(
    connection: sqlite3.Connection, table: str, rows: Iterable[tuple[object, ...]], width: int
) -> None:
    marks = ",".join("?" * width)
    connection.executemany(f"INSERT OR IGNORE INTO {table} VALUES ({marks})", rows)  # noqa: S608


def _write_symbols(connection: sqlite3.Connection, tables: SymbolTables) -> None:
    _insert(connection, "symbols", tables.symbols, 17)
    _insert(connection, "names", tables.names, 3)
    _insert(connection, "enum_items", tables.enum_items, 4)
    _insert(connection, "operator_arguments", tables.operator_arguments, 2)
    _insert(connection, "creation", tables.creation, 4)
    _insert(connection, "setting_conditions", tables.conditions, 5)


def _places(pages: Sequence[Page]) -> dict[str, tuple[str, int]]:
    """slug → (the page above it, its place there)."""
    return {child: (page.slug, place) for page in pages for place, child in enumerate(page.children)}


def _explained(symbols: Sequence[Symbol], links: Sequence[Link]) -> Iterator[tuple[str, str]]:
    listed = {symbol.path for symbol in symbols if symbol.kind == "operator" or symbol.group == "data"}
    for link in links:
        if link.kind == "manual" and link.source in listed:
            yield link.target.partition("#")[0], link.source


def _refusals(symbols: Sequence[Symbol]) -> Iterator[tuple[str, str]]:
    for symbol in symbols:
        for refusal in symbol.refusals:
            if refusal.message:
                yield refusal.message, symbol.path


def _write_removed_symbols(connection: sqlite3.Connection, removed_symbols: RemovedSymbols) -> None:
    _insert(connection, "removed", removed_symbols.removed, 5)
    _insert(connection, "removed_names", sorted(removed_symbols.names), 2)
    _insert(connection, "successors", removed_symbols.successors, 6)
    _insert(connection, "similar_names", removed_symbols.similar_names, 3)
    _insert(connection, "since", removed_symbols.since, 3)
    _insert(connection, "moved_sockets", removed_symbols.moved_sockets, 3)
    if removed_symbols.versions:
        facts = {
            "history_versions": removed_symbols.versions,
            "unknown_modules": removed_symbols.unknown_modules,
        }
        _insert(connection, "meta", [(name, json.dumps(value)) for name, value in facts.items()], 2)


def _write_usage(connection: sqlite3.Connection, usage: Mapping[str, Uses]) -> None:
    examples = (
        (path, rank, example.file, example.line, example.code)
        for path, uses in usage.items()
        for rank, example in enumerate(uses.examples)
    )
    _insert(connection, "uses", examples, 5)
    _insert(connection, "use_counts", ((path, uses.count, uses.files) for path, uses in usage.items()), 3)


def _write_pages(
    connection: sqlite3.Connection, pages: Sequence[Page], summaries: Mapping[str, PageSummary]
) -> None:
    places = _places(pages)
    for page in pages:
        summary = summaries.get(page.slug)
        text, method = (summary.text, summary.method) if summary else ("", "")
        record = pack(page_to_json(page))
        row = (
            page.slug, page.source, page.version, page.title, *places.get(page.slug, ("", 0)), page.url,
            page.content_hash, text, method, record,
        )  # fmt: skip
        connection.execute("INSERT OR IGNORE INTO pages VALUES (?,?,?,?,?,?,?,?,?,?,?)", row)
        connection.executemany(
            "INSERT INTO sections (slug, position, anchor, title, level) VALUES (?,?,?,?,?)",
            (
                (page.slug, position, section.anchor, section.title, section.level)
                for position, section in enumerate(page.sections)
            ),
        )


def _write_level(
    connection: sqlite3.Connection,
    level: int,
    documents: Sequence[Document],
    topics: Mapping[str, int],
    stems: StemNumbers,
) -> dict[str, PostingList]:
    """Writes the documents of one level; returns their posting lists. ``topics``: ref → number."""
    chapters: dict[str, int] = {}
    explained: dict[str, int] = {"": -1}
    columns = (
        array("i", [topics.get(document.topic, -1) for document in documents]),
        array("i", [chapters.setdefault(document.chapter, len(chapters)) for document in documents]),
        array("i", [explained.setdefault(document.explained, len(explained)) for document in documents]),
        array("B", [DOCUMENT_KINDS.index(kind_of(document)) for document in documents]),
        array("B", [document.kind in _MEMBERS for document in documents]),
    )
    refs = "\n".join(document.ref for document in documents)
    anchors = "\n".join(document.anchor for document in documents)
    row = (level, len(documents), refs, anchors, *(column.tobytes() for column in columns))
    _insert(connection, "levels", (row,), len(row))
    return document_postings(documents, UNIT_B if level == UNITS else TOPIC_B, stems)


def _phrases(
    units: Sequence[Document],
    topics: Sequence[Document],
    targets: Mapping[str, int],
    expansions: Mapping[str, str],
) -> Iterator[tuple[str, int]]:
    """(phrase, number of the document that it leads to): the query expansions, titles of pages and of sections, names
    of symbols with their class. Many pages have an Example: a section's title leads to it if few others are called so.
    """
    for ref, row in expansions.items():
        if ref in targets:
            for phrase in row.split(";"):
                yield phrase, targets[ref]
    for topic in topics:
        if topic.kind in PAGE_SOURCES:
            yield topic.title, targets[topic.ref]
    called = Counter(unit.heading[0] for unit in units if unit.anchor)
    for number, unit in enumerate(units):
        if unit.anchor and called[unit.heading[0]] <= _FEW_CALLED_SO:
            yield unit.heading[0], number
        elif unit.kind in _MEMBERS:
            yield " ".join((unit.context[0], *unit.name, *unit.heading)), targets[unit.ref]


def write_index(
    connection: sqlite3.Connection,
    units: Sequence[Document],
    expansions: Mapping[str, str],
    recipes: Sequence[Recipe] = (),
) -> None:
    """Writes what retrieval reads: the units, the topics around them, the phrases that lead to either, the recipes."""
    topics = [*topic_documents(units)]
    numbers = {topic.ref: number for number, topic in enumerate(topics)}
    stems = StemNumbers()
    of_units = _write_level(connection, UNITS, units, numbers, stems)
    of_topics = _write_level(connection, TOPICS, topics, numbers, stems)
    # Phrases lead to a symbol's unit, but to a page as a whole.
    targets = {
        unit.ref: len(units) + numbers[unit.ref] if unit.kind in PAGE_SOURCES else number
        for number, unit in enumerate(units)
    }
    phrases = [*_phrases(units, topics, targets, expansions)]
    leads_to, of_phrases = phrase_postings(phrases, len(units), of_units, stems)
    connection.execute("INSERT INTO phrases VALUES (?)", (array("i", leads_to).tobytes(),))
    _insert(connection, "recipes", recipe_rows(recipes), 5)
    _insert(connection, "recipe_words", recipe_words(recipes, of_units, len(units)), 4)
    words = unknown_of(load_everyday_words(), of_units)
    for postings in (of_units, of_topics):
        lend(postings, words)
    levels = (0, of_units), (len(units), of_topics), (len(units) + len(topics), of_phrases)
    _insert(connection, "postings", pack_postings(*levels), 3)
    _insert(connection, "vocabulary", vocabulary(units, stems), 2)


def write_base(path: Path, contents: Contents) -> None:
    """Writes ``contents`` to ``path``: into a temporary file beside it, then renamed over it.

    A reader sees the old base or the new one, whatever happens in between. Raises StoreError when the disk is
    full or the folder cannot be written; nothing is left behind then.
    """
    try:
        with staged_file(path) as part:
            _write(part, contents)
            with part.open("rb") as file:
                os.fsync(file.fileno())
    except (OSError, sqlite3.Error) as error:
        raise StoreError(
            f"{path}: the knowledge base cannot be written: {error}. The old one, if any, is unchanged."
        ) from error


def _write(part: Path, contents: Contents) -> None:
    database = sqlite_utils.Database(part)
    connection = database.conn
    assert connection is not None
    try:
        connection.executescript(
            f"PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; PRAGMA application_id={APPLICATION_ID};"
            f"PRAGMA user_version={SCHEMA_VERSION};{DDL}"
        )
        symbols, pages = contents.symbols, contents.pages
        removed_symbols = cache(contents.removed_symbols)
        known = {symbol.path for symbol in symbols}
        placed = placed_expansions(load_query_expansions(), known, removed_symbols)
        expansions = placed | page_expansions(contents.summaries)
        labelled = find_labelled_operators(symbols, pages, contents.links, contents.buttons)
        passages = passages_of(labelled, pages) | find_passages(symbols, pages, contents.links)
        units = make_units(symbols, pages, contents.links, contents.summaries, expansions, passages)
        with connection:
            _write_pages(connection, contents.pages, contents.summaries)
            write_index(connection, units, expansions, contents.recipes)
            _write_removed_symbols(connection, removed_symbols())
            _insert(connection, "still_works", contents.still_works, 2)
            _insert(connection, "refusals", _refusals(contents.symbols), 2)
            _insert(connection, "explained", _explained(contents.symbols, contents.links), 2)
            links = enumerate(contents.links)
            _insert(
                connection, "links", ((one.source, one.kind, place, one.target) for place, one in links), 4
            )
            tables = contents.tables() if contents.tables else symbol_tables(contents.symbols, contents.pages)
            _write_symbols(connection, tables)
            _write_usage(connection, tables.uses)
            # The search does without these: it is written while the scripts are read that tell of panels.
            places = passages | find_panel_passages(symbols, pages, contents.links, tables.panels, passages)
            names = find_label_names(symbols, pages, places, labelled)
            labels = (*names, *find_value_names(symbols, pages, places))
            _insert(connection, "label_names", labels, 4)
            _insert(connection, "passages", passage_rows(places, pages, labels), 6)
            # How often people ask who do not know the name; some areas have more plain questions than others.
            asked = placed_expansions(load_query_expansions(plain=False), known, removed_symbols)
            weights = symbol_weights(contents.symbols, passages, asked, tables.uses)
            _insert(connection, "weights", weights.items(), 2)
            _insert(connection, "meta", contents.meta.items(), 2)
        connection.executescript(
            f"{INDEXES} ANALYZE; VACUUM;"
        )  # pages that were filled in no order are half empty
    finally:
        database.close()
