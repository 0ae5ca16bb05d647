"""The journal of a run: every event, written down and flushed to the disk before anything comes of it.

A run is resumed by running its code from the start: what the journal has answered is taken from there, so that no
effect happens twice. Rows are therefore found by what they are about (``KEYS``), not by their place, and a row that is
there already is not written again.
"""

from __future__ import annotations

import json
import os
import threading
from contextlib import suppress
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, TypeGuard, TypeVar

from pydantic import ValidationError

from agents.loop.errors import NoRun, RunError
from agents.loop.record.events import Event, read_event, types_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from io import RawIOBase
    from pathlib import Path

Row = dict[str, Any]
AnyEvent = TypeVar("AnyEvent", bound=Event)
T = TypeVar("T")

KEYS = ("role", "stage", "attempt", "round", "n")
NAME = "journal.jsonl"
PLAN_NAME = "plan.json"


class Journal:
    """The rows of a run, oldest first. Safe to use from several threads.

    A last line that was torn when its writer was killed is cut off. Raises NoRun for a file that is not a journal.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.rows: list[Row] = []
        self._by_key: dict[tuple[Any, ...], Row] = {}
        self._listeners: list[Callable[[Event], object]] = []
        self._lock = threading.RLock()
        whole = 0
        for row, end in _read(path):
            if (row["type"], row.get("outcome")) == ("run.ended", "failed"):
                self._forget_failure()
            self._remember(row)
            whole = end
        self._forget_failure()
        try:
            self._file = path.open("ab", buffering=0)  # what was not written must not be tried again later
            self._file.truncate(whole)
        except OSError as error:
            raise NoRun(f"{path} cannot be written: {error.strerror or error}.") from error

    def close(self) -> None:
        """Nothing can be written afterwards."""
        self._file.close()

    def listen(self, listener: Callable[[Event], object]) -> None:
        """``listener`` gets every event from now on, once it is on the disk."""
        self._listeners.append(listener)

    def find(self, like: AnyEvent) -> AnyEvent | None:
        """The event of the type of ``like`` about the same, if there is one. Raises NoRun where its row is broken."""
        with self._lock:
            row = self._by_key.get(_key(like.as_row()))
        return None if row is None else self._event(type(like), row)

    def newest(self, *kinds: type[AnyEvent], value: Callable[[AnyEvent], T | None]) -> T | None:
        """The newest ``value`` of these kinds of events that is not None; None where no event has one.

        Raises NoRun where a row is broken.
        """
        of_type = {name: kind for kind in kinds for name in types_of(kind)}
        with self._lock:
            rows = [row for row in self.rows if row["type"] in of_type]
        values = (value(self._event(of_type[row["type"]], row)) for row in reversed(rows))
        return next((found for found in values if found is not None), None)

    def _event(self, kind: type[AnyEvent], row: Row) -> AnyEvent:
        try:
            return kind.model_validate(row)
        except ValidationError as error:
            raise NoRun(f"{self.path}, row {row.get('i')}: not a valid {row['type']!r} row.") from error

    def note(self, event: Event) -> None:
        """Writes an event, unless there is one of its type about the same."""
        with self._lock:
            if _key(event.as_row()) not in self._by_key:
                self.append(event)

    def append(self, event: Event) -> None:
        """Writes an event in any case. It is on the disk when this returns. Raises RunError."""
        self.append_row(event.as_row())

    def append_row(self, row: Mapping[str, Any]) -> None:
        """As ``append``, for an event in the form that it has on the disk. Raises RunError."""
        with self._lock:
            stamp = datetime.now(UTC).isoformat(timespec="milliseconds")
            line = json.dumps(
                {"i": len(self.rows) + 1, "t": stamp, **row}, ensure_ascii=False, allow_nan=False
            )
            data = line.encode(errors="replace")
            start = os.fstat(self._file.fileno()).st_size
            try:
                _write(self._file, data + b"\n")
                os.fsync(self._file.fileno())
            except OSError as error:
                with suppress(OSError):
                    self._file.truncate(start)
                raise RunError(
                    f"{self.path} cannot be written: {error.strerror or error}. Make room, then resume the run."
                ) from error
            written = json.loads(data)
            self._remember(written)
        for listener in self._listeners:
            listener(read_event(written))

    def _forget_failure(self) -> None:
        """Forgets the last call if it is the loop's own and failed, so that it is made again: its end was the run's."""
        last = self.rows[-1] if self.rows else {}
        if last.get("type") == "tool.answered" and last.get("role") == "runner" and last.get("failed"):
            for kind in ("tool.called", "tool.answered"):
                self._by_key.pop(_key({**last, "type": kind}), None)

    def _remember(self, row: Row) -> None:
        self.rows.append(row)
        self._by_key[_key(row)] = row


def read_rows(path: Path) -> list[Row]:
    """The rows of a journal that another process may be writing. Raises NoRun."""
    return [row for row, _ in _read(path)]


def _write(file: RawIOBase, data: bytes) -> None:
    while data:
        data = data[file.write(data) or 0 :]


def _key(row: Row) -> tuple[Any, ...]:
    return (row["type"], *(row.get(key) for key in KEYS))


def _is_row(value: Any) -> TypeGuard[Row]:
    if not isinstance(value, dict) or not isinstance(value.get("type"), str):
        return False
    return not any(isinstance(value.get(key), (dict, list)) for key in KEYS)


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
            raise NoRun(f"{path}, line {number}: not a row of a journal: {line[:80]!r}")
