"""Enum items that depend on the instance: which are taken at all, and where."""

from __future__ import annotations

from ast import literal_eval
from collections import defaultdict
from typing import TYPE_CHECKING, Any

from kb_build.blender.enum_neighbours import TriedNeighbours
from kb_build.symbols.taken import NEVER, Setting, Taken

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

# What was made, and the mode that it was put into; "" for that of a new one.
Context = tuple[str, str]


def items_in_contexts(
    listed: Sequence[Mapping[str, Any]],
    contexts: Sequence[Mapping[str, Any]],
    texts: Mapping[str, Sequence[str]],
    neighbours: Mapping[str, Any] | None = None,
) -> list[dict[str, Any]]:
    """The items of an enumeration as rows for records.EnumItem, with ``where`` each is taken.

    ``listed`` are RNA's own; ``contexts`` rows with ``items``, ``made``, the contexts that take just those, and
    ``states``, the values that other enumerations of the instance had there; ``texts`` name and description of
    items that RNA does not list; ``neighbours`` what was tried with settings of other structs, as enum_neighbours has
    it. A lone placeholder of RNA's is left out.
    """
    taken: dict[str, set[Context]] = defaultdict(set)
    beside = TriedNeighbours.of(neighbours)
    for item in beside.items():
        taken[item] = set()
    everywhere: set[Context] = set()
    for row in contexts:
        made = {(label, mode) for label, mode in row["made"]}
        everywhere |= made
        for item in row["items"]:
            taken[item] |= made
    rows = {item["identifier"]: dict(item) for item in listed}
    if len(rows) == 1 and not taken.keys() & rows.keys():
        rows.clear()
    for item in taken:
        name, description = texts.get(item, ("", ""))
        rows.setdefault(item, {"identifier": item, "name": name, "description": description})
    for item, row in rows.items():
        row["where"] = None if item in taken else NEVER
        with_item = [each["states"] for each in contexts if item in each["items"]]
        without = [each["states"] for each in contexts if item not in each["items"]]
        if where := beside.where(item, with_item, without):
            row["where"] = where
        elif everywhere - taken.get(item, everywhere):
            row["where"] = _deciding(with_item, without) or where_taken(taken[item], everywhere - taken[item])
    return list(rows.values())


def _deciding(
    with_item: Sequence[Mapping[str, Sequence[str]]], without: Sequence[Mapping[str, Sequence[str]]]
) -> Taken | None:
    """The one enumeration whose value decides whether an item is taken; None for none."""
    for name in with_item[0]:
        taken = sorted({value for states in with_item for value in states.get(name, ())})
        refused = sorted({value for states in without for value in states.get(name, ())})
        if taken and refused and not set(taken) & set(refused):
            few_take = len(taken) <= len(refused)
            setting = Setting(name, tuple(taken if few_take else refused))
            return Taken("only" if few_take else "not", (setting,))
    return None


def where_taken(taken: set[Context], refused: set[Context]) -> Taken:
    """In which contexts an item is taken: where it is that decides it, a mode, or what was made."""
    if where := _place_taken(taken, refused):
        return where
    new_taken = {label for label, mode in taken if not mode}
    new_refused = {label for label, mode in refused if not mode}
    if not new_taken:
        return Taken("only", _settings(mode for _, mode in taken))
    if not new_refused:
        return Taken("not", _settings(mode for _, mode in refused))
    if new_refused <= {label for label, _ in taken}:  # in a mode that they are not in when new
        settings = _settings(mode for label, mode in taken if label in new_refused)
        return Taken("only", settings, _shortest_first(new_refused))
    fewer_take = len(new_taken) <= len(new_refused)
    things = _shortest_first(new_taken if fewer_take else new_refused)
    return Taken("only" if fewer_take else "not", things=things)


def _place_taken(taken: set[Context], refused: set[Context]) -> Taken | None:
    """Where alone what takes an item is, and what takes it there if not all does; None where no place decides."""
    present = {_placed(label)[1] for label, _ in taken}
    absent = {_placed(label)[1] for label, _ in refused} - present
    if not absent or "" in present | absent:  # of some it is not told where they are
        return None
    few_take = len(present) <= len(absent)
    where = Taken("only" if few_take else "not", places=tuple(sorted(present if few_take else absent)))
    refused_there = {(label, mode) for label, mode in refused if _placed(label)[1] in present}
    if not refused_there:
        return where
    there = ({(_placed(label)[0], mode) for label, mode in found} for found in (taken, refused_there))
    return where._replace(there=where_taken(*there))


def _placed(label: str) -> tuple[str, str]:
    """What was made, and where that is: ``GeometryNodeTree``; empty for anywhere."""
    name, _, place = label.partition(" in a ")
    return name, place


def _settings(modes: Iterable[str]) -> tuple[Setting, ...]:
    """Modes, ``system='NONE'``, as the settings that they are of."""
    values: dict[str, list[str]] = defaultdict(list)
    for name, value in sorted(tuple(mode.split("=", 1)) for mode in set(modes)):
        values[name].append(literal_eval(value))
    return tuple(Setting(name, tuple(found)) for name, found in values.items())


def _shortest_first(labels: set[str]) -> tuple[str, ...]:
    return tuple(sorted(labels, key=lambda label: (len(label), label)))
