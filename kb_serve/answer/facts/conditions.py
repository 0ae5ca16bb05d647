"""What settings and operators depend on: what Blender's own panels ask before they let one be set or run, and what was
tried to have no effect unless another setting is on.
"""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

from kb_build.schema import TEST_OFF, TEST_ON
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flags import usual_default
from kb_build.symbols.lines import is_contrary

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_build.symbols.records import SettingCondition, Symbol
    from kb_serve.reader import BaseReader

_MOST_SWITCHED = 8
_NOT = "not "  # what such a test begins with
_ON, _OFF = "it on", "it off"


def condition_lines(symbol: Symbol, reader: BaseReader) -> Iterator[str]:
    """When panels let a property be set, or an operator be run, or when a property has an effect; and what depends on a
    property in this way.
    """
    if symbol.kind not in {"property", "operator"}:
        return
    clauses = [
        list(rows) for _, rows in groupby(reader.settings.conditions_of(symbol.path), lambda row: row.clause)
    ]
    owners = {entry.path for entry in reader.lineage(symbol.owner)}
    if idle := [rows for rows in clauses if rows[0].otherwise == "idle"]:
        yield f"has no effect unless {_joined(idle, owners, reader)}"
    if greyed := [rows for rows in clauses if rows[0].otherwise == "greyed"]:
        if all(map(_is_denied, greyed[0])) and len(greyed) == 1:
            yield f"greyed out in Blender's panels when {_denied(greyed[0], owners, reader)}"
        else:
            yield f"greyed out in Blender's panels unless {_joined(greyed, owners, reader)}"
    if hidden := [rows for rows in clauses if rows[0].otherwise == "hidden"]:
        offers = "offered by" if symbol.kind == "operator" else "shown in"
        yield f"{offers} Blender's panels only if {_joined(hidden, owners, reader)}"
    if symbol.type == "boolean":
        if switched := reader.settings.depending_on(symbol.path, TEST_ON, "greyed", "hidden"):
            yield f"while it is off, Blender's panels grey out or hide {_listed(switched, symbol.owner, reader)}"
        if switched := reader.settings.depending_on(symbol.path, TEST_ON, "idle"):
            yield f"while it is off, there is no effect of {_listed(switched, symbol.owner, reader)}"


def switches_off(symbol: Symbol, reader: BaseReader) -> Iterator[tuple[Symbol, bool | str]]:
    """The settings that panels ask for before they let a property be set, or an operator be run, and that new things
    have otherwise: each with the value that it must get.
    """
    for _, rows in groupby(reader.settings.conditions_of(symbol.path), lambda row: row.clause):
        row, *more = rows
        gate = None if more or not _contrary(row, reader) else reader.symbol(row.gate)
        if gate is not None and gate.type == "boolean":
            yield gate, row.test == TEST_ON
        elif gate is not None:
            named = [item.identifier for item in gate.enum_items if repr(item.identifier) in row.test]
            others = [item.identifier for item in gate.enum_items if item.identifier not in named]
            fitting = others if row.test.startswith(_NOT) else named
            if len(fitting) == 1 or (fitting and not row.test.startswith(_NOT)):
                yield gate, fitting[0]


def _joined(clauses: Sequence[Sequence[SettingCondition]], owners: set[str], reader: BaseReader) -> str:
    """Clauses as one condition."""
    told: list[str] = []
    for rows in clauses:
        either = " or ".join(_told(row, owners) for row in rows) + _when_new(rows, reader)
        told.append(f"({either})" if len(rows) > 1 and len(clauses) > 1 else either)
    return " and ".join(told)


def _is_denied(row: SettingCondition) -> bool:
    """Whether a test says what a setting must not be."""
    return row.test == TEST_OFF or row.test.startswith(_NOT)


def _denied(rows: Sequence[SettingCondition], owners: set[str], reader: BaseReader) -> str:
    """When a clause of such tests does not hold: what is said once is understood better than "unless … is not"."""
    opposite = [
        row._replace(test=TEST_ON if row.test == TEST_OFF else row.test.removeprefix(_NOT)) for row in rows
    ]
    return " and ".join(_told(row, owners) for row in opposite) + _when_new(rows, reader)


def _told(row: SettingCondition, owners: set[str]) -> str:
    owner, _, name = row.gate.rpartition(".")
    gate = name if owner in owners else f"{owner.rpartition('.')[2]}.{name}"
    is_word = row.test[0].isalpha() or row.test[0] == "'"
    return f"`{gate}` is {row.test}" if is_word else f"`{gate} {row.test}`"


def _when_new(rows: Sequence[SettingCondition], reader: BaseReader) -> str:
    """That new things have none of what is asked for, where it is known what they have."""
    found = [_contrary(row, reader) for row in rows]
    if not all(found):
        return ""
    if len(found) == 1:
        return f" (a new one has {found[0]})"
    are_off = set(found) == {_OFF}
    return " (a new one has all of them off)" if are_off else ""


def _contrary(row: SettingCondition, reader: BaseReader) -> str:
    """What a new one has instead of what is asked for; empty where it has that, or nobody knows."""
    gate = reader.symbol(row.gate)
    value = usual_default(gate) if gate else None
    if gate is None or not is_contrary(row, gate, value):
        return ""
    return (_ON if value else _OFF) if isinstance(value, bool) else f"`{value!r}`"


def _listed(paths: Sequence[str], cls: str, reader: BaseReader) -> str:
    names = [f"`{name}`" for name in _names(paths, cls, reader)]
    more = f" and {len(names) - _MOST_SWITCHED} more" if len(names) > _MOST_SWITCHED else ""
    return f"{', '.join(names[:_MOST_SWITCHED])}{more}"


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
