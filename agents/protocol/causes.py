"""One finding for one cause: findings that only follow from another one are left out."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.protocol.findings import Finding

_CONTACT_RULES = frozenset({"R5", "R6", "R7", "R8", "R9"})
_MOTION_RULES = frozenset({"T3", "T4", "T6", "T7"})


def without_consequences(findings: Sequence[Finding]) -> list[Finding]:
    """The findings without those that go away as soon as another one is mended.

    What is missing cannot be measured; what does not move at all moves neither far nor in time; surfaces that do not
    meet are told by the relation that says how they should; a cache that is not baked is told once.
    """
    broken = [finding for finding in findings if finding.outcome == "broken"]
    missing = {name for finding in broken if _says_missing(finding) for name in finding.objects}
    still = {finding.objects[0] for finding in broken if finding.rule == "T2" and finding.unit == "m/s"}
    related = [set(finding.objects) for finding in broken if finding.rule in _CONTACT_RULES]
    unbaked = {name for finding in broken if finding.rule == "R19" for name in finding.objects}
    worlds = [
        finding for finding in broken if finding.rule == "R19" and "rigid-body cache" in finding.message
    ]

    def follows(finding: Finding) -> bool:
        names = set(finding.objects)
        if finding.outcome == "undecided" and names & missing:
            return True
        if finding.rule in _MOTION_RULES and names & still and _is_about_no_motion(finding):
            return True
        if finding.rule == "V1" and finding.outcome == "broken":
            return any(names <= pair for pair in related)
        if finding.rule == "T1" and "cache" in finding.message:
            return bool(names & unbaked) if names else bool(worlds)
        return False

    return [finding for finding in findings if not follows(finding)]


def _says_missing(finding: Finding) -> bool:
    return finding.rule == "R1" and finding.measured == 0.0


def _is_about_no_motion(finding: Finding) -> bool:
    """Whether it says that something that stands still could not be judged, or does not get anywhere."""
    return finding.outcome == "undecided" or finding.rule == "T4"
