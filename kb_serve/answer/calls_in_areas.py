"""What an operator calls in turn that takes an area."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.flags import operator_areas, operator_given
from kb_build.symbols.lines import area_text
from kb_build.symbols.records import CALLS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader


def calls_in_areas(operator: Symbol, reader: BaseReader) -> Iterator[tuple[str, str]]:
    """(operator, what area it takes) of what the script of an operator calls that can itself begin without one."""
    for path in operator.flagged(CALLS) if not operator_areas(operator) else ():
        called = reader.symbol(path)
        if called and operator_areas(called) and not operator_given(called):
            yield path, area_text(operator_areas(called))
