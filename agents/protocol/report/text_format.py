"""Formats what reports consist of: text on one line, lists of names, measured values, ids of rules."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from simworlds.terminal.text import plain

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

ELLIPSIS = "…"
MAX_NAMES = 4
_MILLIMETRES_BELOW = 1.0  # metres
_NUMBERED_NAME = re.compile(r"^(.*?)[._ -]?(\d+)$", re.DOTALL)
_RULE_ID = re.compile(r"(\D+)(\d+)")


def fold_names(names: Iterable[str], most: int = MAX_NAMES) -> str:
    """``Cube … Cube.199 (200), Lamp``: three or more names that differ by a number become a range with a count."""
    stems: dict[str, list[str]] = {}
    for name in dict.fromkeys(names):
        numbered = _NUMBERED_NAME.match(name)
        stems.setdefault(numbered[1] if numbered and numbered[1] else name, []).append(name)
    texts: list[tuple[str, int]] = []  # with the number of names that each stands for
    for group in stems.values():
        if len(group) < 3:
            texts += [(plain(name), 1) for name in group]
        else:
            ordered = sorted(group, key=_number)
            ends = f"{plain(ordered[0])} {ELLIPSIS} {plain(ordered[-1])} ({len(group)})"
            texts.append((ends, len(group)))
    left = sum(count for _, count in texts[most:])
    return ", ".join(text for text, _ in texts[:most]) + (f" and {left} more" if left else "")


def _number(name: str) -> int:
    numbered = _NUMBERED_NAME.match(name)
    return int(numbered[2][-18:]) if numbered and numbered[1] else -1


def format_value(value: float, unit: str) -> str:
    """A measured value with its unit: lengths below a metre in millimetres."""
    return format_range([value], unit)


def format_range(values: Sequence[float | None], unit: str) -> str:
    """One value, or the range from the smallest to the largest, with the unit; "" if none is known."""
    known = [value for value in values if value is not None]
    if not known:
        return ""
    low, high = min(known), max(known)
    scale, name = (1000.0, "mm") if unit == "m" and max(map(abs, known)) < _MILLIMETRES_BELOW else (1.0, unit)
    numbers = list(dict.fromkeys(_format_number(value * scale) for value in (low, high)))
    if numbers == ["1"]:
        name = name.removesuffix("s") if name == "frames" else name
    text = " to ".join(numbers) if low < 0 else "–".join(numbers)
    space = "" if name in {"", "°"} or name.startswith("/") else " "
    return f"{text}{space}{name}"


def _format_number(value: float) -> str:
    return f"{value:.0f}" if abs(value) >= 1000 or value == int(value) else f"{value:.3g}"


def format_rule_ids(ids: Iterable[str], order: Sequence[str]) -> str:
    """``C1–C6, V1``: three or more rules of a family whose numbers follow each other become a range.

    ``order`` lists all rules.
    """
    places = {name: place for place, name in enumerate(order)}
    runs: list[list[str]] = []
    for name in sorted(set(ids), key=places.__getitem__):
        if runs and _is_next(runs[-1][-1], name):
            runs[-1].append(name)
        else:
            runs.append([name])
    return ", ".join(f"{run[0]}–{run[-1]}" if len(run) > 2 else ", ".join(run) for run in runs)


def _is_next(before: str, rule_id: str) -> bool:
    known = _RULE_ID.fullmatch(before)
    return known is not None and rule_id == f"{known[1]}{int(known[2]) + 1}"
