"""Finds properties of a class that always have the same value: two names of one field, or of two that go together."""

from __future__ import annotations

import ast
from collections import defaultdict
from typing import TYPE_CHECKING, Any

from kb_build.symbols.flag_names import SAME_VALUE

if TYPE_CHECKING:
    from collections.abc import Mapping

_FEWEST = 2  # values; one may be alike by chance


def mark_same_values(symbols: Mapping[str, dict[str, Any]]) -> None:
    """Marks both of two such properties, and takes from each what it had with the values of the other.

    They are those that were seen to have each value that the other one was given, either way.
    """
    followed = {path: names for path, row in symbols.items() if (names := _followed(row))}
    for path, names in followed.items():
        owner, _, name = path.rpartition(".")
        for other in names:
            if name in followed.get(f"{owner}.{other}", ()):
                row = symbols[path]
                row["flags"] = [*row.get("flags", ()), SAME_VALUE + other]
                row["new_values"] = [new for new in row["new_values"] if _setting(new)[0] != other]


def _followed(row: Mapping[str, Any]) -> set[str]:
    """The settings of its class of which a property had every value that they were given."""
    seen: dict[str, list[bool]] = defaultdict(list)
    for new in row.get("new_values", ()):
        name, value = _setting(new)
        if name:
            seen[name].append(new.get("value") == value and not new.get("made"))
    return {name for name, same in seen.items() if len(same) >= _FEWEST and all(same)}


def _setting(new: Mapping[str, Any]) -> tuple[str, Any]:
    """The setting of the same class with which something has a value, and the value of that; "" for none."""
    name, equals, text = new.get("when", "").partition("=")
    return (name, ast.literal_eval(text)) if equals and name.isidentifier() else ("", None)
