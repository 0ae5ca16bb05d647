"""Groups findings that say the same of different objects, so that reports show them as one."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.protocol.report.text_format import ELLIPSIS, MAX_NAMES, fold_names, format_range
from simworlds.terminal.text import plain

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from agents.protocol.findings import Finding

_NUMBER = r"-?(?:\d[\d,]*)(?:\.\d+)?(?:e[+-]?\d+)?"
# What may differ between findings that say the same: quoted names (not apostrophes), and numbers.
_VARIES = re.compile(
    rf"""((?<!\w)'(?:[^'\\\n]|\\.)*'(?!\w)|(?<!\w)"(?:[^"\\\n]|\\.)*"(?!\w)|(?<![\w.]){_NUMBER}(?![\w.]*\w))"""
)


@dataclass(frozen=True, slots=True)
class FindingGroup:
    """Findings that say the same, the worst first. ``message`` has an ellipsis where they differ."""

    findings: tuple[Finding, ...]
    message: str

    @property
    def worst(self) -> Finding:
        """The finding with the largest deviation."""
        return self.findings[0]

    @property
    def differ(self) -> bool:
        """Whether the findings have different fixes."""
        return len({finding.fix for finding in self.findings}) > 1

    def objects(self, most: int = MAX_NAMES) -> str:
        """The objects of the findings: numbered names as a range, else the first few."""
        tuples = list(dict.fromkeys(finding.objects for finding in self.findings))
        if any(len(names) != 1 for names in tuples):
            first, *rest = tuples
            if len(first) > 1 and rest and all(names[1:] == first[1:] for names in rest):
                return " · ".join([fold_names((names[0] for names in tuples), most), *map(plain, first[1:])])
            lines = [
                " · ".join([*map(plain, names[:most]), *_more(len(names), most)]) for names in tuples[:most]
            ]
            return "\n".join([*lines, *_more(len(tuples), most)])
        return fold_names((names[0] for names in tuples), most)

    @property
    def measured(self) -> str:
        """The measured value, or the range from the smallest to the largest."""
        return format_range([finding.measured for finding in self.findings], self.worst.unit)

    @property
    def tolerance(self) -> str:
        """The tolerance, or the range of the tolerances."""
        return format_range([finding.tolerance for finding in self.findings], self.worst.unit)


def group_findings(findings: Iterable[Finding]) -> list[FindingGroup]:
    """Groups findings: hard before soft, broken before undecided, otherwise in the given order."""
    groups: dict[object, list[Finding]] = {}
    for finding in findings:
        fixed = tuple(_VARIES.split(finding.message)[::2])
        key = (finding.rule, finding.severity, finding.outcome, finding.unit, fixed)
        groups.setdefault(key, []).append(finding)
    folded = [FindingGroup(tuple(sorted(group, key=_deviation)), _common(group)) for group in groups.values()]
    return sorted(folded, key=lambda group: (group.worst.severity != "hard", group.worst.outcome != "broken"))


def _deviation(finding: Finding) -> float:
    """A sort key: smaller for larger deviations."""
    if finding.measured is None:
        return 0.0
    return -abs(finding.measured) / (finding.tolerance or 1.0)


def _common(findings: Sequence[Finding]) -> str:
    """The message that the findings share, with an ellipsis where they differ."""
    pieces = [_VARIES.split(finding.message) for finding in findings]
    same = [words[0] if len(set(words)) == 1 else ELLIPSIS for words in zip(*pieces, strict=True)]
    return plain("".join(same))


def _more(count: int, most: int) -> list[str]:
    return [f"and {count - most} more"] if count > most else []
