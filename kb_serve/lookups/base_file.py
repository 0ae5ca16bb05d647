"""The file of one knowledge base, opened read-only, and the queries that are run on it."""

from __future__ import annotations

import sqlite3
import zlib
from contextlib import ExitStack, contextmanager
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

from kb_build.schema import NoBase, open_read_only, unpack
from kb_serve.errors import BadQuery, BaseMissing, BaseUnreadable
from simworlds.how_to_get_bases import how_to_get_again, how_to_get_at

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Generator
    from pathlib import Path

_Record = TypeVar("_Record")

UNLIMITED = float("inf")


def open_file(path: Path) -> sqlite3.Connection:
    """Opens a base read-only and checks its format. Raises BaseMissing or BaseUnreadable."""
    try:
        return open_read_only(path, threads=True)
    except FileNotFoundError:
        raise BaseMissing(f"{path}: there is no knowledge base here. {how_to_get_at(path)}") from None
    except NoBase as error:
        raise BaseUnreadable(f"{path}: {error}. {how_to_get_again(path)}") from error


class BaseFile:
    """One base's file. It never changes while it is open, so that what is found may be kept."""

    def __init__(self, path: Path) -> None:
        """Opens it. Raises BaseMissing or BaseUnreadable."""
        self.path = path
        self._connection = open_file(path)
        self._opened = ExitStack()
        self.close_with(self._connection.close)
        self._work_left = UNLIMITED

    def close(self) -> None:
        """Closes the file, and what was opened beside it."""
        self._opened.close()

    def close_with(self, close: Callable[[], object]) -> None:
        """Closes something else when the file is closed."""
        self._opened.callback(close)

    def rows(self, sql: str, *values: object) -> list[Any]:
        """Runs one SQL query. Raises BaseUnreadable for a damaged file, and BadQuery (see ``bounded``)."""
        try:
            rows = self._connection.execute(sql, values).fetchall()
        except UnicodeEncodeError:
            return []  # a lone surrogate is in no base
        except sqlite3.DatabaseError as error:
            raise self.damaged(error) from error
        self._work_left -= 1 + len(rows)
        if self._work_left < 0:
            raise BadQuery(
                "This query takes too much work. Ask one thing at a time: a name, an expression or a message."
            )
        return rows

    @contextmanager
    def bounded(self, most: float) -> Generator[None]:
        """Lets look-ups raise BadQuery once there were ``most`` of them and of the rows that they found, together.

        Within another bound it counts for itself.
        """
        before, self._work_left = self._work_left, most
        try:
            yield
        finally:
            self._work_left = before

    def rows_of(self, sql: str, keys: Collection[object], order: str = "") -> list[Any]:
        """The rows with any of the keys, by the columns ``order`` if given; ``sql`` ends with the keys' column."""
        if not keys:
            return []
        ordered = f" ORDER BY {order}" if order else ""
        # Filled up to a power of two: a statement of another length is prepared anew, which costs as much as it finds.
        values = [*keys]
        values += values[-1:] * ((1 << (len(values) - 1).bit_length()) - len(values))
        return self.rows(f"{sql} IN ({','.join('?' * len(values))}){ordered}", *values)

    def damaged(self, why: object) -> BaseUnreadable:
        """The error to raise for a file with wrong content."""
        return BaseUnreadable(f"{self.path}: damaged ({why}). {how_to_get_again(self.path)}")

    def record(self, make: Callable[[dict[str, Any]], _Record], data: bytes) -> _Record:
        """A packed record (see pack) as what ``make`` makes of it. Raises BaseUnreadable."""
        try:
            return make(unpack(data))
        except (zlib.error, ValueError, TypeError, KeyError, AttributeError) as error:
            raise self.damaged(error) from error

    @cached_property
    def meta(self) -> dict[str, str]:
        """Facts about the base: version, build, fingerprint, sources, missing sources, …"""
        return dict(self.rows("SELECT name, value FROM meta"))
