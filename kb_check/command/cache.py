"""Results of checks that were made before, by all that they depend on: the files, the base, and this code."""

from __future__ import annotations

import hashlib
import json
import sqlite3
import sys
import time
import zlib
from contextlib import suppress
from dataclasses import astuple
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kb_check.findings import Edit, Finding, Fix, Span

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from typing import Self

_PARTS = ("kb_check", "kb_build", "kb_serve", "simworlds")
_MOST_BYTES = 32 << 20
_WAIT_SECONDS = 2.0
_CREATE = "CREATE TABLE IF NOT EXISTS results (key BLOB PRIMARY KEY, used REAL, value BLOB) WITHOUT ROWID"


class ResultCache:
    """Findings by key, in one file that several processes may use at once; the oldest make room for new ones.

    It only saves time: where the file cannot be used, nothing is found in it.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._connection: sqlite3.Connection | None = None
        self._used: set[bytes] = set()
        with suppress(OSError, sqlite3.Error):
            path.parent.mkdir(parents=True, exist_ok=True)
            self._open()

    def get(self, key: bytes) -> list[list[Finding]] | None:
        """What was put for a key: the findings of each file."""
        rows = self._execute("SELECT value FROM results WHERE key = ?", (key,))
        try:
            files = [[_from_json(row) for row in file] for file in json.loads(zlib.decompress(rows[0][0]))]
        except (LookupError, TypeError, ValueError, zlib.error):
            return None
        self._used.add(key)
        return files

    def put(self, key: bytes, files: Iterable[Sequence[Finding]]) -> None:
        """Keeps the findings of each file of a group."""
        plain = [[astuple(finding) for finding in findings] for findings in files]
        value = zlib.compress(json.dumps(plain, separators=(",", ":")).encode(), 1)
        self._execute("INSERT OR REPLACE INTO results VALUES (?, ?, ?)", (key, time.time(), value))

    def close(self) -> None:
        """Notes what was used, drops the oldest results beyond the bound, and closes the file."""
        if self._connection is None:
            return
        now = time.time()
        with suppress(sqlite3.Error):
            self._connection.execute("BEGIN IMMEDIATE")  # one change of the file, not one for each row
            self._connection.executemany(
                "UPDATE results SET used = ? WHERE key = ?", [(now, key) for key in self._used]
            )
            self._connection.execute(
                "DELETE FROM results WHERE key IN (SELECT key FROM (SELECT key, SUM(LENGTH(value) + 100) OVER "
                "(ORDER BY used DESC, key) AS size FROM results) WHERE size > ?)",
                (_MOST_BYTES,),
            )
            self._connection.execute("COMMIT")
        self._connection.close()
        self._connection = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _open(self) -> None:
        try:
            self._connect()
        except sqlite3.DatabaseError as error:
            if isinstance(error, sqlite3.OperationalError):  # in use, or not to be written to
                raise
            self._path.unlink(missing_ok=True)  # not a database, or a broken one
            self._connect()

    def _connect(self) -> None:
        # Each result is written at once: it holds up no other process, and outlives this one.
        connection = sqlite3.connect(self._path, timeout=_WAIT_SECONDS, isolation_level=None)
        try:
            connection.execute("PRAGMA synchronous = OFF")
            connection.execute(_CREATE)
        except sqlite3.Error:
            connection.close()
            raise
        self._connection = connection

    def _execute(self, statement: str, values: tuple[Any, ...]) -> list[Any]:
        if self._connection is None:
            return []
        try:
            return self._connection.execute(statement, values).fetchall()
        except sqlite3.Error:
            return []


def result_key(base: str, files: Iterable[tuple[str, bytes, bool]]) -> bytes:
    """The key of a group's results: the base's fingerprint, and each file's name, content, and whether it is wanted."""
    digest = hashlib.sha256(f"{code_digest()}\0{base}".encode())
    for name, data, wanted in files:
        digest.update(f"\0{name}\0{len(data)}\0{wanted}\0".encode(errors="surrogatepass"))
        digest.update(data)
    return digest.digest()


@cache
def code_digest() -> str:
    """A digest of the code that findings come from, and of the Python that parses: what is syntax depends on it."""
    top = Path(__file__).resolve().parents[2]
    digest = hashlib.sha256(sys.version.encode())
    for part in _PARTS:
        for path in sorted((top / part).rglob("*.py")):
            digest.update(f"{path.relative_to(top)}\0".encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _from_json(row: Any) -> Finding:
    """A finding from its fields in their order, as ``astuple`` gives them."""
    rule, severity, span, message, symbol, instead, fix, absent = row
    if fix is not None:
        title, edits, sure = fix
        fix = Fix(title, tuple(Edit(Span(*numbers), text) for numbers, text in edits), sure)
    return Finding(rule, severity, Span(*span), message, symbol, tuple(instead), fix, tuple(absent))
