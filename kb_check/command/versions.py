"""What a script or an add-on needs of several Blenders: what breaks where, and the range that it runs in."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kb_check.command.configuration import Configuration
from kb_check.command.formats.json_document import span_as_json
from kb_check.command.formats.text import line_of, place_of
from kb_check.command.project import Project
from kb_check.command.run import Run
from kb_serve.locate import find_bases
from kb_serve.reader import BaseReader
from simworlds.counting import counted
from simworlds.errors import UserError
from simworlds.releases import minor_of, version_key

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from pathlib import Path

    from kb_check.command.cache import ResultCache
    from kb_check.command.project import Group
    from kb_check.command.report import FileReport, Report
    from kb_check.findings import Finding, Severity

_NARROWEST = 6  # columns of a version in the table


@dataclass(frozen=True, slots=True)
class FoundIn:
    """What is found in a file for some Blenders: the report and the finding of the first of them."""

    file: FileReport
    finding: Finding
    versions: tuple[str, ...]

    @property
    def message(self) -> str:
        """The finding's message; where it holds for several Blenders, it names none of them as its own."""
        message = self.finding.message
        return message if len(self.versions) == 1 else message.replace(f" in Blender {self.versions[0]}", "")


@dataclass(frozen=True, slots=True)
class VersionsReport:
    """The reports of one set of files for several Blenders, oldest first."""

    reports: tuple[Report, ...]

    @property
    def versions(self) -> list[str]:
        """The Blenders that were asked about: ``4.2``."""
        return [report.blender for report in self.reports]

    @property
    def faults(self) -> list[str]:
        """Sentences about what could not be checked."""
        return list(dict.fromkeys(fault for report in self.reports for fault in report.faults))

    def errors(self) -> dict[str, dict[str, int]]:
        """File → version → number of errors."""
        found: dict[str, dict[str, int]] = {}
        for report in self.reports:
            for file in report.files:
                count = sum(finding.severity == "error" for finding in file.findings)
                found.setdefault(file.name, {})[report.blender] = count
        return found

    def breaks(self) -> list[FoundIn]:
        """Everything that is an error in one version at least, by file and line."""
        return self._found("error")

    def warnings(self) -> list[FoundIn]:
        """Everything that is a warning in one version at least, by file and line: it may break there."""
        return self._found("warning")

    def _found(self, severity: Severity) -> list[FoundIn]:
        first: dict[tuple[Any, ...], tuple[FileReport, Finding]] = {}
        where: dict[tuple[Any, ...], list[str]] = {}
        for report in self.reports:
            for file, finding in report.findings:
                if finding.severity == severity:
                    key = file.name, finding.span, finding.rule
                    first.setdefault(key, (file, finding))
                    where.setdefault(key, []).append(report.blender)
        rows = [FoundIn(file, finding, tuple(where[key])) for key, (file, finding) in first.items()]
        return sorted(rows, key=lambda row: (row.file.name, row.finding.span.line, row.finding.span.column))

    def totals(self) -> dict[str, int]:
        """Version → number of errors in all files."""
        found = Counter(dict.fromkeys(self.versions, 0))
        for row in self.breaks():
            found.update(row.versions)
        return dict(found)

    def runs_in(self) -> list[str]:
        """The versions for which all files were checked, and nothing is wrong in them."""
        counts = self.errors().values()
        return [
            version for version in self.versions if counts and all(row.get(version) == 0 for row in counts)
        ]

    def verdict(self) -> str:
        """One sentence: the versions that it runs in, and where it breaks in the others. Nothing is said of those
        that some file could not be checked for.
        """
        good = self.runs_in()
        if len(good) == len(self.versions):
            return f"Nothing found that breaks in {_listed(good)}."
        parts = [f"Nothing found that breaks in {_ranges(good, self.versions)}"] if good else []
        parts += [
            f"breaks in {version}: {counted(count, 'error')}, first at {self._first(version)}"
            for version, count in self.totals().items()
            if count
        ]
        sentence = "; ".join(parts)
        return f"{sentence[:1].upper()}{sentence[1:]}." if parts else ""

    def _first(self, version: str) -> str:
        row = next(row for row in self.breaks() if version in row.versions)
        return line_of(row.file, row.finding)

    # Ways to write it.

    def text_lines(self) -> Iterator[str]:
        """A table of files and versions, what breaks where, what may break, and the verdict."""
        errors = self.errors()
        affected = {name: counts for name, counts in errors.items() if any(counts.values())}
        width = max((len(name) for name in affected), default=4)
        columns = {version: max(_NARROWEST, len(version) + 1) for version in self.versions}
        if affected:
            heads = "".join(version.rjust(columns[version]) for version in self.versions)
            yield f"{'file'.ljust(width)}{heads}"
            for name, counts in sorted(affected.items()):
                cells = "".join(
                    str(counts.get(version, "?") or "–").rjust(columns[version]) for version in self.versions
                )
                yield f"{name.ljust(width)}{cells}"
            yield ""
            yield from map(self._line, self.breaks())
            yield ""
        if warnings := self.warnings():
            yield f"{counted(len(warnings), 'warning')}:"
            yield from map(self._line, warnings)
            yield ""
        clean = len(errors) - len(affected)
        if affected and clean:
            yield f"{counted(clean, 'more file')} without errors."
        if verdict := self.verdict():
            yield verdict

    def _line(self, row: FoundIn) -> str:
        where = _ranges(row.versions, self.versions)
        return f"{place_of(row.file, row.finding)}: in {where}: [{row.finding.rule}] {' '.join(row.message.split())}"

    def as_json(self) -> dict[str, Any]:
        """The same for programs. Lines and columns count from 1."""
        return {
            "format": 1,
            "versions": self.versions,
            "runs_in": self.runs_in(),
            "errors": self.totals(),
            "files": [{"path": name, "errors": counts} for name, counts in sorted(self.errors().items())],
            "unchecked": self.faults,
            "breaks": [_as_json(row) for row in self.breaks()],
            "warnings": [_as_json(row) for row in self.warnings()],
        }


