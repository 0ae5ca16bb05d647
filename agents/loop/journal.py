"""The journal of a run: every event, written down and flushed to the disk before anything comes of it.

A run is taken up again by running its code from the start: what the journal has answered is taken from there, so that
no effect is made twice. Every row is therefore known by what it is about (``KEYS``), not by its place, and a row that
the journal has already is not written again.
"""

from __future__ import annotations

import json
import os
import threading
from contextlib import suppress
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, TypeGuard

from agents.loop.errors import NoRun, RunError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from io import RawIOBase
    from pathlib import Path

Row = dict[str, Any]

KEYS = ("role", "stage", "attempt", "round", "n")
NAME = "journal.jsonl"
_Key = tuple[Any, ...]


class Journal:
    """The rows of a run, oldest first. Safe to use from several threads.

    A last line that was torn when its writer was killed is cut off. Raises NoRun for a file that is no journal.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.rows: list[Row] = []
        self._known: dict[_Key, Row] = {}
        self._listeners: list[Callable[[Mapping[str, Any]], object]] = []
        self._lock = threading.RLock()
        whole = 0
        for row, end in _read(path):
            self._remember(row)
            whole = end
        try:
            self._file = path.open("ab", buffering=0)  # what was not written must not be tried again later
            self._file.truncate(whole)
        except OSError as error:
            raise NoRun(f"{path} cannot be written: {error.strerror or error}.") from error

    def close(self) -> None:
        """Nothing can be written afterwards."""
        self._file.close()

    def listen(self, listener: Callable[[Mapping[str, Any]], object]) -> None:
        """``listener`` gets every row from now on, once it is on the disk."""
        self._listeners.append(listener)

    def find(self, kind: str, /, **about: Any) -> Row | None:
        """The row of that type about that, if there is one."""
        with self._lock:
            return self._known.get(_key(kind, about))

    def last(self, field: str) -> Any:
        """The newest value of a field that is not null; None where no row has one."""
        with self._lock:
            return next((row[field] for row in reversed(self.rows) if row.get(field) is not None), None)

    def note(self, kind: str, /, **fields: Any) -> Row:
        """Writes a row, unless one of that type about the same is there: then that is returned."""
        with self._lock:
            return self.find(kind, **_about(fields)) or self.append({"type": kind, **fields})

    def append(self, row: Mapping[str, Any]) -> Row:
        """Writes a row in any case. It is on the disk when this returns. Raises RunError."""
        with self._lock:
            stamp = datetime.now(UTC).isoformat(timespec="milliseconds")
            written = {"i": len(self.rows) + 1, "t": stamp, **row}
            line = json.dumps(written, ensure_ascii=False, allow_nan=False, default=_plain)
            start = os.fstat(self._file.fileno()).st_size
            try:
                _write(self._file, line.encode(errors="replace") + b"\n")
                os.fsync(self._file.fileno())
            except OSError as error:
                self._take_back(start)
                raise RunError(
                    f"{self.path} cannot be written: {error.strerror or error}. Make room, then resume the run."
                ) from error
            self._remember(written)
        for listener in self._listeners:
            listener(written)
        return written

    def _take_back(self, start: int) -> None:
        """Half a row is none."""
        with suppress(OSError):
            self._file.truncate(start)

    def _remember(self, row: Row) -> None:
        self.rows.append(row)
        self._known[_key(row.get("type", ""), row)] = row


def read_rows(path: Path) -> list[Row]:
    """The rows of a journal that somebody else may be writing. Raises NoRun."""
    return [row for row, _ in _read(path)]


def _write(file: RawIOBase, data: bytes) -> None:
    while data:
        data = data[file.write(data) or 0 :]


def _about(fields: Mapping[str, Any]) -> dict[str, Any]:
    return {key: fields[key] for key in KEYS if key in fields}


def _key(kind: str, fields: Mapping[str, Any]) -> _Key:
    return (kind, *(fields.get(key) for key in KEYS))


def _is_row(value: Any) -> TypeGuard[Row]:
    if not isinstance(value, dict) or not isinstance(value.get("type"), str):
        return False
    return not any(isinstance(value.get(key), (dict, list)) for key in KEYS)


def _plain(value: object) -> object:
    raise TypeError(f"{value!r} is nothing for a journal")


def _read(path: Path) -> Iterator[tuple[Row, int]]:
    """(row, where it ends in the file) for every whole line."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return
    except OSError as error:
        raise NoRun(f"{path} cannot be read: {error.strerror or error}.") from error
    end = 0
    for number, line in enumerate(data.splitlines(keepends=True), 1):
        end += len(line)
        try:
            row = json.loads(line) if line.endswith(b"\n") else None
        except (ValueError, RecursionError):
            row = None
        if _is_row(row):
            yield row, end
        elif end < len(data):
            raise NoRun(f"{path}, line {number}, is no row of a journal: {line[:80]!r}")
