"""What the verifier reports: findings, and the report that holds them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

Severity = Literal["hard", "soft"]
Outcome = Literal["broken", "undecided", "error"]


@dataclass(frozen=True, slots=True)
class Finding:
    """One breach of one rule.

    ``outcome``: the rule is broken, could not be decided, or failed itself. ``message`` says what is wrong, ``fix``
    what to change. ``measured`` and ``tolerance`` are in ``unit``. ``at`` is the place in the world, for pictures.
    """

    rule: str
    severity: Severity
    objects: tuple[str, ...]
    message: str
    fix: str = ""
    outcome: Outcome = "broken"
    frame: int | None = None
    measured: float | None = None
    tolerance: float | None = None
    unit: str = ""
    at: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class Report:
    """The outcome of a run.

    ``passed`` are the rules that ran and found nothing; ``not_applicable`` maps those with nothing to judge to the
    reason. ``remarks`` are sentences on how the scene was judged.
    """

    findings: tuple[Finding, ...]
    passed: tuple[str, ...]
    not_applicable: dict[str, str] = field(default_factory=dict[str, str])
    seconds: float = 0.0
    remarks: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether no hard rule is broken, undecided or failed itself."""
        return not any(finding.severity == "hard" for finding in self.findings)

    @property
    def decided(self) -> bool:
        """Whether every rule could be judged."""
        return all(finding.outcome == "broken" for finding in self.findings)
