"""What must be before an operator runs, and does what is wanted: calls, an area, an active object, settings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.flag_names import CALLS
from kb_build.symbols.flags import fillers, operator_areas, operator_given, refused_nothing
from kb_build.symbols.lines import area_text, operator_needs
from kb_serve.answer.facts.conditions import condition_lines

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader


def calls_before(reader: BaseReader, cls: str, call: str) -> list[str]:
    """The calls after which an operator makes an instance of a class, as a scene gets a world for its rigid bodies."""
    for pointer in reader.pointing_at(cls.rpartition(".")[2]):
        symbol = reader.symbol(pointer.path)
        calls = fillers(symbol) if symbol else []
        if call in calls:
            return calls[: calls.index(call)]
    return []


def calls_needed(operator: Symbol) -> tuple[str, ...]:
    """The calls that must have been made before an operator runs."""
    return operator.needs.calls if operator.needs else ()


def calls_in_areas(operator: Symbol, reader: BaseReader) -> Iterator[tuple[str, str]]:
    """(operator, what area it takes) of what the script of an operator calls that can itself begin without one."""
    for path in operator.flagged(CALLS) if not operator_areas(operator) else ():
        called = reader.symbol(path)
        if called and operator_areas(called) and not operator_given(called):
            yield path, area_text(operator_areas(called))


def never_ran(operator: Symbol) -> bool:
    """Whether an operator's poll said no wherever it was tried, without a window."""
    return not (operator_needs(operator) or refused_nothing(operator))


def needs_nothing(operator: Symbol) -> bool:
    """Whether an operator's poll said yes wherever it was tried."""
    return refused_nothing(operator) and not operator_needs(operator)


def needs_text(operator: Symbol, reader: BaseReader) -> str:
    """All that an operator needs, in words; empty for nothing."""
    return "; ".join(_needs(operator, reader))


def _needs(operator: Symbol, reader: BaseReader) -> Iterator[str]:
    if needs := operator_needs(operator):
        yield f"takes {needs}"
    elif never_ran(operator):
        yield "not seen to run without a window"
    for path, area in calls_in_areas(operator, reader):
        yield f"calls `{path}`, which takes {area}"
    yield from condition_lines(operator, reader)
