"""Rows that were read are kept, within bounds, and those that a query needs are read together."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.lookups.kept_rows import KeptRows

if TYPE_CHECKING:
    from collections.abc import Sequence


class Table:
    """Numbers by name, and what was asked for."""

    def __init__(self) -> None:
        self.asked: list[list[str]] = []

    def read(self, keys: Sequence[str]) -> dict[str, int | None]:
        self.asked.append([*keys])
        return {key: int(key) for key in keys if key.isdigit()}


def test_reads_what_is_wanted_at_once_and_only_once() -> None:
    table = Table()
    rows = KeptRows(table.read, None, 10)
    rows.load(["1", "2", "no", "1"])
    rows.load(["2", "3"])
    assert [rows("1"), rows("no"), rows("3"), rows("4")] == [1, None, 3, 4]
    assert table.asked == [["1", "2", "no"], ["3"], ["4"]]


def test_forgets_what_was_read_first() -> None:
    table = Table()
    rows = KeptRows(table.read, None, 3)
    rows.load(["1", "2"])
    rows.load(["3", "4"])
    assert [rows("4"), rows("3"), rows("2")] == [4, 3, 2]
    assert table.asked == [["1", "2"], ["3", "4"]]
    assert rows("1") == 1
    assert table.asked[2:] == [["1"]]


def test_more_than_it_keeps_is_there_when_it_was_asked_for() -> None:
    table = Table()
    rows = KeptRows(table.read, None, 2)
    rows.load(map(str, range(9)))
    assert [rows(str(number)) for number in range(9)] == [*range(9)]
    assert len(table.asked) == 1


def test_what_could_not_be_read_is_asked_for_again() -> None:
    def broken(_keys: Sequence[str]) -> dict[str, int]:
        raise LookupError("the file is damaged")

    rows = KeptRows(broken, 0, 2)
    for _ in range(2):
        with pytest.raises(LookupError, match="damaged"):
            rows("1")
