"""The knowledge-base file: its tables, and what is promised to readers of each.

One SQLite file per Blender minor version. ``SCHEMA_VERSION`` grows with every change that an older reader
could not understand; readers refuse a newer one.
"""

from __future__ import annotations

import json
import zlib
from typing import Any

SCHEMA_VERSION = 1
APPLICATION_ID = 0x534D574B  # "SMWK", SQLite's own place for telling whose file it is

# How a key came about, in the order in which an answer prefers them.
FORM_PATH, FORM_SHORT, FORM_NAME, FORM_LABEL = range(4)

FTS_COLUMNS = ("name", "title", "context", "body", "related")

DDL = """
CREATE TABLE meta (name TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;

-- One row an identifier; ``record`` is the whole Symbol, packed (see pack).
CREATE TABLE symbols (
    id INTEGER PRIMARY KEY,
    path TEXT NOT NULL UNIQUE,
    kind TEXT NOT NULL,
    owner TEXT NOT NULL,
    name TEXT NOT NULL,
    type TEXT NOT NULL,
    target TEXT NOT NULL,
    collection TEXT NOT NULL,
    base TEXT NOT NULL,
    grp TEXT NOT NULL,
    label TEXT NOT NULL,
    record BLOB NOT NULL
);

-- Every spelling under which a symbol or a page is found (analysis.key); form is one of FORM_*.
CREATE TABLE names (
    key TEXT NOT NULL, form INTEGER NOT NULL, id TEXT NOT NULL, PRIMARY KEY (key, form, id)
) WITHOUT ROWID;

-- Enum items by key; ``owner`` is the property, or ``operator(parameter)``.
CREATE TABLE enum_items (
    key TEXT NOT NULL, owner TEXT NOT NULL, identifier TEXT NOT NULL, name TEXT NOT NULL,
    PRIMARY KEY (key, owner, identifier)
) WITHOUT ROWID;

-- One row a page; ``record`` is the Page without its sections' texts.
CREATE TABLE pages (
    slug TEXT PRIMARY KEY, source TEXT NOT NULL, version TEXT NOT NULL, title TEXT NOT NULL,
    parent TEXT NOT NULL, url TEXT NOT NULL, content_hash TEXT NOT NULL,
    summary TEXT NOT NULL, summary_method TEXT NOT NULL, record BLOB NOT NULL
) WITHOUT ROWID;

CREATE TABLE sections (
    id INTEGER PRIMARY KEY, slug TEXT NOT NULL, position INTEGER NOT NULL, anchor TEXT NOT NULL,
    title TEXT NOT NULL, level INTEGER NOT NULL, text TEXT NOT NULL
);

-- source and target are ids; a manual link's target may carry an anchor.
CREATE TABLE links (source TEXT NOT NULL, target TEXT NOT NULL, kind TEXT NOT NULL);

-- The units of retrieval: sections and symbols. ``ref`` is the id they count for.
CREATE TABLE docs (
    id INTEGER PRIMARY KEY, ref TEXT NOT NULL, kind TEXT NOT NULL, title TEXT NOT NULL,
    anchor TEXT NOT NULL, grp TEXT NOT NULL, length INTEGER NOT NULL
);

CREATE VIRTUAL TABLE docs_fts USING fts5 (
    name, title, context, body, related,
    content='', detail='column', columnsize=1, tokenize='ascii'
);

-- Words of the corpus with the number of units that hold them, most used spelling first.
CREATE TABLE vocabulary (stem TEXT PRIMARY KEY, df INTEGER NOT NULL, word TEXT NOT NULL) WITHOUT ROWID;

-- Named arrays (NumPy .npy bytes): the corpus' latent space.
CREATE TABLE arrays (name TEXT PRIMARY KEY, data BLOB NOT NULL) WITHOUT ROWID;
"""

INDEXES = """
CREATE INDEX symbols_owner ON symbols (owner, name);
CREATE INDEX symbols_name ON symbols (name);
CREATE INDEX symbols_base ON symbols (base) WHERE base != '';
CREATE INDEX sections_slug ON sections (slug, position);
CREATE INDEX links_source ON links (source, kind);
CREATE INDEX links_target ON links (target, kind);
"""


def pack(record: dict[str, Any]) -> bytes:
    """A record (records.to_json) as deflated JSON: a third of its size, and 20 µs to read back."""
    return zlib.compress(json.dumps(record, ensure_ascii=False, separators=(",", ":")).encode(), 6)


def unpack(data: bytes) -> dict[str, Any]:
    """The inverse of :func:`pack`."""
    return json.loads(zlib.decompress(data))
