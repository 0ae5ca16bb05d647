"""The knowledge-base file: its tables and what readers can rely on.

One SQLite file per Blender minor version. ``SCHEMA_VERSION`` grows with every change that an older reader
could not understand; readers refuse a newer one.
"""

from __future__ import annotations

import json
import sqlite3
import zlib
from enum import IntFlag, auto
from typing import TYPE_CHECKING, Any, Literal
from urllib.parse import quote

if TYPE_CHECKING:
    from pathlib import Path

SCHEMA_VERSION = 20
APPLICATION_ID = 0x534D574B  # "SMWK", SQLite's field for the application a file belongs to

# How a key came about, in the order in which an answer prefers them.
FORM_PATH, FORM_SHORT, FORM_NAME, FORM_LABEL, FORM_TOPIC = range(5)

# What is asked of a truth value.
TEST_ON, TEST_OFF = "on", "off"


class Mark(IntFlag):
    """What is known of a symbol without reading its record."""

    READ_ONLY = auto()  # it cannot be assigned
    DEPRECATED = auto()
    UNSEEN = auto()  # the default that its line tells is RNA's alone: no new instance was compared
    GIVEN = auto()  # a pointer that is None on all new things, and that an assignment alone fills


# The levels of the documents.
UNITS, TOPICS = range(2)
# What a document is to the search; index: of a page that only lists others, removing: of a function that does so.
DocumentKind = Literal["data", "code", "node", "index", "rarely asked", "removing"]
DOCUMENT_KINDS: tuple[DocumentKind, ...] = ("data", "code", "node", "index", "rarely asked", "removing")
_JSON = json.JSONEncoder(ensure_ascii=False, separators=(",", ":"))
BY_MODEL = "AI summary: "  # stands before what a language model wrote: it is not Blender's own word
POSTING_BYTES = 6  # a number as uint32, a weight as float16
_LITTLE_KEPT = "PRAGMA cache_size = -256"  # KB: the system keeps the file, from which pages are read as fast

