"""Writes a knowledge base: one SQLite file, whole or not at all."""

from __future__ import annotations

import json
import os
import sqlite3
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import sqlite_utils

from kb_build.analysis import STOP_WORDS, index_text, key, stem, words
from kb_build.errors import StoreError
from kb_build.records import Link, Page, Symbol, to_json
from kb_build.schema import (
    APPLICATION_ID,
    DDL,
    FORM_LABEL,
    FORM_NAME,
    FORM_PATH,
    FORM_SHORT,
    INDEXES,
    SCHEMA_VERSION,
    pack,
)

_PREFIXES = ("bpy.types.", "bpy.ops.", "bpy.")


@dataclass(frozen=True, slots=True)
class Contents:
    """Everything that goes into one base. ``summaries`` are slug → (text, method)."""

    symbols: Sequence[Symbol]
    pages: Sequence[Page]
    links: Sequence[Link]
    meta: Mapping[str, str]
    summaries: Mapping[str, tuple[str, str]] = field(default_factory=dict)


def short_path(path: str) -> str:
    """A path without the prefix that people leave out: ``ClothSettings.quality``, ``object.modifier_add``."""
    for prefix in _PREFIXES:
        if path.startswith(prefix):
            return path[len(prefix) :]
    return path


def symbol_names(symbol: Symbol) -> Iterator[tuple[str, int, str]]:
    """(key, form, path) for every spelling under which a symbol is asked for."""
    short = short_path(symbol.path)
    yield key(symbol.path), FORM_PATH, symbol.path
    yield key(short), FORM_SHORT, symbol.path
    if symbol.kind == "operator":
        yield key(symbol.target), FORM_SHORT, symbol.path
    if symbol.group in {"ui", "operator"} or symbol.name.startswith("bl_rna_get_subclass"):
        return
    yield key(symbol.name), FORM_NAME, symbol.path
    if symbol.kind == "class" and symbol.owner == "bpy.types":
        yield key(f"types.{symbol.name}"), FORM_SHORT, symbol.path
    if symbol.label and symbol.kind != "socket":
        yield key(symbol.label), FORM_LABEL, symbol.path


def page_names(page: Page) -> Iterator[tuple[str, int, str]]:
    """(key, form, slug) for a page: its slug, the slug's last part, its title."""
    yield key(page.slug), FORM_PATH, page.slug
    yield key(page.slug.removesuffix("/index")), FORM_SHORT, page.slug
    yield key(page.title), FORM_LABEL, page.slug


def enum_rows(symbol: Symbol) -> Iterator[tuple[str, str, str, str]]:
    """(key, owner, identifier, name) of a symbol's own enum items and of its parameters'."""
    if symbol.kind == "enum":
        return
    for item in symbol.enum_items:
        yield key(item.identifier), symbol.path, item.identifier, item.name
    for parameter in symbol.parameters:
        for item in parameter.enum_items:
            yield key(item.identifier), f"{symbol.path}({parameter.name})", item.identifier, item.name


@dataclass(frozen=True, slots=True)
class Doc:
    """One unit of retrieval: its id, what it is called, and the five texts that are indexed."""

    ref: str
    kind: str
    title: str
    anchor: str = ""
    group: str = ""
    name: tuple[str, ...] = ()
    heading: tuple[str, ...] = ()
    context: tuple[str, ...] = ()
    body: tuple[str, ...] = ()
    related: tuple[str, ...] = ()


def _indexed(symbol: Symbol, owner: Symbol | None) -> bool:
    if symbol.kind == "enum" or symbol.name.startswith("bl_rna_get_subclass"):
        return False
    return symbol.group not in {"ui", "operator"} and not (owner and owner.group in {"ui", "operator"})


def symbol_docs(symbols: Sequence[Symbol]) -> Iterator[Doc]:
    """A unit for every symbol that a script works with."""
    by_path = {symbol.path: symbol for symbol in symbols}
    sockets: dict[str, list[str]] = {}
    for symbol in symbols:
        if symbol.kind == "socket":
            sockets.setdefault(symbol.owner, []).append(symbol.name)
    for symbol in symbols:
        owner = by_path.get(symbol.owner)
        if not _indexed(symbol, owner):
            continue
        items = [f"{item.identifier} {item.name} {item.description}" for item in symbol.enum_items]
        arguments = [f"{parameter.name} {parameter.description}" for parameter in symbol.parameters]
        results = [f"{result.name} {result.description}" for result in symbol.returns]
        yield Doc(
            ref=symbol.path,
            kind=symbol.kind,
            title=symbol.label or symbol.name,
            group=symbol.owner,
            name=(symbol.name,),
            heading=(symbol.label,),
            context=(short_path(symbol.owner), owner.label if owner else ""),
            body=(symbol.description, *items, *arguments, *results),
            related=tuple(sockets.get(symbol.path, ())),
        )


def page_docs(pages: Sequence[Page], summaries: Mapping[str, tuple[str, str]]) -> Iterator[Doc]:
    """A unit for every section of every page."""
    for page in pages:
        above = " ".join(page.breadcrumbs)
        for section in page.sections:
            first = section.level == 1
            yield Doc(
                ref=page.slug,
                kind=page.source,
                title=page.title if first else f"{page.title} › {section.title}",
                anchor="" if first else section.anchor,
                group=page.slug,
                name=(page.slug,) if first else (),
                heading=(section.title,),
                context=(above,) if first else (above, page.title),
                body=(section.text,),
                related=(summaries.get(page.slug, ("", ""))[0],) if first else (),
            )


