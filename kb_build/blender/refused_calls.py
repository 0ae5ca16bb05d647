"""What decides whether a call is refused: from the outcomes of all that were tried."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_NONE = "returned None"


@dataclass(frozen=True, slots=True)
class _Call:
    """One call: the values of its choices by argument, and of what it was made."""

    chosen: Mapping[str, str]
    made: str


@dataclass(frozen=True, slots=True)
class _Tried:
    """The calls that ended in one way, and all the others."""

    calls: Sequence[_Call]
    others: Sequence[_Call]

    def decided_by_argument(self) -> tuple[str, tuple[str, ...]]:
        """The argument whose value decides, with the values of these calls; empty for none."""
        for name in self.calls[0].chosen:
            values = dict.fromkeys(call.chosen[name] for call in self.calls)
            if values.keys().isdisjoint(call.chosen[name] for call in self.others):
                return name, tuple(values)
        return "", ()

    def decided_by_thing(self) -> bool:
        """Whether what the calls are made of decides."""
        return {call.made for call in self.calls}.isdisjoint(call.made for call in self.others)


def refusals(outcomes: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Rows for records.Refusal, from what came of all calls that were tried of a function (inside.tried.refusals)."""
    first: dict[tuple[str, tuple[str, ...], str], list[_Call]] = defaultdict(list)
    again: dict[tuple[str, str], list[_Call]] = defaultdict(list)
    for row in outcomes:
        call = _Call(row["chosen"], row["made"])
        if row.get("again"):
            again[row["message"], row["again"]].append(call)
        else:
            first[row["message"], tuple(row.get("given", ())), row.get("mode", "")].append(call)
    taken = first.get(("", (), ""), [])
    rows: list[dict[str, Any]] = []
    for (message, given, mode), calls in first.items():
        others = [call for key, calls in first.items() if key != (message, given, mode) for call in calls]
        if message:
            told = {"given": given, "mode": mode} if given or mode else {}
            rows += [_row(message, **told, **found) for found in _reasons(_Tried(calls, others), taken)]
    for (message, which), calls in again.items():
        refused = {(call.made, *call.chosen.values()) for call in calls}
        others = [call for call in taken if (call.made, *call.chosen.values()) not in refused]
        rows += [_row(message, again=which, **found) for found in _reasons(_Tried(calls, others), taken)]
    return [row for row in rows if row["message"] or len(row) > 1]


def _row(message: str, **told: Any) -> dict[str, Any]:
    return {"message": "" if message == _NONE else message, **told}


def _reasons(tried: _Tried, taken: Sequence[_Call]) -> list[dict[str, Any]]:
    """What calls have in common that ended in one way: the value of an argument, or what they were made of, or both."""
    if not tried.others:
        return [{}]
    argument, values = tried.decided_by_argument()
    if argument:
        return [{"argument": argument, "values": values}]
    if tried.decided_by_thing():
        return [{"by": _things(tried.calls), "taken_by": _things(tried.others)}]
    return _both(tried.calls, taken)


def _both(calls: Sequence[_Call], taken: Sequence[_Call]) -> list[dict[str, Any]]:
    """By the one argument with a choice: the values that the same things take, and those that none takes."""
    if len(calls[0].chosen) != 1:
        return [{}]
    (argument,) = calls[0].chosen
    refused_by: dict[str, list[_Call]] = defaultdict(list)
    for call in calls:
        refused_by[call.chosen[argument]].append(call)
    values: dict[tuple[tuple[str, ...], tuple[str, ...]], list[str]] = defaultdict(list)
    for value, refused in refused_by.items():
        takers = _things([call for call in taken if call.chosen[argument] == value])
        values[_things(refused), takers].append(value)
    return [
        {"argument": argument, "values": tuple(found)} | ({"by": by, "taken_by": takers} if takers else {})
        for (by, takers), found in values.items()
    ]


def _things(calls: Sequence[_Call]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(call.made for call in calls))