DDL = """
CREATE TABLE meta (name TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;

-- One row an identifier; ``marks`` are of Mark, ``line`` describes it in one line, ``record`` is the whole Symbol,
-- packed (see pack), of which ``reached`` and ``lacks`` stand here as well. ``choices`` are the stems of what its
-- arguments and values are called, where its line does not tell them all.
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
    marks INTEGER NOT NULL,
    line TEXT NOT NULL,
    reached TEXT NOT NULL,
    lacks TEXT NOT NULL,
    choices TEXT NOT NULL,
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

-- The arguments of operators, which are given by the ids of their rows in symbols.
CREATE TABLE operator_arguments (
    argument TEXT NOT NULL, operator INTEGER NOT NULL, PRIMARY KEY (argument, operator)
) WITHOUT ROWID;

-- One row a page; ``record`` is the whole Page, packed.
CREATE TABLE pages (
    slug TEXT PRIMARY KEY, source TEXT NOT NULL, version TEXT NOT NULL, title TEXT NOT NULL,
    parent TEXT NOT NULL, position INTEGER NOT NULL, url TEXT NOT NULL, content_hash TEXT NOT NULL,
    summary TEXT NOT NULL, summary_method TEXT NOT NULL, record BLOB NOT NULL
);

CREATE TABLE sections (
    id INTEGER PRIMARY KEY, slug TEXT NOT NULL, position INTEGER NOT NULL, anchor TEXT NOT NULL,
    title TEXT NOT NULL, level INTEGER NOT NULL
);

-- source and target are ids; a manual link's target may carry an anchor.
-- ``place``: of all links, in the order in which they were found.
CREATE TABLE links (
    source TEXT NOT NULL, kind TEXT NOT NULL, place INTEGER NOT NULL, target TEXT NOT NULL,
    PRIMARY KEY (source, kind, place)
) WITHOUT ROWID;

-- The place in the manual that is about a symbol: a section's number and a line of its text, -1 for the heading; the
-- headings above it, and what it says, with the names that stand with its labels.
CREATE TABLE passages (
    path TEXT PRIMARY KEY, slug TEXT NOT NULL, section INTEGER NOT NULL, line INTEGER NOT NULL,
    headings TEXT NOT NULL, text TEXT NOT NULL
) WITHOUT ROWID;

-- What a script writes for a label in the manual, or for a choice below it, in Markdown: for a term in a line of a
-- section, -1 for the heading. Also, in brackets, that a setting has no such choice.
CREATE TABLE label_names (
    slug TEXT NOT NULL, section INTEGER NOT NULL, line INTEGER NOT NULL, names TEXT NOT NULL,
    PRIMARY KEY (slug, section, line)
) WITHOUT ROWID;

-- The call that makes an instance of a class, the function or operator that it calls, and the type that it names.
CREATE TABLE creation (
    path TEXT PRIMARY KEY, call TEXT NOT NULL, maker TEXT NOT NULL, choice TEXT NOT NULL
) WITHOUT ROWID;

-- How much a symbol counts among its like (index.weights); the others count nothing.
CREATE TABLE weights (path TEXT PRIMARY KEY, weight REAL NOT NULL) WITHOUT ROWID;

-- Symbols that this Blender does not have and another has: the first and last version of their latest time before this
-- one, and the first known not to have them any more. What only newer versions have has that time, and an empty gone.
-- ``name`` is the last part of the path: a member, parameter, item or socket.
CREATE TABLE removed (
    path TEXT PRIMARY KEY, first TEXT NOT NULL, last TEXT NOT NULL, gone TEXT NOT NULL, name TEXT NOT NULL
) WITHOUT ROWID;
-- Under which keys they are asked for.
CREATE TABLE removed_names (key TEXT NOT NULL, path TEXT NOT NULL, PRIMARY KEY (key, path)) WITHOUT ROWID;
-- What takes their place, best first (position 0), as a source says it. An empty target: nothing does, and ``how``
-- says why. Otherwise ``how`` is what else changes, or empty. ``version`` is the first to be written so.
CREATE TABLE successors (
    path TEXT NOT NULL, position INTEGER NOT NULL, target TEXT NOT NULL, how TEXT NOT NULL, version TEXT NOT NULL,
    source TEXT NOT NULL, PRIMARY KEY (path, position)
) WITHOUT ROWID;
-- For removed symbols of which no source speaks: the symbols of this version that resemble them, a guess.
CREATE TABLE similar_names (
    path TEXT NOT NULL, target TEXT NOT NULL, score REAL NOT NULL, PRIMARY KEY (path, target)
) WITHOUT ROWID;

-- Symbols that came after the oldest version known: the first that is known to have them, and the last one known to
-- lack them, empty where that is the one just before. So of those that only newer versions have, where it is not.
CREATE TABLE since (path TEXT PRIMARY KEY, version TEXT NOT NULL, lacked TEXT NOT NULL) WITHOUT ROWID;

-- What older versions have at a place of a node, ``inputs[7]``, where this one has another socket.
CREATE TABLE moved_sockets (
    path TEXT NOT NULL, version TEXT NOT NULL, name TEXT NOT NULL, PRIMARY KEY (path, version)
) WITHOUT ROWID;
-- Former names (sockets, node classes) that this Blender still takes, tried on an instance, and what they give.
CREATE TABLE still_works (path TEXT PRIMARY KEY, taken_as TEXT NOT NULL) WITHOUT ROWID;
-- How Blender's own scripts use a symbol: the clearest few uses, best first, each up to three lines of a file; how
-- often it is used (up to ten times a file), and in how many files.
CREATE TABLE uses (
    path TEXT NOT NULL, rank INTEGER NOT NULL, file TEXT NOT NULL, line INTEGER NOT NULL, code TEXT NOT NULL,
    PRIMARY KEY (path, rank)
) WITHOUT ROWID;
CREATE TABLE use_counts (path TEXT PRIMARY KEY, uses INTEGER NOT NULL, files INTEGER NOT NULL) WITHOUT ROWID;

-- What a setting (gate) must be, as text: on, 'SUN' or 'SPOT'. Panels in Blender's own scripts ask it wherever they let
-- a property be set, or offer an operator; or it was tried when the property has an effect. Of the rows of one clause
-- any is enough, all clauses must hold. otherwise: see records.Otherwise.
CREATE TABLE setting_conditions (
    path TEXT NOT NULL, clause INTEGER NOT NULL, gate TEXT NOT NULL, test TEXT NOT NULL, otherwise TEXT NOT NULL,
    PRIMARY KEY (path, clause, gate, test)
) WITHOUT ROWID;

-- What functions say that refuse a call, with … for names and for what was given (records.Refusal).
CREATE TABLE refusals (message TEXT NOT NULL, path TEXT NOT NULL, PRIMARY KEY (message, path)) WITHOUT ROWID;

-- Page → symbols whose manual link leads there: classes and operators only.
CREATE TABLE explained (slug TEXT NOT NULL, symbol TEXT NOT NULL, PRIMARY KEY (slug, symbol)) WITHOUT ROWID;

-- What is retrieved (index.documents): units (level 0) and topics (level 1), numbered from 0 within their level. By
-- number: the ids that they count for and their anchors, a line each; the numbers of their topics or -1; numbers that
-- those of one chapter of the manual share, and those that one page explains or -1 (int32); the places of their kinds
-- in DOCUMENT_KINDS (uint8); and whether they are members of something (bool). Read at once, they need no look-ups.
CREATE TABLE levels (
    level INTEGER PRIMARY KEY, count INTEGER NOT NULL, refs TEXT NOT NULL, anchors TEXT NOT NULL, topics BLOB NOT NULL,
    chapters BLOB NOT NULL, explained BLOB NOT NULL, kinds BLOB NOT NULL, members BLOB NOT NULL
);

-- For each phrase of the query expansions, and each page's title, the document that it leads to (int32). One row.
CREATE TABLE phrases (targets BLOB NOT NULL);

-- The inverted index. Units, topics and phrases are numbered through: for each stem how many units have it, the numbers
-- of all that do as uint32, and for each its weight as float16 (see kb_build.index.postings).
CREATE TABLE postings (stem TEXT NOT NULL UNIQUE, units INTEGER NOT NULL, data BLOB NOT NULL);

-- The lines of Python that do a common task: what it is, what the names in them stand for, and how many phrases ask for
-- it. The phrases of all recipes are numbered through: for each of their stems, and those of the code, how rare it is
-- among the units (idf), the phrases that have it and the recipes that do (uint16).
CREATE TABLE recipes (
    number INTEGER PRIMARY KEY, title TEXT NOT NULL, takes TEXT NOT NULL, code TEXT NOT NULL, phrases INTEGER NOT NULL
);
CREATE TABLE recipe_words (
    stem TEXT PRIMARY KEY, rarity REAL NOT NULL, phrases BLOB NOT NULL, recipes BLOB NOT NULL
) WITHOUT ROWID;

-- The corpus' words: stem and most used spelling.
CREATE TABLE vocabulary (stem TEXT PRIMARY KEY, word TEXT NOT NULL) WITHOUT ROWID;
"""