def check_versions(  # noqa: PLR0913 - what is checked, and how
    groups: Sequence[Group],
    versions: Iterable[str],
    home: Path,
    *,
    configuration: Configuration | None = None,
    faults: Sequence[str] = (),
    cache: ResultCache | None = None,
    jobs: int = 1,
    progress: Callable[[int, int], None] = lambda _done, _total: None,
) -> VersionsReport:
    """Checks files for several Blenders, whose bases are in ``home``.

    ``progress`` gets the number of bytes that are done and that there are, for each version anew. Raises UserError
    for what is no version and where there is no base.
    """
    bases = base_files(versions, home)
    reports: list[Report] = []
    for version, file in bases.items():
        reader = BaseReader(file)
        fingerprint = reader.meta["fingerprint"]
        reader.close()
        project = Project(file, fingerprint, cache, jobs)
        run = Run(project, configuration or Configuration(), list(groups), list(faults))
        reports.append(run.check(version, progress))
    return VersionsReport(tuple(reports))


def _as_json(row: FoundIn) -> dict[str, Any]:
    return {
        "path": row.file.name,
        **span_as_json(row.file.source, row.finding.span),
        "rule": row.finding.rule,
        "symbol": row.finding.symbol,
        "instead": list(row.finding.instead),
        "message": row.message,
        "versions": list(row.versions),
    }


def base_files(versions: Iterable[str], home: Path) -> dict[str, Path]:
    """Version → base, oldest first. Raises UserError where there is none."""
    wanted = {minor_of(version) for version in versions if version.strip()}
    if not wanted:
        raise UserError("Give at least one version of Blender, as 4.2,5.1.")
    return find_bases(sorted(wanted, key=version_key), home)


def _ranges(chosen: Sequence[str], known: Sequence[str]) -> str:
    """``4.2 to 4.5 and 5.2`` for some of the known versions."""
    runs: list[list[str]] = []
    for version in known:
        if version not in chosen:
            runs.append([])
        elif runs and runs[-1]:
            runs[-1].append(version)
        else:
            runs.append([version])
    texts: list[str] = []
    for run in filter(None, runs):
        texts += [f"{run[0]} to {run[-1]}"] if len(run) > 2 else run
    return _listed(texts)


def _listed(texts: Sequence[str]) -> str:
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} and {texts[-1]}"
