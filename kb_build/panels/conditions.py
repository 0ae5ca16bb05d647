"""What is kept of the conditions of Blender's panels: those on settings, as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.panels.formulas import YES, Clause, Need, follows
from kb_build.panels.idle import any_of
from kb_build.schema import TEST_OFF, TEST_ON
from kb_build.symbols.flag_names import READ_ONLY
from kb_build.symbols.flags import fillers
from kb_build.symbols.records import SettingCondition

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kb_build.flow.blender.symbols import Symbols
    from kb_build.panels.gating import Gating
    from kb_build.symbols.records import Symbol

_MOST_CLAUSES = 3
_MOST_VALUES = 6
# Classes whose settings Blender also shows by templates and panels that are not written in Python.
_SHOWN_BY_TEMPLATES = frozenset(
    {
        "ImageFormatSettings", "Image", "ImageUser", "ColorManagedDisplaySettings", "ColorManagedViewSettings",
        "ColorManagedInputColorspaceSettings", "ColorManagedSequencerColorspaceSettings", "ColorRamp", "CurveMapping",
        "CurveProfile", "MovieTrackingMarker", "MovieTrackingTrack", "CacheFile",
    }
)  # fmt: skip
# Operators that do what their arguments say: a button's condition is about what it names.
_OF_ARGUMENTS = "bpy.ops.wm."
_PANELS_IN_C = frozenset({"Modifier", "StripModifier", "ShaderFx", "Node", "NodeSocket"})
_OPPOSITE = {">": "<=", ">=": "<", "<": ">=", "<=": ">", "==": "!=", "!=": "=="}


def panel_conditions(found: Mapping[str, Gating], symbols: Symbols) -> Iterator[SettingCondition]:
    """The conditions that are worth telling, by property."""
    for path, gating in found.items():
        symbol = symbols.symbol(path)
        if symbol is None or not _is_shown_by_scripts_alone(symbol, symbols):
            continue
        clauses = [
            (clause, any(follows(clause, other) for other in gating.shown))
            for clause in gating.active
            if clause and all(_says_something(need, symbols) for need in clause)
        ]
        own = {*_lineage(symbol.owner, symbols)}
        # Where another class's setting hides a property, other places may show it that are not read, unless it is a
        # part of that class. What an operator works on is of another class.
        is_operator = symbol.kind == "operator"
        told = [
            row
            for row in clauses
            if is_operator or not row[1] or all(_is_of(need, own, symbols) for need in row[0])
        ]
        told.sort(key=lambda row: (not all(_owner(need) in own for need in row[0]), *_rank(row)))
        for number, (clause, hides) in enumerate(told[:_MOST_CLAUSES]):
            for need in sorted(clause, key=lambda one: (_owner(one) not in own, one.gate)):
                yield SettingCondition(
                    path, number, need.gate, _test(need, symbols), "hidden" if hides else "greyed"
                )


def _is_of(need: Need, own: set[str], symbols: Symbols) -> bool:
    """Whether a need is one of the classes ``own``, or of one that has them as a part, which it does not make: what
    makes a part is told with the part.
    """
    owner, name = _owner(need), need.gate.rpartition(".")[2]
    return owner in own or any(
        f"bpy.types.{member.target}" in own and not any(f".{name} = " in call for call in fillers(member))
        for member in symbols.members(owner)
        if member.type == "pointer" and READ_ONLY in member.flags
    )


def _rank(row: tuple[Clause, bool]) -> tuple[int, bool, bool, list[str]]:
    """Switches that grey a setting out come first."""
    clause, hides = row
    is_switch = all(need.values == YES and not need.relation and need.is_in for need in clause)
    return len(clause), hides, not is_switch, sorted(need.gate for need in clause)


def _owner(need: Need) -> str:
    return need.gate.rpartition(".")[0]


def _lineage(cls: str, symbols: Symbols) -> Iterator[str]:
    while symbol := symbols.symbol(cls):
        yield cls
        cls = symbol.base


def _is_shown_by_scripts_alone(symbol: Symbol, symbols: Symbols) -> bool:
    if symbol.kind == "operator":
        return not symbol.path.startswith(_OF_ARGUMENTS)
    names = [cls.rpartition(".")[2] for cls in _lineage(symbol.owner, symbols)]
    cls = symbols.symbol(symbol.owner)
    return (
        symbol.kind == "property"
        and READ_ONLY not in symbol.flags
        and cls is not None
        and cls.group == "data"
        and names[0] not in _SHOWN_BY_TEMPLATES
        and not _PANELS_IN_C.intersection(names)
    )


def _items(need: Need, symbols: Symbols) -> set[str]:
    """The values that an enumeration's gate can have; none where they are not known."""
    gate = symbols.symbol(need.gate)
    return {item.identifier for item in gate.enum_items} if gate and not gate.enum_computed else set()


def _says_something(need: Need, symbols: Symbols) -> bool:
    items = _items(need, symbols)
    if need.relation or need.values == YES or not items:
        return bool(need.values) and len(need.values) <= _MOST_VALUES
    values = need.values & items
    return bool(values) and len(values) < len(items) and len(values) <= _MOST_VALUES


def _test(need: Need, symbols: Symbols) -> str:
    """What must hold of a gate."""
    if need.relation.startswith("is "):
        return need.relation.removeprefix("is ") if need.is_in else _not(need.relation.removeprefix("is "))
    if need.relation:
        operator, _, number = need.relation.partition(" ")
        return f"{operator if need.is_in else _OPPOSITE[operator]} {number}"
    if need.values == YES:
        return TEST_ON if need.is_in else TEST_OFF
    items = _items(need, symbols)
    values = sorted(map(repr, need.values & items if items else need.values))
    if need.is_in:
        return any_of(values)
    return f"not {values[0]}" if len(values) == 1 else f"none of {', '.join(values)}"


def _not(test: str) -> str:
    return test.removeprefix("not ") if test.startswith("not ") else f"not {test}"