INDEXES = """
CREATE INDEX symbols_owner ON symbols (owner, name);
CREATE INDEX symbols_name ON symbols (name, kind);
CREATE INDEX symbols_target ON symbols (target) WHERE target != '';
CREATE INDEX symbols_collection ON symbols (collection) WHERE collection != '';
CREATE INDEX symbols_base ON symbols (base) WHERE base != '';
CREATE INDEX setting_conditions_gate ON setting_conditions (gate);
CREATE INDEX removed_name ON removed (name);
CREATE INDEX successors_target ON successors (target);
CREATE INDEX sections_slug ON sections (slug, position);
CREATE INDEX pages_parent ON pages (parent, position);
"""


class NoBase(Exception):  # noqa: N818 - reads as the state it names
    """A file that this SimWorlds cannot read as a base; the message says why."""


def open_read_only(path: Path, *, threads: bool = False) -> sqlite3.Connection:
    """Opens a base read-only, and unchanging as long as it is open. Raises FileNotFoundError and NoBase.

    ``threads``: whether other threads than this one will use it.
    """
    if not path.is_file():
        raise FileNotFoundError(path)
    uri = f"file:{quote(str(path.resolve()))}?mode=ro&immutable=1"
    try:
        connection = sqlite3.connect(uri, uri=True, check_same_thread=not threads)
    except sqlite3.Error as error:
        raise NoBase(f"cannot be opened ({error})") from error
    try:
        _check(connection)
        connection.execute(_LITTLE_KEPT)
    except sqlite3.Error as error:
        connection.close()
        raise NoBase(f"not readable as a knowledge base ({error})") from error
    except BaseException:
        connection.close()
        raise
    return connection


def _check(connection: sqlite3.Connection) -> None:
    application, version = (
        int(connection.execute(f"PRAGMA {name}").fetchone()[0]) for name in ("application_id", "user_version")
    )
    if application != APPLICATION_ID:
        raise NoBase("an SQLite file, but not a knowledge base")
    if version > SCHEMA_VERSION:
        raise NoBase(
            f"written by a newer SimWorlds (layout {version}, this one reads {SCHEMA_VERSION}): upgrade SimWorlds"
        )
    if version < SCHEMA_VERSION:
        raise NoBase(f"of an older layout ({version}, needed {SCHEMA_VERSION})")


def pack(record: dict[str, Any]) -> bytes:
    """A record (see ``to_json``) as deflated JSON: a third of its size, and 20 µs to read back."""
    return zlib.compress(_JSON.encode(record).encode(), 6)


def unpack(data: bytes) -> dict[str, Any]:
    """The inverse of :func:`pack`."""
    return json.loads(zlib.decompress(data))
