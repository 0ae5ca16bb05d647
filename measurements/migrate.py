"""Migrates the add-ons and script templates that an older Blender brings, and runs them in newer ones.

``python -m measurements --only migrate`` needs the oldest Blender that has a base in the measured home and brings
add-ons of many authors (2.93 to 4.1 do), the newer Blenders, and their bases. Its smallest add-ons are registered and
taken off again, its templates are run: in it, in each newer Blender as they are, and there as ``simworlds migrate``
rewrote them. What does not run in the Blender that brings it is left out: it needs a window, or another program.

*Predicted*: whether a run in the newer Blender ends without an error, told from the text alone: it does if the check
finds no error where a run comes by.
"""

from __future__ import annotations

import ast
import shutil
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_build.base_file import read_meta
from kb_build.usage.scripts import read_script
from kb_check.checker import Checker
from kb_check.migrate.plan import Migrator
from kb_check.migrate.trial import run_in, runtime_at_hand
from kb_check.registered.package import paths_in_package
from kb_check.running.reach import RunReach
from measurements.blender_scripts import scripts_folder
from measurements.report import ReportPart, TargetFigure
from measurements.setting import BLENDER, say
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_check.checker import Read
    from kb_check.migrate.plan import FileMigration
    from measurements.setting import Setting
    from simworlds.sandbox.runtime import Runtime

NEWER = ("4.2", "4.5", BLENDER)  # of those that scripts are run in
_ADDONS, _TEMPLATES = "addons", "templates_py"
_MOST_ADDONS = 60
_JOBS = 2
_HEADER = ("Blender", "of", "predicted right", "run as they are", "run migrated", "mended", "broken")


@dataclass(frozen=True, slots=True)
class Sample:
    """An add-on or a script: what a run is given, its name, and its Python files."""

    name: str
    path: Path
    files: tuple[Path, ...]


@dataclass(slots=True)
class Outcome:
    """One sample in one newer Blender; errors are empty where it runs. ``changes`` is how many were made."""

    name: str
    predicted: str
    before: str
    changes: int = 0
    after: str = ""


@dataclass(slots=True)
class Results:
    """The outcomes by Blender."""

    outcomes: dict[str, list[Outcome]] = field(default_factory=dict[str, "list[Outcome]"])

    def all(self) -> Iterator[tuple[str, Outcome]]:
        """(Blender, outcome) of each."""
        yield from ((version, each) for version, held in self.outcomes.items() for each in held)


def samples(scripts: Path, folder: Path, most: int = _MOST_ADDONS) -> list[Sample]:
    """The smallest add-ons and all templates below a Blender's folder of scripts, copied into ``folder``.

    An add-on of one file becomes a package: both are registered as Blender does it.
    """
    found: list[Sample] = []
    for path in sorted((scripts / _ADDONS).iterdir()):
        copy = folder / _ADDONS / path.stem
        if path.name.startswith("_"):
            continue
        if path.is_dir() and (path / "__init__.py").is_file():
            shutil.copytree(path, copy, ignore=shutil.ignore_patterns("__pycache__"))
        elif path.suffix == ".py":
            copy.mkdir(parents=True)
            shutil.copy(path, copy / "__init__.py")
        else:
            continue
        found.append(Sample(path.stem, copy, tuple(sorted(copy.rglob("*.py")))))
    found.sort(key=lambda sample: sum(file.stat().st_size for file in sample.files))
    shutil.copytree(scripts / _TEMPLATES, folder / _TEMPLATES)
    templates = sorted((folder / _TEMPLATES).glob("*.py"))
    return [*found[:most], *(Sample(path.stem, path, (path,)) for path in templates)]


def predicted_error(checker: Checker, sample: Sample) -> str:
    """The first error that a run of a sample would come to, told from its text; empty for none."""
    names = {str(file): read_script(file) for file in sample.files}
    paths = paths_in_package(names)
    reads = checker.read_files({paths[name]: code for name, code in names.items()})
    package = checker.package(reads.values())
    for path, read in reads.items():
        reach = _reach(read)
        for finding in checker.check(read, package):
            if finding.severity == "error" and reach.comes_to(finding.span.line, finding.span.column):
                return f"{path}:{finding.span.line} {finding.message}"
    return ""


def _reach(read: Read) -> RunReach:
    """What a run comes to where Blender calls ``register`` and ``unregister`` after it has read the file."""
    calls = ast.parse("register()\nunregister()").body
    return RunReach(ast.Module([*read.tree.body, *calls], []), read.analysis)


def migrated(migrator: Migrator, sample: Sample, folder: Path) -> tuple[Path, list[FileMigration]]:
    """A sample's migrated copy, and what happened to its files."""
    files = migrator.migrate({str(file): read_script(file) for file in sample.files})
    copy = folder / sample.path.name
    if sample.path.is_dir():
        shutil.copytree(
            sample.path, copy, ignore=shutil.ignore_patterns("__pycache__")
        )  # being written, perhaps
    else:
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(sample.path, copy)
    for file in files:
        place = copy / Path(file.name).relative_to(sample.path) if sample.path.is_dir() else copy
        place.write_text(file.new, encoding="utf-8", newline="")
    return copy, files


