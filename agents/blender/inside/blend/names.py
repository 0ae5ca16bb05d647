# SPDX-License-Identifier: GPL-3.0-or-later
"""Names in messages: the nearest to one that does not exist, series of them as one, and long lists cut short."""

import difflib
import re

_SERIES = 4  # fewer names are told one by one
_DIGITS = re.compile(r"\d+")
_COPY = re.compile(r"\.\d{3,}(?=$|\[| \()")  # what Blender appends to the name of a copy: Brick, Brick.001, …


def nearest(name, names, most=3):
    """Up to ``most`` names that are most like ``name``, whatever their case; then up to three that contain it."""
    names, wanted = list(names), name.lower()
    by_folded = {known.lower(): known for known in reversed(names)}
    near = [by_folded[folded] for folded in difflib.get_close_matches(wanted, by_folded, most, 0.5)]
    return near + [known for known in names if wanted and wanted in known.lower() and known not in near][:3]


def listed(words, most):
    """``a, b and 3 more``: the first ``most`` of some words, and how many more there are."""
    words = list(words)
    more = f" and {len(words) - most} more" if len(words) > most else ""
    return ", ".join(words[:most]) + more


def quoted(names, most):
    """As ``listed``, each name in quotes."""
    return listed(map(repr, names), most)


def series(names):
    """[(text, how many names it stands for)]: names that differ in numbers alone are one ``first … last (count)``."""
    alike = {}
    for name in names:
        alike.setdefault(_DIGITS.sub("#", _COPY.sub("", name)), []).append(name)
    told = []
    for group in alike.values():
        if len(group) < _SERIES:
            told += [(name, 1) for name in group]
        else:
            ordered = sorted(group, key=lambda name: [int(number) for number in _DIGITS.findall(name)])
            told.append((f"{ordered[0]} … {ordered[-1]} ({len(group)})", len(group)))
    return told
