"""The command ``simworlds migrate``."""

from __future__ import annotations

import json
import sys
import tempfile
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from simworlds.errors import UserError
from simworlds.settings import built_bases, home_folder

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_check.migrate.kept_version import KeptVersion
    from kb_check.migrate.plan import FileMigration
    from kb_check.migrate.trial import Trial
    from kb_check.project import Group, LoadedFile
    from kb_check.source import Source

_DECIDE, _FAILED, _INTERRUPTED = 1, 2, 130
_REPORT = "MIGRATION.md"


@click.command()
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--to", "target", metavar="VERSION", help="The Blender to migrate to. Default: the one in use.")
@click.option(
    "--from",
    "source",
    metavar="VERSION",
    help="The Blender that the code was written for. Default: told from the code.",
)
@click.option(
    "--keep", metavar="VERSIONS", default="", help="Older Blenders that it must still run in, as 4.2,4.5."
)
@click.option("--diff", "form", flag_value="diff", help="Print the changes as a diff, and nothing else.")
@click.option("--json", "form", flag_value="json", help="Print JSON.")
@click.option("--write", is_flag=True, help=f"Write the files, and {_REPORT} beside them.")
@click.option(
    "--run",
    is_flag=True,
    help="Run the scripts in --from (if it is here) and in --to, and compare the scenes.",
)
def migrate(paths: tuple[Path, ...], form: str | None, **choices: Any) -> None:
    """Rewrite scripts and add-ons for another Blender.

    What is certain is changed; the rest is listed, with the reason, the place and the source. Without --write nothing
    is changed, and the changes are shown. --run runs the code: use it only on code that you trust.

    Exit code 0: done. 1: a person must decide something. 2: something could not be read or written.
    """
    try:
        code = _migrate(paths, form, choices)
    except UserError as error:
        click.echo(f"Error: {error}", err=True)
        code = _FAILED
    except KeyboardInterrupt:
        click.echo("Interrupted. Files that were not written yet are unchanged.", err=True)
        code = _INTERRUPTED
    sys.exit(code)


@dataclass
class _Work:
    """The files of one run: those that can be migrated, by name, and the outcome."""

    loaded: dict[str, LoadedFile] = field(default_factory=dict[str, "LoadedFile"])
    sources: dict[str, Source] = field(default_factory=dict[str, "Source"])
    results: list[FileMigration] = field(default_factory=list["FileMigration"])
    faults: list[str] = field(default_factory=list[str])


def _migrate(paths: tuple[Path, ...], form: str | None, choices: dict[str, Any]) -> int:
    from kb_check.files import find_files  # noqa: PLC0415 - not for --help
    from kb_check.migrate.report import as_json, decision_lines, markdown, summary  # noqa: PLC0415
    from kb_check.run import load  # noqa: PLC0415

    found = find_files(paths)
    work = _Work(faults=found.faults)
    groups = load(found.groups, work.faults)
    target = _migrated(work, groups, choices)
    trials = _trials(work, paths, target, choices["source"]) if choices["run"] else []
    keep = [version for version in choices["keep"].split(",") if version.strip()]
    if choices["write"]:
        _write(work, paths[0], markdown(target, keep, work.results, trials))
    if form == "json":
        click.echo(
            json.dumps(as_json(target, work.results, trials), indent=2).encode("utf-8", "replace").decode()
        )
    elif form == "diff" or not choices["write"]:
        click.echo(_diff(work), nl=False)
    if form is None:
        for trial in trials:
            click.echo(f"{trial.name}: {trial.verdict}")
            for difference in trial.differences:
                click.echo(f"  {difference}")
        for line in decision_lines(work.results):
            click.echo(line)
        click.echo(summary(work.results))
        if not choices["write"] and any(result.changes for result in work.results):
            click.echo("Nothing was written: --write does.")
    for fault in work.faults:
        click.echo(f"Error: {fault}", err=True)
    if work.faults:
        return _FAILED
    left = any(one.severity == "error" for result in work.results for one in result.decisions)
    return _DECIDE if left or any(trial.after.error or trial.differences for trial in trials) else 0


def _migrated(work: _Work, groups: Sequence[Group], choices: dict[str, Any]) -> str:
    """Migrates all groups; the version that they were migrated to."""
    from kb_check.checker import Checker  # noqa: PLC0415 - not for --help
    from kb_check.migrate.place import version_of  # noqa: PLC0415
    from kb_check.migrate.plan import Migrator  # noqa: PLC0415
    from kb_check.reading import read_source  # noqa: PLC0415
    from kb_check.versions import base_files  # noqa: PLC0415
    from kb_serve.bases import Bases  # noqa: PLC0415
    from simworlds.releases import minor_of  # noqa: PLC0415

    home = home_folder()
    if choices["target"]:
        (base,) = base_files([choices["target"]], home).values()
    else:
        bases = Bases(home)
        base = bases.file()
        bases.close()
    written_for = version_of(minor_of(choices["source"])) if choices["source"] else None
    with ExitStack() as stack:
        checker = stack.enter_context(Checker(base))
        migrator = Migrator(checker, _kept(stack, choices["keep"]), written_for)
        for group in groups:
            sources = {file.name: read_source(file.data, file.name) for file in group}
            wanted = {file.name for file in group if file.wanted}
            for name in sorted(wanted):
                if sources[name].cells:
                    work.faults.append(f"{name} is a notebook: notebooks are not migrated.")
                elif sources[name].fault:
                    work.faults.append(f"{name} cannot be read: {sources[name].fault}.")
            can = {name for name in wanted if not sources[name].cells and not sources[name].fault}
            beside = {
                name: source.text for name, source in sources.items() if name not in can and not source.cells
            }
            texts = {name: sources[name].text for name in sorted(can)}
            work.loaded.update({file.name: file for file in group if file.name in can})
            work.sources.update({name: sources[name] for name in can})
            work.results += migrator.migrate(texts, beside)
        return checker.names.version