def compare(
    found: Sequence[Sample], checker: Checker, runtime: Runtime, folder: Path, written_for: tuple[int, int]
) -> list[Outcome]:
    """Predicts, runs, migrates and runs again each sample in one newer Blender."""
    migrator = Migrator(checker, written_for=written_for)
    outcomes: list[Outcome] = []
    again: list[tuple[Outcome, Path]] = []
    with ThreadPoolExecutor(_JOBS) as pool:
        errors = _errors(pool, runtime, [sample.path for sample in found])
        for sample in found:  # meanwhile
            copy, files = migrated(migrator, sample, folder)
            outcome = Outcome(
                sample.name, predicted_error(checker, sample), "", sum(len(f.changes) for f in files)
            )
            outcomes.append(outcome)
            if outcome.changes:
                again.append((outcome, copy))
        for outcome, error in zip(outcomes, errors, strict=True):
            outcome.before = outcome.after = error
        for (outcome, _), error in zip(
            again, _errors(pool, runtime, [path for _, path in again]), strict=True
        ):
            outcome.after = error
    return outcomes


def _errors(pool: ThreadPoolExecutor, runtime: Runtime, paths: Iterable[Path]) -> Iterator[str]:
    """How the runs of some paths end, in their order; each is started at once, or when there is room."""

    def error(path: Path) -> str:
        return run_in(runtime, path).error

    return pool.map(error, paths)


def source_of(bases: Sequence[Path]) -> tuple[str, Path] | None:
    """The oldest Blender, among those of some bases, that brings add-ons of many authors: version, scripts."""
    for base in sorted(bases, key=lambda path: version_key(path.stem)):
        scripts = scripts_folder(base)
        if scripts is not None and (scripts / _ADDONS).is_dir():
            return read_meta(base)["minor"], scripts
    return None


def measure(setting: Setting) -> ReportPart:
    """Runs everything; ``quick`` leaves it out."""
    if setting.quick:
        return ReportPart("migrate", skipped=("left out by --quick",))
    bases = {
        path.stem.removeprefix("blender-"): path for path in setting.base.parent.glob("blender-*.sqlite")
    }
    source = source_of(list(bases.values()))
    old = runtime_at_hand(source[0], setting.home) if source else None
    if source is None or old is None:
        return ReportPart("migrate", skipped=("no Blender with a base here brings add-ons of many authors",))
    version, scripts = source
    results, skipped = Results(), list[str]()
    major, minor = version_key(version)[:2]
    with tempfile.TemporaryDirectory(prefix="simworlds-") as name, ExitStack() as stack:
        folder = Path(name)
        folder.chmod(0o755)
        found = samples(scripts, folder / "old")
        say(f"migrate: running {len(found)} samples in Blender {version}")
        with ThreadPoolExecutor(_JOBS) as pool:
            errors = list(_errors(pool, old, [sample.path for sample in found]))
        runs = [sample for sample, error in zip(found, errors, strict=True) if not error]
        for newer in NEWER:
            runtime = runtime_at_hand(newer, setting.home)
            if runtime is None or newer not in bases:
                skipped.append(f"Blender {newer} or its base is not here")
                continue
            say(f"migrate: {len(runs)} samples of Blender {version} in {newer}")
            checker = stack.enter_context(Checker(bases[newer]))
            results.outcomes[newer] = compare(runs, checker, runtime, folder / newer, (major, minor))
    left_out = [f"{sample.name}: {error}" for sample, error in zip(found, errors, strict=True) if error]
    return _report(results, version, skipped, left_out)


def _report(results: Results, version: str, skipped: Sequence[str], left_out: Sequence[str]) -> ReportPart:
    rows = tuple(_row(newer, outcomes) for newer, outcomes in results.outcomes.items())
    agree = [(not each.predicted) == (not each.before) for _, each in results.all()]
    broken = [f"{newer}: {each.name}: {each.after}" for newer, each in results.all() if _is_broken(each)]
    wrong = [
        f"{newer}: {each.name}: predicted {each.predicted or 'to run'}; {each.before or 'runs'}"
        for newer, each in results.all()
        if (not each.predicted) != (not each.before)
    ]
    fail = [f"{newer}: {each.name}: {each.after}" for newer, each in results.all() if each.after]
    note = f"{len(agree)} runs of Blender {version}'s add-ons and templates"
    figures = (
        TargetFigure("migrate_predicted", sum(agree) / max(1, len(agree)), note),
        TargetFigure("migrate_broken", len(broken), note),
    )
    title = f"Add-ons and templates of Blender {version}, registered or run in newer ones"
    data = {
        "broken": broken, "predicted wrong": wrong, "still fail": fail, "fail where they come from": left_out,
    }  # fmt: skip
    return ReportPart("migrate", figures, (Table(title, _HEADER, rows),), tuple(skipped), data)


def _is_broken(outcome: Outcome) -> bool:
    return bool(outcome.after) and not outcome.before


def _row(newer: str, outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    counts = Counter[str]()
    for each in outcomes:
        counts["right"] += (not each.predicted) == (not each.before)
        counts["before"] += not each.before
        counts["after"] += not each.after
        counts["mended"] += bool(each.before) and not each.after
        counts["broken"] += _is_broken(each)
    names = ("right", "before", "after", "mended", "broken")
    return newer, f"{len(outcomes)}", *(f"{counts[name]}" for name in names)
