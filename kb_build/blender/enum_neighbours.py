"""Enum items that depend on a setting of another struct, beside their own: with which values they are taken.

Blender was asked in states of the own struct, with the values of the neighbour's settings, and where one of these
decides, of a second one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any, NamedTuple

from kb_build.symbols.taken import Beside, Setting, Taken

States = Mapping[str, Sequence[str]]


class _Condition(NamedTuple):
    """What a neighbour's setting must be, in some states of the own struct; ``held``: it was so at the start."""

    states: States
    needed: Setting
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

    def where(self, item: str, with_item: Sequence[States], without: Sequence[States]) -> Taken | None:
        """Where an item is taken that depends on a neighbour; None for others.

        ``with_item`` and ``without`` are the states in which it was taken, and refused, while nothing was tried.
        """
        conditions = [condition for row in self.rows if (condition := _condition(item, row))]
        if not conditions:
            return None
        mixed = {name: _by_value(name, conditions) for name in conditions[0].states}
        told = (self._told(name, found, with_item, without) for name, found in mixed.items() if found)
        if decided := next(filter(None, told), None):
            return decided
        needed = tuple(dict.fromkeys(condition.needed for condition in conditions))
        is_all = all(found is not None and self._tried(name) <= found.keys() for name, found in mixed.items())
        return Taken("only", needed, in_some_modes=not is_all)

    def _tried(self, name: str) -> set[str]:
        return set((self.states or {}).get(name, ()))

    def _told(
        self,
        name: str,
        mixed: Mapping[str, _Condition],
        with_item: Sequence[States],
        without: Sequence[States],
    ) -> Taken | None:
        """Where it is taken, if a setting of its own struct says in which cases the neighbour decides; else None."""
        taken, refused = _seen(name, with_item), _seen(name, without)
        if any(value in (refused if condition.held else taken) for value, condition in mixed.items()):
            return None
        known = self._tried(name) - mixed.keys()
        always, never = sorted(taken & known), sorted(refused & known)
        needed = {condition.needed for condition in mixed.values()}
        if len(needed) > 1 or set(always) & set(never) or not (always or never):
            return None
        beside = Beside(Setting(name, tuple(sorted(mixed))), needed.pop())
        few_take = len(always) <= len(never)
        named = always if few_take else never
        settings = (Setting(name, tuple(named)),) if named else ()
        return Taken("only" if few_take else "not", settings, beside=beside)


def _condition(item: str, row: Mapping[str, Any]) -> _Condition | None:
    """What a row says of an item; None where it is taken with all that was tried, or with nothing."""
    outcomes = [(values, item in items) for values, items in row["tried"]]
    if len({taken for _, taken in outcomes}) < 2:
        return None
    held = any(taken and values[0] == row["start"] for values, taken in outcomes)
    return _Condition(row["states"], _needed(row["setting"], outcomes), held)


def _needed(name: str, outcomes: Sequence[tuple[Sequence[str], bool]]) -> Setting:
    """The values with which it is taken, with those of the second setting where that matters."""
    values: list[str] = []
    also: list[tuple[str, Setting]] = []
    for value, tried in groupby(outcomes, lambda outcome: outcome[0][0]):
        group = list(tried)
        taking = [given for given, taken in group if taken]
        if taking:
            values.append(value)
        if 0 < len(taking) < len(group):
            also.append((value, Setting(taking[0][1], tuple(given[2] for given in taking))))
    return Setting(name, tuple(values), tuple(also))


def _by_value(name: str, conditions: Sequence[_Condition]) -> dict[str, _Condition] | None:
    """Value of an own setting → what the neighbour's must be there; None if one value has several conditions."""
    found: dict[str, _Condition] = {}
    for condition in conditions:
        for value in condition.states.get(name, ()):
            if found.setdefault(value, condition).needed != condition.needed:
                return None
    return found


def _seen(name: str, states: Sequence[States]) -> set[str]:
    return {value for state in states for value in state.get(name, ())}
