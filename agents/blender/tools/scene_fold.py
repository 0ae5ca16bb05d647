"""Folds entries that differ only in numbers: Brick.001 … Brick.400 become one entry with ranges."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final, cast

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

Entry = dict[str, Any]


class Range(dict[str, Any]):
    """A range of numbers, ``from`` and ``to``, as JSON."""


LEAST = 4  # fewer entries are not folded
_DIGITS = re.compile(r"\d+")
_COPY = re.compile(r"\.\d{3,}$")  # what Blender appends to the name of a copy: Brick, Brick.001, …
_SPECIAL = re.compile(r"[*?[]")
_OWN = ("name", "count", "pattern")
# Keys that an entry may lack and still be folded with others, and the values that this means.
_OPTIONAL: Final[dict[str, Any]] = {
    "rotation": [0, 0, 0],
    "scale": [1, 1, 1],
    "evaluated_vertices": None,
    "shares": None,
    "data": None,
    "names": None,
    "points": None,
}


def fold(entries: Sequence[Entry], *, by_name: bool = True) -> list[Entry]:
    """The entries in order, each series of similar ones as one entry with ``count``, ``pattern`` and ranges.

    ``by_name``: only those whose names differ only in numbers; otherwise whatever their names.
    """
    groups: dict[Any, list[Entry]] = {}
    of_each: list[list[Entry]] = []
    for entry in entries:
        key = entry if by_name else {**entry, "name": "", "pattern": "", "count": 0}
        group = groups.setdefault(_shape_of_entry(key), [])
        group.append(entry)
        of_each.append(group)
    folded: list[Entry] = []
    for entry, group in zip(entries, of_each, strict=True):
        if len(group) < LEAST:
            folded.append(entry)
        elif group[0] is entry:
            folded.append(merge(group))
    return folded


def fold_tree(entries: Sequence[Entry]) -> list[Entry]:
    """The same for entries that form a tree by ``depth``: similar branches become one."""
    branches: list[list[Entry]] = []
    for entry in entries:
        if not branches or entry["depth"] <= branches[0][0]["depth"]:
            branches.append([entry])
        else:
            branches[-1].append(entry)
    branches = [[branch[0], *fold_tree(branch[1:])] for branch in branches]
    groups: dict[Any, list[list[Entry]]] = {}
    for branch in branches:
        groups.setdefault(tuple(map(_shape_of_entry, branch)), []).append(branch)
    folded: list[Entry] = []
    for branch in branches:
        group = groups[tuple(map(_shape_of_entry, branch))]
        if len(group) < LEAST:
            folded.extend(branch)
        elif group[0] is branch:
            folded.extend(merge(level) for level in zip(*group, strict=True))
    return folded


def series(names: Sequence[str]) -> list[str]:
    """Names in order, each series of at least LEAST as "first … last (count)"."""
    folded: list[str] = []
    for entry in fold([{"name": name} for name in names]):
        count = entry.get("count", 1)
        folded.append(f"{entry['name']} ({count})" if count > 1 else entry["name"])
    return folded


def shape_of(value: Any) -> Any:
    """What values must have in common to be folded: everything but numbers, and numbers in names."""
    if isinstance(value, bool) or value is None:
        return value
    if isinstance(value, (int, float, Range)):
        return int
    if isinstance(value, str):
        return _DIGITS.sub("#", _COPY.sub("", value))
    if isinstance(value, list):
        return (list, *map(shape_of, cast("list[Any]", value)))
    return tuple((key, shape_of(item)) for key, item in cast("dict[str, Any]", value).items())


def _shape_of_entry(entry: Entry) -> Any:
    return tuple(
        (key, _shape_of_box(item) if key == "extent" else shape_of(item))
        for key, item in entry.items()
        if key not in _OPTIONAL
    )


def _shape_of_box(box: dict[str, Any]) -> Any:
    return tuple(shape_of(box[key]) for key in ("min", "max", "size"))


def merge(entries: Sequence[Entry]) -> Entry:
    """One entry for several entries of the same shape."""
    names = list(dict.fromkeys(str(entry["name"]) for entry in entries))
    merged: Entry = {"name": names[0], "count": sum(entry.get("count", 1) for entry in entries)}
    if len(names) > 1 and len({shape_of(name) for name in names}) == 1:
        merged |= {"name": _first_to_last(names), "pattern": pattern_of(names)}
    elif len(names) > 1:
        merged["name"] = f"{names[0]}, {names[1]} and similar ones"
    for key in dict.fromkeys(key for entry in entries for key in entry if key not in _OWN):
        values = [entry[key] for entry in entries if key in entry]
        if key == "extent":
            merged[key] = _around(values)
        elif key not in _OPTIONAL:
            merged[key] = _merged(values)
        elif (whole := _merged_optional(values, _OPTIONAL[key], len(entries))) is not None:
            merged[key] = whole
    return merged


def _merged_optional(values: list[Any], usual: Any, count: int) -> Any:
    """The merged value of a key that some entries lack; None if there is no single one."""
    if len(values) < count:
        if usual is None:
            return None
        values = [*values, usual]
    return _merged(values) if len({shape_of(value) for value in values}) == 1 else None


def pattern_of(names: Sequence[str]) -> str:
    """A glob for names that differ only in numbers."""
    patterns = {_DIGITS.sub("*", _SPECIAL.sub(lambda sign: f"[{sign[0]}]", name)) for name in names}
    # The first of several copies has no number.
    return min(patterns, key=len).rstrip("*") + "*" if len(patterns) > 1 else patterns.pop()


def _first_to_last(names: Sequence[str]) -> str:
    def in_order(name: str) -> list[int]:
        return [int(number) for number in _DIGITS.findall(name)]

    return f"{min(names, key=in_order)} … {max(names, key=in_order)}"


def _merged(values: Sequence[Any]) -> Any:
    first = values[0]
    if isinstance(first, (int, float, Range)) and not isinstance(first, bool):
        return _merged_numbers(values)
    if all(value == first for value in values):
        return first
    if isinstance(first, dict):
        tables = [cast("dict[str, Any]", value) for value in values]
        return {key: _merged([table[key] for table in tables]) for key in tables[0]}
    if isinstance(first, list):
        return [_merged(items) for items in zip(*(cast("list[Any]", value) for value in values), strict=True)]
    return _first_to_last([str(value) for value in values])


def _merged_numbers(values: Sequence[Any]) -> Any:
    low = min(value["from"] if isinstance(value, Range) else value for value in values)
    high = max(value["to"] if isinstance(value, Range) else value for value in values)
    return low if low == high else Range({"from": low, "to": high})


def _around(boxes: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The extent of several boxes: the box around all, and the range of their sizes."""
    extent: dict[str, Any] = {"min": _ends(boxes, "min", min), "max": _ends(boxes, "max", max)}
    extent["size"] = _merged([box["size"] for box in boxes])
    if any(box.get("rough") for box in boxes):
        extent["rough"] = True
    return extent


def _ends(boxes: Iterable[dict[str, Any]], key: str, choose: Any) -> list[Any]:
    return [choose(axis) for axis in zip(*(box[key] for box in boxes), strict=True)]
