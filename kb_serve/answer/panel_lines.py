"""What Blender's own panels ask before they let a setting be changed: settings that do nothing unless another is on."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

from kb_build.schema import TEST_OFF, TEST_ON
from kb_build.symbol_lines import usual_default
from kb_serve.reader import TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_build.records import PanelCondition, Symbol
    from kb_serve.reader import BaseReader

_MOST_SWITCHED = 8


def panel_lines(symbol: Symbol, reader: BaseReader) -> Iterator[str]:
    """When panels let a property be set, and what they let be set once it is on."""
    if symbol.kind != "property":
        return
    clauses = [list(rows) for _, rows in groupby(reader.panel_tests(symbol.path), lambda row: row.clause)]
    owners = {entry.path for entry in reader.lineage(symbol.owner)}
    if greyed := [rows for rows in clauses if not rows[0].hides]:
        yield f"greyed out in Blender's panels unless {_joined(greyed, owners, reader)}"
    if hidden := [rows for rows in clauses if rows[0].hides]:
        yield f"shown in Blender's panels only if {_joined(hidden, owners, reader)}"
    if symbol.type == "boolean" and (switched := reader.panels_let_set(symbol.path, TEST_ON)):
        names = [f"`{name}`" for name in _names(switched, symbol.owner, reader)]
        more = f" and {len(names) - _MOST_SWITCHED} more" if len(names) > _MOST_SWITCHED else ""
        yield f"while it is off, Blender's panels grey out or hide {', '.join(names[:_MOST_SWITCHED])}{more}"


def _joined(clauses: Sequence[Sequence[PanelCondition]], owners: set[str], reader: BaseReader) -> str:
    """Clauses as one condition."""
    told: list[str] = []
    for rows in clauses:
        either = " or ".join(_told(row, owners, reader, alone=len(rows) == 1) for row in rows)
        told.append(f"({either})" if len(rows) > 1 and len(clauses) > 1 else either)
    return " and ".join(told)


def _told(row: PanelCondition, owners: set[str], reader: BaseReader, *, alone: bool) -> str:
    owner, _, name = row.gate.rpartition(".")
    gate = name if owner in owners else f"{owner.rpartition('.')[2]}.{name}"
    is_word = row.test[0].isalpha() or row.test[0] == "'"
    text = f"`{gate}` is {row.test}" if is_word else f"`{gate} {row.test}`"
    return text + (_when_new(row, reader) if alone else "")


def _when_new(row: PanelCondition, reader: BaseReader) -> str:
    """That a new one has a switch in the other position."""
    gate = reader.symbol(row.gate) if row.test in {TEST_ON, TEST_OFF} else None
    value = usual_default(gate) if gate else None
    if not isinstance(value, bool) or value == (row.test == TEST_ON):
        return ""
    return " (a new one has it on)" if value else " (a new one has it off)"


def _names(paths: Sequence[str], cls: str, reader: BaseReader) -> list[str]:
    """The names of properties, once where several kinds of a class have one; those of other classes come last."""
    own: dict[str, None] = {}
    others: list[str] = []
    for path in paths:
        owner, _, name = path.rpartition(".")
        if reader.descends(owner, cls) or reader.descends(cls, owner):
            own[name] = None
        else:
            others.append(path.removeprefix(TYPES))
    return [*own, *others]
