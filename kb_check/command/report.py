"""What a run of the check has found, for whatever writes it down."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from kb_check.text.fixes import is_fixable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.findings import Finding
    from kb_check.text.source import Source


@dataclass(frozen=True)
class FileReport:
    """The findings in one file, and the source that their places are in."""

    name: str
    source: Source
    findings: list[Finding]

    @cached_property
    def can_change(self) -> bool:
        """Whether fixes can be applied: not in notebooks, and not to what Python cannot parse."""
        readable = all(finding.rule != "syntax-error" for finding in self.findings)
        return readable and not self.source.cells and not self.source.fault

    @cached_property
    def lines(self) -> list[str]:
        """The lines as Python counts them, with their ends."""
        return self.source.lines


@dataclass(frozen=True, slots=True)
class Report:
    """The findings of all files, for one Blender.

    ``faults`` are sentences about what could not be checked, ``fixed`` the number of findings that were mended.
    """

    blender: str
    files: list[FileReport]
    faults: list[str] = field(default_factory=list)
    fixed: int = 0

    @property
    def findings(self) -> Iterator[tuple[FileReport, Finding]]:
        """Every finding with its file."""
        return ((file, finding) for file in self.files for finding in file.findings)

    def fixable(self, *, unsafe: bool) -> int:
        """How many findings could be mended by fixes that are sure, or by those that are not (``unsafe``)."""
        return sum(
            finding.fix is not None and finding.fix.sure is not unsafe and is_fixable(finding, unsafe=unsafe)
            for file, finding in self.findings
            if file.can_change
        )