def _vocabulary(docs: Iterable[Doc]) -> Iterator[tuple[str, int, str]]:
    """(stem, number of units, most used spelling) for the corpus' words."""
    spellings: dict[str, Counter[str]] = {}
    df: Counter[str] = Counter()
    for doc in docs:
        seen: set[str] = set()
        for text in (*doc.name, *doc.heading, *doc.context, *doc.body, *doc.related):
            for word in words(text):
                if word not in STOP_WORDS:
                    stemmed = stem(word)
                    seen.add(stemmed)
                    spellings.setdefault(stemmed, Counter())[word] += 1
        df.update(seen)
    for stemmed, count in df.items():
        yield stemmed, count, spellings[stemmed].most_common(1)[0][0]


def _insert(connection: sqlite3.Connection, table: str, rows: Iterable[tuple[object, ...]], width: int) -> None:
    marks = ",".join("?" * width)
    connection.executemany(f"INSERT OR IGNORE INTO {table} VALUES ({marks})", rows)  # noqa: S608


def _write_symbols(connection: sqlite3.Connection, symbols: Sequence[Symbol]) -> None:
    _insert(
        connection,
        "symbols",
        (
            (
                number, symbol.path, symbol.kind, symbol.owner, symbol.name, symbol.type, symbol.target,
                symbol.collection, symbol.base, symbol.group, symbol.label,
                pack(to_json(symbol)),
            )
            for number, symbol in enumerate(symbols)
        ),
        12,
    )  # fmt: skip
    _insert(connection, "names", (row for symbol in symbols for row in symbol_names(symbol)), 3)
    _insert(connection, "enum_items", (row for symbol in symbols for row in enum_rows(symbol)), 4)


def _parents(pages: Sequence[Page]) -> dict[str, str]:
    return {child: page.slug for page in pages for child in page.children}


def _write_pages(
    connection: sqlite3.Connection, pages: Sequence[Page], summaries: Mapping[str, tuple[str, str]]
) -> None:
    parents = _parents(pages)
    for page in pages:
        text, method = summaries.get(page.slug, ("", ""))
        record = pack({k: v for k, v in to_json(replace(page, sections=())).items() if k != "sections"})
        row = (
            page.slug, page.source, page.version, page.title, parents.get(page.slug, ""), page.url,
            page.content_hash, text, method, record,
        )  # fmt: skip
        connection.execute("INSERT OR IGNORE INTO pages VALUES (?,?,?,?,?,?,?,?,?,?)", row)
        connection.executemany(
            "INSERT INTO sections (slug, position, anchor, title, level, text) VALUES (?,?,?,?,?,?)",
            (
                (page.slug, position, section.anchor, section.title, section.level, section.text)
                for position, section in enumerate(page.sections)
            ),
        )
        _insert(connection, "names", page_names(page), 3)


def _write_docs(connection: sqlite3.Connection, docs: Sequence[Doc]) -> None:
    for number, doc in enumerate(docs, start=1):
        columns = [index_text(texts) for texts in (doc.name, doc.heading, doc.context, doc.body, doc.related)]
        length = sum(column.count(" ") + 1 for column in columns if column)
        connection.execute(
            "INSERT INTO docs VALUES (?,?,?,?,?,?,?)",
            (number, doc.ref, doc.kind, doc.title, doc.anchor, doc.group, length),
        )
        connection.execute(
            "INSERT INTO docs_fts (rowid, name, title, context, body, related) VALUES (?,?,?,?,?,?)",
            (number, *columns),
        )


def write_base(path: Path, contents: Contents) -> None:
    """Writes ``contents`` to ``path``: into a temporary file beside it, then renamed over it.

    A reader sees the old base or the new one, whatever happens in between. Raises StoreError when the disk is
    full or the folder cannot be written; nothing is left behind then.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.unlink(missing_ok=True)
        _write(part, contents)
        with part.open("rb") as file:
            os.fsync(file.fileno())
        part.replace(path)
    except (OSError, sqlite3.Error) as error:
        raise StoreError(f"{path}: the knowledge base cannot be written: {error}. The old one, if any, stands.") from error
    finally:
        part.unlink(missing_ok=True)


def _write(part: Path, contents: Contents) -> None:
    database = sqlite_utils.Database(part)
    connection = database.conn
    assert connection is not None
    try:
        connection.executescript(
            f"PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; PRAGMA application_id={APPLICATION_ID};"
            f"PRAGMA user_version={SCHEMA_VERSION};{DDL}"
        )
        docs = [*page_docs(contents.pages, contents.summaries), *symbol_docs(contents.symbols)]
        with connection:
            _write_symbols(connection, contents.symbols)
            _write_pages(connection, contents.pages, contents.summaries)
            _write_docs(connection, docs)
            _insert(connection, "links", ((link.source, link.target, link.kind) for link in contents.links), 3)
            _insert(connection, "vocabulary", _vocabulary(docs), 3)
            _insert(connection, "meta", contents.meta.items(), 2)
        connection.executescript(f"{INDEXES} INSERT INTO docs_fts (docs_fts) VALUES ('optimize'); ANALYZE;")
    finally:
        database.close()
