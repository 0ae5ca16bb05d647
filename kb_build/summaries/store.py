"""The file of paid summaries and of batches under way.

A SQLite file outside any knowledge base. Everything is written in whole transactions of SQLite's rollback
journal: a process killed at any moment leaves the file as it was before or after, and the one file is all
that a colleague needs to be given.
"""

from __future__ import annotations

import contextlib
import sqlite3
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.errors import SummaryError
from kb_build.summaries.types import FailureReason, Origin, PageSummary, Progress, silent

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable, Mapping
    from pathlib import Path

SCHEMA_VERSION = 2
MAX_TEXT = 600
_BUSY_SECONDS = 30.0
_LOCK_SLICE_SECONDS = 0.5
_VARIABLES = 500
_COLUMNS = "key, text, method, model, prompt_version, phrases"

_SCHEMA = """
CREATE TABLE IF NOT EXISTS summaries (
    key TEXT PRIMARY KEY, text TEXT NOT NULL, method TEXT NOT NULL, model TEXT NOT NULL,
    prompt_version TEXT NOT NULL, phrases TEXT NOT NULL DEFAULT ''
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS failures (
    id INTEGER PRIMARY KEY, key TEXT NOT NULL, reason TEXT NOT NULL, detail TEXT NOT NULL,
    made TEXT NOT NULL DEFAULT CURRENT_TIMESTAMP
);
CREATE INDEX IF NOT EXISTS failures_by_key ON failures (key);
CREATE TABLE IF NOT EXISTS batches (
    nonce TEXT PRIMARY KEY, batch_id TEXT, base_url TEXT NOT NULL, model TEXT NOT NULL,
    prompt_version TEXT NOT NULL, sent REAL NOT NULL
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS batch_items (
    nonce TEXT NOT NULL REFERENCES batches ON DELETE CASCADE, custom_id TEXT NOT NULL, key TEXT NOT NULL,
    PRIMARY KEY (nonce, custom_id)
) WITHOUT ROWID;
"""


@dataclass(frozen=True, slots=True)
class SentBatch:
    """A batch whose results have not been kept yet.

    ``batch_id`` is None while it is not known whether the API received it. ``items`` maps each request's
    custom_id to the key of the summary that it is to give; every custom_id starts with ``nonce``. ``sent`` is
    in seconds since 1970.
    """

    nonce: str
    batch_id: str | None
    base_url: str
    model: str
    prompt_version: str
    sent: float
    items: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class BadAnswer:
    """An answer that is not a valid summary: why, and a sentence about it."""

    key: str
    reason: FailureReason
    detail: str


