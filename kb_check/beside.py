"""The checker that works beside an open base."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

if TYPE_CHECKING:
    from kb_check.checker import Checker
    from kb_serve.reader import BaseReader

_KEPT = 100  # look-ups: the pieces of code in queries are short
_CHECKERS: WeakKeyDictionary[BaseReader, Checker] = WeakKeyDictionary()


def checker_beside(reader: BaseReader) -> Checker:
    """The checker of the base that a reader reads. It is closed when the reader is gone."""
    found = _CHECKERS.get(reader)
    if found is None:
        from kb_check.checker import Checker  # noqa: PLC0415 - loaded by the first check

        found = _CHECKERS[reader] = Checker(reader.path, _KEPT)
        weakref.finalize(reader, found.close)
    return found