def _kept(stack: ExitStack, text: str) -> list[KeptVersion]:
    from kb_check.checker import Checker  # noqa: PLC0415 - not for --help
    from kb_check.migrate.kept_version import KeptVersion  # noqa: PLC0415
    from kb_check.migrate.place import version_of  # noqa: PLC0415
    from simworlds.releases import minor_of  # noqa: PLC0415

    bases = built_bases(home_folder())
    versions = [minor_of(version) for version in text.split(",") if version.strip()]
    return [
        KeptVersion(
            version_of(version), stack.enter_context(Checker(bases[version])) if version in bases else None
        )
        for version in versions
    ]


def _diff(work: _Work) -> str:
    from kb_check.fixes import unified_diff  # noqa: PLC0415 - not for --json

    changed = (result for result in work.results if result.new != result.old)
    return "".join(unified_diff(result.name, result.old, result.new) for result in changed)


def _bytes(work: _Work, result: FileMigration) -> bytes | None:
    """A file as it is to be written; None where its encoding lacks a letter of the new text."""
    try:
        return result.new.encode(work.sources[result.name].encoding)
    except UnicodeEncodeError:
        return None


def _write(work: _Work, first: Path, report: str) -> None:
    from kb_check.fixes import write_fixed  # noqa: PLC0415 - only with --write
    from simworlds.files import write_whole  # noqa: PLC0415

    for result in work.results:
        if result.new == result.old:
            continue
        data = _bytes(work, result)
        if data is None:
            work.faults.append(f"{result.name} was not written: its encoding lacks a letter of the new text.")
            continue
        try:
            write_fixed(Path(result.name), work.loaded[result.name].data, data)
        except OSError as error:
            work.faults.append(f"{result.name} cannot be written: {error.strerror or error}.")
    place = (first if first.is_dir() else first.parent) / _REPORT
    try:
        write_whole(place, report)
    except OSError as error:
        work.faults.append(f"{place} cannot be written: {error.strerror or error}.")
    click.echo(f"Report: {place}", err=True)


def _trials(work: _Work, paths: Sequence[Path], target: str, source: str | None) -> list[Trial]:
    """Runs every path that is a script, or the folder of an add-on, as it was and as it is now."""
    from kb_check.migrate.trial import runtime_at_hand, try_out  # noqa: PLC0415 - only with --run

    home = home_folder()
    new = runtime_at_hand(target, home)
    if new is None:
        raise UserError(
            f"--run needs Blender {target}, which is not here. Build its base: simworlds kb build {target}"
        )
    old = runtime_at_hand(source, home) if source else None
    if source and old is None:
        click.echo(f"Blender {source} is not here: the code is run in {target} only.", err=True)
    trials: list[Trial] = []
    with tempfile.TemporaryDirectory(prefix="simworlds-") as folder:
        for number, path in enumerate(_runnable(paths)):
            before = _laid_out(work, path, Path(folder) / f"{number}" / "before", new=False)
            after = _laid_out(work, path, Path(folder) / f"{number}" / "after", new=True)
            trials.append(try_out(str(path), before, after, old, new))
    return trials


def _runnable(paths: Sequence[Path]) -> list[Path]:
    """Scripts and packages that were named; of other folders the scripts and packages that lie in them."""
    found: list[Path] = []
    for path in paths:
        if path.is_dir() and not (path / "__init__.py").exists():
            found += sorted(
                one for one in path.iterdir() if one.suffix == ".py" or (one / "__init__.py").exists()
            )
        else:
            found.append(path)
    return found


def _laid_out(work: _Work, path: Path, folder: Path, *, new: bool) -> Path:
    """A copy of a script or package, as it was or with the changes."""
    import shutil  # noqa: PLC0415 - only with --run

    folder.mkdir(parents=True)
    copy = folder / path.resolve().name
    if path.is_dir():
        shutil.copytree(path, copy, ignore=shutil.ignore_patterns("__pycache__", ".*"))
    else:
        shutil.copy(path, copy)
    for result in work.results if new else ():
        inside = Path(result.name).resolve()
        if inside.is_relative_to(path.resolve()) and (data := _bytes(work, result)) is not None:
            (copy / inside.relative_to(path.resolve()) if path.is_dir() else copy).write_bytes(data)
    return copy