class SummaryStore:
    """Summaries by key in the SQLite file ``path``, which is created on the first use.

    Every method may raise SummaryError: the file cannot be read or written, is damaged, is no summary store
    or was made by a newer version.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def get(self, keys: Iterable[str]) -> dict[str, PageSummary]:
        """Those of ``keys`` that are there, with their summaries."""
        summaries: dict[str, PageSummary] = {}
        wanted = list(dict.fromkeys(keys))
        with self._connection() as db:
            for start in range(0, len(wanted), _VARIABLES):
                part = wanted[start : start + _VARIABLES]
                marks = ",".join("?" * len(part))
                query = f"SELECT {_COLUMNS} FROM summaries WHERE key IN ({marks})"  # noqa: S608 - marks only
                summaries.update((row[0], _summary(row)) for row in db.execute(query, part))
        return summaries

    def add(self, summaries: Iterable[PageSummary]) -> int:
        """Keep ``summaries``; what is there already stays as it is. Returns how many were new."""
        with self._connection() as db, _transaction(db):
            return _insert(db, summaries)

    def merge(self, other: Path) -> int:
        """Take over the summaries of a colleague's file; returns how many were new.

        Only whole summaries are taken (never batches or failures), and nothing that this store would not have
        accepted itself. ``other`` is opened read-only.
        """
        if not other.is_file():
            raise SummaryError(f"No summary store at {other}. Give the path of a colleague's summaries file.")
        theirs = SummaryStore(other)
        try:
            with theirs._connection(read_only=True) as db:
                version = _version(db)
                columns = _COLUMNS if version >= SCHEMA_VERSION else _COLUMNS.replace("phrases", "''")
                rows = db.execute(f"SELECT {columns} FROM summaries").fetchall()  # noqa: S608 - our own names
        except SummaryError as error:
            if not isinstance(error.__cause__, sqlite3.Error):
                raise
            raise SummaryError(
                f"{other} cannot be read as a colleague's summaries: {error.__cause__}. Give the file "
                "summaries.sqlite of their SimWorlds folder."
            ) from error
        return self.add(_summary(row) for row in rows if _acceptable(row))

    def count(self) -> int:
        """How many summaries there are."""
        with self._connection() as db:
            return int(db.execute("SELECT count(*) FROM summaries").fetchone()[0])

    def failures(self, keys: Iterable[str]) -> dict[str, list[BadAnswer]]:
        """The refused and malformed answers so far to each of ``keys``, oldest first; no entry for none."""
        wanted = set(keys)
        answers: dict[str, list[BadAnswer]] = {}
        with self._connection() as db:
            for row in db.execute("SELECT key, reason, detail FROM failures ORDER BY id"):
                if row[0] in wanted:
                    answers.setdefault(row[0], []).append(BadAnswer(*row))
        return answers

    def announce(self, batch: SentBatch) -> None:
        """Write down a batch before it is sent: what is known if the process dies while sending."""
        with self._connection() as db, _transaction(db):
            db.execute(
                "INSERT INTO batches VALUES (?, ?, ?, ?, ?, ?)",
                (batch.nonce, batch.batch_id, batch.base_url, batch.model, batch.prompt_version, batch.sent),
            )
            rows = ((batch.nonce, custom_id, key) for custom_id, key in batch.items.items())
            db.executemany("INSERT INTO batch_items VALUES (?, ?, ?)", rows)

    def identify(self, nonce: str, batch_id: str) -> None:
        """Write down the id that the API gave to an announced batch."""
        with self._connection() as db:
            db.execute("UPDATE batches SET batch_id = ? WHERE nonce = ?", (batch_id, nonce))

    def under_way(self, base_url: str) -> list[SentBatch]:
        """The batches sent to that API whose results have not been kept, oldest first."""
        with self._connection() as db:
            rows = db.execute(
                "SELECT * FROM batches WHERE base_url = ? ORDER BY sent", (base_url,)
            ).fetchall()
            query = "SELECT custom_id, key FROM batch_items WHERE nonce = ?"
            return [SentBatch(*row, items=dict(db.execute(query, row[:1]))) for row in rows]

    def settle(self, nonce: str, summaries: Iterable[PageSummary], failures: Iterable[BadAnswer]) -> None:
        """Keep what came of a batch and forget the batch, all at once."""
        with self._connection() as db, _transaction(db):
            _insert(db, summaries)
            db.executemany(
                "INSERT INTO failures (key, reason, detail) VALUES (?, ?, ?)",
                [(bad.key, bad.reason, bad.detail) for bad in failures],
            )
            db.execute("DELETE FROM batch_items WHERE nonce = ?", (nonce,))
            db.execute("DELETE FROM batches WHERE nonce = ?", (nonce,))

    @contextlib.contextmanager
    def exclusive(self, progress: Progress = silent) -> Generator[None]:
        """While inside, no other process or thread is: two builds never send the same pages.

        The lock is SQLite's own, on a second file beside the store: it ends with the process that holds it,
        however that ends. Waits as long as another holds it, and says so once.
        """
        lock = self.path.with_name(self.path.name + ".lock")
        with self._errors():
            db = self._open(lock, timeout=_LOCK_SLICE_SECONDS)
        with contextlib.closing(db):
            waiting = False
            while not self._locked(db):
                if not waiting:
                    progress(0, 0, f"another build is making summaries (it holds {lock}); waiting for it")
                waiting = True
            yield

    def _locked(self, db: sqlite3.Connection) -> bool:
        with self._errors():
            try:
                db.execute("BEGIN EXCLUSIVE")
            except sqlite3.OperationalError as error:
                if error.sqlite_errorcode & 0xFF == sqlite3.SQLITE_BUSY:
                    return False
                raise
        return True

    @contextlib.contextmanager
    def _connection(self, *, read_only: bool = False) -> Generator[sqlite3.Connection]:
        with self._errors(), contextlib.closing(self._open(self.path, read_only=read_only)) as db:
            version = _version(db)
            if version > SCHEMA_VERSION:
                raise SummaryError(
                    f"The summary store {self.path} was made by a newer SimWorlds (schema {version}; this "
                    f"one knows {SCHEMA_VERSION}). Update SimWorlds, or use another file."
                )
            if version < SCHEMA_VERSION and not read_only:
                self._create(db)
            yield db

    def _create(self, db: sqlite3.Connection) -> None:
        with _transaction(db):
            if _version(db) == SCHEMA_VERSION:  # another thread was first
                return
            foreign = db.execute("SELECT name FROM sqlite_schema WHERE type = 'table'").fetchall()
            if foreign and ("summaries",) not in foreign:
                raise SummaryError(
                    f"{self.path} is a database, but not a summary store. Give another path for the summaries."
                )
            if ("summaries",) in foreign:  # of the first version
                db.execute("ALTER TABLE summaries ADD COLUMN phrases TEXT NOT NULL DEFAULT ''")
            for statement in _SCHEMA.split(";"):
                db.execute(statement)
            db.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")

    def _open(
        self, path: Path, *, timeout: float = _BUSY_SECONDS, read_only: bool = False
    ) -> sqlite3.Connection:
        if not read_only:
            path.parent.mkdir(parents=True, exist_ok=True)
        uri = f"{path.resolve().as_uri()}?mode={'ro' if read_only else 'rwc'}"
        return sqlite3.connect(uri, uri=True, timeout=timeout, isolation_level=None)

    @contextlib.contextmanager
    def _errors(self) -> Generator[None]:
        try:
            yield
        except (sqlite3.Error, OSError) as error:
            raise SummaryError(
                f"The summary store {self.path} cannot be used: {error}. Check the disk and the permissions; "
                "if the file is damaged, move it away and it is made anew (Claude's summaries are then paid "
                "for again, unless a colleague's copy is merged)."
            ) from error


def _version(db: sqlite3.Connection) -> int:
    return int(db.execute("PRAGMA user_version").fetchone()[0])


@contextlib.contextmanager
def _transaction(db: sqlite3.Connection) -> Generator[None]:
    db.execute("BEGIN IMMEDIATE")
    try:
        yield
    except BaseException:
        if db.in_transaction:  # a full disk makes SQLite roll back by itself
            db.execute("ROLLBACK")
        raise
    db.execute("COMMIT")


def _insert(db: sqlite3.Connection, summaries: Iterable[PageSummary]) -> int:
    before = db.total_changes
    rows = (
        (
            summary.key,
            summary.text,
            summary.method,
            summary.model,
            summary.prompt_version,
            ";".join(summary.phrases),
        )
        for summary in summaries
    )
    db.executemany(f"INSERT OR IGNORE INTO summaries ({_COLUMNS}) VALUES (?, ?, ?, ?, ?, ?)", rows)  # noqa: S608 - our own names
    return db.total_changes - before


def _summary(row: tuple[str, str, Origin, str, str, str]) -> PageSummary:
    key, text, method, model, prompt_version, phrases = row
    return PageSummary(key, text, method, model, prompt_version, tuple(filter(None, phrases.split(";"))))


def _acceptable(row: tuple[object, ...]) -> bool:
    """Whether a stranger's row is a summary: nothing else of it can be checked without the page."""
    key, text, method, model, prompt_version, phrases = row
    return (
        isinstance(key, str)
        and len(key) == 64
        and isinstance(text, str)
        and 0 < len(text) <= MAX_TEXT
        and text.isprintable()
        and method == "claude"
        and isinstance(model, str)
        and isinstance(prompt_version, str)
        and isinstance(phrases, str)
        and phrases.isprintable()
    )
