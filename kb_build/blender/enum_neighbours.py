"""Enum items that depend on a setting of another struct, beside their own: with which values they are taken.

Blender was asked in states of the own struct, with the values of the neighbour's settings, and where one of these
decides, of a second one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

_NAMED_VALUES = 6

States = Mapping[str, Sequence[str]]


def setting_text(name: str, values: Sequence[str]) -> str:
    """``codec='AV1'|'FFV1'``."""
    return _choice(name, [repr(value) for value in values])


def _choice(name: str, values: Sequence[str]) -> str:
    return f"{name}={'|'.join(values[:_NAMED_VALUES])}" + ("|…" if len(values) > _NAMED_VALUES else "")


class _Condition(NamedTuple):
    """What a neighbour's setting must be, in some states of the own struct; ``held``: it was so at the start."""

    states: States
    text: str
    held: bool


@dataclass(frozen=True, slots=True)
class TriedNeighbours:
    """What was tried with the neighbours of an enumeration's struct.

    A row says in which ``states`` of the own struct (setting → values) what was ``tried`` of a ``setting``: values, and
    the items taken with them; and which value it had at the ``start``. ``states`` are those of all trials: in those
    that no row names, the neighbour made no difference.
    """

    rows: Sequence[Mapping[str, Any]] = ()
    states: States | None = None

    @classmethod
    def of(cls, record: Mapping[str, Any] | None) -> TriedNeighbours:
        """From a line of the extract, None if there is none."""
        return cls(record["rows"], record["states"]) if record else cls()

    def items(self) -> list[str]:
        """All items that were taken with any value of a neighbour's setting."""
        return [*dict.fromkeys(item for row in self.rows for _, items in row["tried"] for item in items)]

    def where(self, item: str, with_item: Sequence[States], without: Sequence[States]) -> str:
        """Where an item is taken that depends on a neighbour, as what follows the word "taken"; empty for others.

        ``with_item`` and ``without`` are the states in which it was taken, and refused, while nothing was tried.
        """
        conditions = [condition for row in self.rows if (condition := _condition(item, row))]
        if not conditions:
            return ""
        mixed = {name: _by_value(name, conditions) for name in conditions[0].states}
        told = (self._told(name, found, with_item, without) for name, found in mixed.items() if found)
        if decided := next(filter(None, told), ""):
            return decided
        texts = [*dict.fromkeys(condition.text for condition in conditions)]
        is_all = all(found is not None and self._tried(name) <= found.keys() for name, found in mixed.items())
        return f"only {'' if is_all else 'in some modes, and only '}with {' or '.join(texts)}"

    def _tried(self, name: str) -> set[str]:
        return set((self.states or {}).get(name, ()))

    def _told(
        self,
        name: str,
        mixed: Mapping[str, _Condition],
        with_item: Sequence[States],
        without: Sequence[States],
    ) -> str:
        """Where it is taken, if a setting of its own struct says in which cases the neighbour decides; else empty."""
        taken, refused = _seen(name, with_item), _seen(name, without)
        if any(value in (refused if condition.held else taken) for value, condition in mixed.items()):
            return ""
        known = self._tried(name) - mixed.keys()
        always, never = sorted(taken & known), sorted(refused & known)
        texts = {condition.text for condition in mixed.values()}
        if len(texts) > 1 or set(always) & set(never) or not (always or never):
            return ""
        mode, text = f"with {setting_text(name, sorted(mixed))}", texts.pop()
        if not always:
            return f"only {mode} if {text}"
        if len(always) <= len(never):
            return f"only with {setting_text(name, always)}; {mode} only if {text}"
        refusing = f"not with {setting_text(name, never)}; " if never else ""
        return f"{refusing}{mode} only if {text}"


def _condition(item: str, row: Mapping[str, Any]) -> _Condition | None:
    """What a row says of an item; None where it is taken with all that was tried, or with nothing."""
    outcomes = [(values, item in items) for values, items in row["tried"]]
    if len({taken for _, taken in outcomes}) < 2:
        return None
    held = any(taken and values[0] == row["start"] for values, taken in outcomes)
    return _Condition(row["states"], _choice(row["setting"], [*_values(outcomes)]), held)


def _values(outcomes: Sequence[tuple[Sequence[str], bool]]) -> Iterator[str]:
    """The values with which it is taken, with those of the second setting where that matters."""
    for value, tried in groupby(outcomes, lambda outcome: outcome[0][0]):
        group = list(tried)
        second = [values for values, taken in group if taken]
        if len(second) == len(group):
            yield repr(value)
        elif second:
            yield f"{value!r} (with {setting_text(second[0][1], [values[2] for values in second])})"


def _by_value(name: str, conditions: Sequence[_Condition]) -> dict[str, _Condition] | None:
    """Value of an own setting → what the neighbour's must be there; None if one value has several conditions."""
    found: dict[str, _Condition] = {}
    for condition in conditions:
        for value in condition.states.get(name, ()):
            if found.setdefault(value, condition).text != condition.text:
                return None
    return found


def _seen(name: str, states: Sequence[States]) -> set[str]:
    return {value for state in states for value in state.get(name, ())}
