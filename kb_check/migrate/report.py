"""A migration written down: for people in MIGRATION.md and on the terminal, for programs as JSON."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from kb_check.migrate.plan import FileMigration
from kb_check.migrate.trial import Trial
from simworlds.counting import counted

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_check.migrate.change import Done
    from kb_check.migrate.chosen_versions import Versions


_TITLE = "# Migration to Blender "
_TABLE = ("| line | from | to | reason | source |", "| --- | --- | --- | --- | --- |")


def is_report(text: str) -> bool:
    """Whether a text begins as the reports do."""
    return text.startswith(_TITLE)


def joined(report: str, earlier: str) -> str:
    """A report with those of earlier runs below it; they alone where it says nothing new."""
    if not earlier or earlier == report or earlier.startswith(f"{report}\n{_TITLE}"):
        return earlier or report
    return f"{report}\n{earlier}"


@dataclass(slots=True)
class Migration:
    """What became of files and, where they were run, of the runs. ``notebooks`` are the names of those left as they
    are.
    """

    versions: Versions
    files: list[FileMigration] = field(default_factory=list[FileMigration])
    notebooks: list[str] = field(default_factory=list[str])
    trials: list[Trial] = field(default_factory=list[Trial])

    @property
    def is_done(self) -> bool:
        """Whether nothing is left to a person."""
        return not self.notebooks and not any(
            file.kept or any(decision.severity == "error" for decision in file.decisions)
            for file in self.files
        )


def markdown(migration: Migration) -> str:
    """The whole report: every change with its reason and source, and what a person must decide."""
    versions = migration.versions
    kept = f" (and still {', '.join(versions.keep)})" if versions.keep else ""
    lines = [f"{_TITLE}{versions.target}{kept}", "", summary(migration), ""]
    if migration.trials:
        lines += ["## Runs", "", *_runs(migration.trials), ""]
    decided = [file for file in migration.files if file.decisions or file.kept]
    if decided or migration.notebooks:
        lines += ["## To decide", ""]
        for file in decided:
            lines += [f"### {file.name}", "", *_decisions(file), ""]
        for line in notebook_lines(migration):
            lines += [f"- {_plain(line)}", ""]
    changed = [file for file in migration.files if file.changes]
    if changed:
        lines += ["## Changed", "", "Lines are those of the file as it was.", ""]
        for file in changed:
            lines += [f"### {file.name}", "", *_TABLE, *map(_row, file.changes), ""]
    return "\n".join(lines)


def _runs(trials: Sequence[Trial]) -> Iterator[str]:
    for trial in trials:
        yield f"- `{trial.name}`: {_plain(trial.verdict)}"
        yield from (f"  - {_plain(difference)}" for difference in trial.differences)


def _decisions(file: FileMigration) -> Iterator[str]:
    for one in file.decisions:
        how = f" {_plain(one.how)}" if one.how and one.how not in one.message else ""
        source = f" *({_plain(one.source)})*" if one.source else ""
        yield f"- line {one.line} (now {one.now}), {one.severity}: {_plain(one.message)}{how}{source}"
    for version, finding in file.kept:
        yield f"- now in line {finding.span.line}, in Blender {version}: {_plain(finding.message)}"


def _row(change: Done) -> str:
    guard = " (with a guard for older versions)" if change.guarded else ""
    reason = f"{_plain(change.reason)}{guard}"
    cells = (str(change.line), _code(change.before), _code(change.after), reason, _plain(change.source))
    return f"| {' | '.join(cells)} |"


def summary(migration: Migration) -> str:
    """One sentence about all files."""
    files, versions, notebooks = migration.files, migration.versions, migration.notebooks
    changes = sum(len(file.changes) for file in files)
    changed = sum(bool(file.changes) for file in files)
    kinds = Counter(decision.severity for file in files for decision in file.decisions)
    left = kinds["error"] + sum(len(file.kept) for file in files)
    parts = [f"{counted(changes, 'change')} in {counted(changed, 'file')}"]
    if left:
        parts.append(f"{counted(left, 'place')} to decide")
    elif migration.is_done and not kinds["warning"]:
        parts.append("nothing is left to decide")
    if kinds["warning"]:
        parts.append(f"{counted(kinds['warning'], 'warning')} to look at")
    if notebooks:
        parts.append(
            f"{counted(len(notebooks), 'notebook')} left as {'it is' if len(notebooks) == 1 else 'they are'}"
        )
    if versions.without_base:
        names = ", ".join(versions.without_base)
        parts.append(f"there is no base of {names}, so that not all that breaks there is known")
    return f"{'; '.join(parts)}."


def decision_lines(migration: Migration) -> Iterator[str]:
    """What a person must decide, a line each, with the place in the new text."""
    for file in migration.files:
        for one in file.decisions:
            how = f" {one.how}" if one.how and one.how not in one.message else ""
            source = f" [{one.source}]" if one.source else ""
            yield f"{file.name}:{one.now}: {one.severity}[{one.rule}] {' '.join(one.message.split())}{how}{source}"
        for version, finding in file.kept:
            yield f"{file.name}:{finding.span.line}: in Blender {version}: {' '.join(finding.message.split())}"
    yield from notebook_lines(migration)


def notebook_lines(migration: Migration) -> Iterator[str]:
    """What to do about the notebooks, a line each."""
    versions = migration.versions
    kept = [version for version in versions.keep if version not in versions.without_base]
    command = f"simworlds check --blender {','.join((*kept, versions.target))}"
    for name in migration.notebooks:
        yield f"{name} is a notebook: migrate leaves it as it is. `{command} {name}` says what breaks in it."


def as_json(migration: Migration) -> dict[str, Any]:
    """The same for programs. Lines count from 1: ``line`` in the original, ``now`` in the new text."""
    versions = migration.versions
    return {
        "format": 1,
        "to": versions.target,
        "keep": list(versions.keep),
        "without_base": list(versions.without_base),
        "notebooks": migration.notebooks,
        "files": [
            {
                "path": file.name,
                "changed": file.new != file.old,
                "changes": [asdict(change) for change in file.changes],
                "decisions": [asdict(decision) for decision in file.decisions],
                "kept": [
                    {"blender": version, "line": one.span.line, "rule": one.rule, "message": one.message}
                    for version, one in file.kept
                ],
            }
            for file in migration.files
        ],
        "runs": [
            {
                "path": trial.name,
                "verdict": trial.verdict,
                "before": {"blender": trial.before.version, "error": trial.before.error}
                if trial.before
                else None,
                "after": {"blender": trial.after.version, "error": trial.after.error},
                "differences": list(trial.differences),
            }
            for trial in migration.trials
        ],
    }


def _plain(text: str) -> str:
    """Text within a line of a table."""
    return " ".join(text.split()).replace("|", "\\|")


def _code(text: str) -> str:
    text = _plain(text)
    if not text:
        return "(nothing)"
    fence = "``" if "`" in text else "`"
    return f"{fence} {text} {fence}" if "`" in text else f"`{text}`"
