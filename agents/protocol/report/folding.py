"""Findings as they are read: those that say the same of different objects are one row."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from simworlds.terminal.text import plain

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from agents.protocol.findings import Finding

_ANY = "…"
_NUMBER = r"-?(?:\d[\d,]*)(?:\.\d+)?(?:e[+-]?\d+)?"
# What may differ between findings that say the same: names in quotes (but no apostrophes), and numbers.
_VARIES = re.compile(
    rf"""((?<!\w)'(?:[^'\\\n]|\\.)*'(?!\w)|(?<!\w)"(?:[^"\\\n]|\\.)*"(?!\w)|(?<![\w.]){_NUMBER}(?![\w.]*\w))"""
)
_NUMBERED = re.compile(r"^(.*?)[._ -]?(\d+)$", re.DOTALL)
LISTED = 4
_MILLIMETRES_BELOW = 1.0  # metres
_ID = re.compile(r"(\D+)(\d+)")


@dataclass(frozen=True, slots=True)
class Row:
    """Findings that say the same, the worst first. ``message`` has an ellipsis where they differ."""

    findings: tuple[Finding, ...]
    message: str

    @property
    def worst(self) -> Finding:
        """The one that is farthest off."""
        return self.findings[0]

    @property
    def differ(self) -> bool:
        """Whether each has something else that is to be done about it."""
        return len({finding.fix for finding in self.findings}) > 1

    def objects(self, most: int = LISTED) -> str:
        """Whom it is about: folded where names are numbered, else the first few."""
        found = list(dict.fromkeys(finding.objects for finding in self.findings))
        if any(len(names) != 1 for names in found):
            first, *rest = found
            if len(first) > 1 and rest and all(names[1:] == first[1:] for names in rest):
                return " · ".join([folded((names[0] for names in found), most), *map(plain, first[1:])])
            told = [
                " · ".join([*map(plain, names[:most]), *_more(len(names), most)]) for names in found[:most]
            ]
            return "\n".join([*told, *_more(len(found), most)])
        return folded((names[0] for names in found), most)

    @property
    def measured(self) -> str:
        """What was measured: one value, or from the least to the most."""
        return _told_range([one.measured for one in self.findings], self.worst.unit)

    @property
    def tolerance(self) -> str:
        """What would have been let through."""
        return _told_range([one.tolerance for one in self.findings], self.worst.unit)


def rows(findings: Iterable[Finding]) -> list[Row]:
    """What is broken and hard first, then what could not be decided, then what is soft; else in the order given."""
    groups: dict[object, list[Finding]] = {}
    for finding in findings:
        fixed = tuple(_VARIES.split(finding.message)[::2])
        key = (finding.rule, finding.severity, finding.outcome, finding.unit, fixed)
        groups.setdefault(key, []).append(finding)
    made = [Row(tuple(sorted(group, key=_badness)), _common(group)) for group in groups.values()]
    return sorted(made, key=lambda row: (row.worst.severity != "hard", row.worst.outcome != "broken"))


def _badness(finding: Finding) -> float:
    """Smaller for what is farther off."""
    if finding.measured is None:
        return 0.0
    return -abs(finding.measured) / (finding.tolerance or 1.0)


def _common(findings: Sequence[Finding]) -> str:
    """The messages' words, with what all of them share; a list of differing things is told as one."""
    pieces = [_VARIES.split(finding.message) for finding in findings]
    same = [words[0] if len(set(words)) == 1 else _ANY for words in zip(*pieces, strict=True)]
    return plain("".join(same))


# Names


def folded(names: Iterable[str], most: int = LISTED) -> str:
    """``Cube … Cube.199 (200), Lamp``: names that differ by a number are told by their ends and their count."""
    stems: dict[str, list[str]] = {}
    for name in dict.fromkeys(names):
        numbered = _NUMBERED.match(name)
        stems.setdefault(numbered[1] if numbered and numbered[1] else name, []).append(name)
    told = [_run(found) for found in stems.values()]
    shown = [text for texts in told for text in texts]
    left = sum(len(found) for found in stems.values()) - _counted(stems.values(), told, most)
    return ", ".join(shown[:most]) + (f" and {left} more" if left > 0 else "")


def _run(names: list[str]) -> list[str]:
    if len(names) < 3:
        return [plain(name) for name in names]
    ordered = sorted(names, key=_number)
    return [f"{plain(ordered[0])} {_ANY} {plain(ordered[-1])} ({len(names)})"]


def _number(name: str) -> int:
    found = _NUMBERED.match(name)
    return int(found[2][-18:]) if found and found[1] else -1


def _counted(groups: Iterable[list[str]], told: list[list[str]], most: int) -> int:
    """How many names the first ``most`` texts stand for."""
    counts = [
        count
        for names, texts in zip(groups, told, strict=True)
        for count in ([len(names)] if len(texts) == 1 else [1] * len(texts))
    ]
    return sum(counts[:most])


def _more(count: int, most: int) -> list[str]:
    return [f"and {count - most} more"] if count > most else []


# Values


def _told_range(values: Sequence[float | None], unit: str) -> str:
    known = [value for value in values if value is not None]
    if not known:
        return ""
    low, high = min(known), max(known)
    scale, name = (1000.0, "mm") if unit == "m" and max(map(abs, known)) < _MILLIMETRES_BELOW else (1.0, unit)
    words = list(dict.fromkeys(_told_number(value * scale) for value in (low, high)))
    if words == ["1"]:
        name = name.removesuffix("s") if name == "frames" else name
    text = " to ".join(words) if low < 0 else "–".join(words)
    space = "" if name in {"", "°"} or name.startswith("/") else " "
    return f"{text}{space}{name}"


def told_value(value: float, unit: str) -> str:
    """A measured value with its unit: lengths below 10 cm in millimetres."""
    return _told_range([value], unit)


def _told_number(value: float) -> str:
    return f"{value:.0f}" if abs(value) >= 1000 or value == int(value) else f"{value:.3g}"


# Rules


def told_ids(ids: Iterable[str], order: Sequence[str]) -> str:
    """``C1–C6, V1``: rules that follow each other in ``order``, within a family, are told by their ends."""
    places = {name: place for place, name in enumerate(order)}
    runs: list[list[str]] = []
    for name in sorted(set(ids), key=places.__getitem__):
        if runs and places[name] == places[runs[-1][-1]] + 1 and _family(name) == _family(runs[-1][-1]):
            runs[-1].append(name)
        else:
            runs.append([name])
    return ", ".join(f"{run[0]}–{run[-1]}" if len(run) > 2 else ", ".join(run) for run in runs)


def _family(name: str) -> str:
    found = _ID.match(name)
    return found[1] if found else name
