"""The checker that works beside an open base."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kb_check.checker import Checker
    from kb_serve.reader import BaseReader

_KEPT = 100  # look-ups: the pieces of code in queries are short


def checker_beside(reader: BaseReader) -> Checker:
    """The checker of the base that a reader reads, which is closed with it."""
    return reader.shared(_make_checker)


def _make_checker(reader: BaseReader) -> Checker:
    from kb_check.checker import Checker  # noqa: PLC0415 - loaded by the first check

    checker = Checker(reader, _KEPT)
    reader.close_with(checker.close)
    return checker
