"""The command ``simworlds migrate``."""

from __future__ import annotations

import sys
import tempfile
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kb_check.command.code_path import CodePath
from kb_check.text.source import NOTEBOOK
from simworlds.errors import UserError
from simworlds.settings import home_folder

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_check.command.project import Group, LoadedFile
    from kb_check.migrate.plan import FileMigration
    from kb_check.migrate.report import Migration
    from kb_check.migrate.trial import Trial
    from kb_check.text.source import Source

_DECIDE, _FAILED, _INTERRUPTED = 1, 2, 130
_REPORT = "MIGRATION.md"
_STDIN = "-"


@click.command()
@click.argument("paths", nargs=-1, required=True, type=CodePath())
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
@click.option("--diff", is_flag=True, help="Print a diff alone; what is left to decide goes to stderr.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--write", is_flag=True, help=f"Write the files, and {_REPORT} beside them.")
@click.option(
    "--run",
    is_flag=True,
    help="Run the scripts in --from (if it is here) and in --to, and compare the scenes.",
)
def migrate(paths: tuple[Path, ...], **choices: Any) -> None:
    """Rewrite scripts and add-ons for another Blender.

    PATHS are files and folders; - reads standard input and prints what becomes of it.

    What is certain is changed; the rest is listed, with the reason, the place and the source. Without --write nothing
    is changed, and the changes are shown. Notebooks stay as they are. --run runs the code: use it only on code that
    you trust.

    Exit code 0: done. 1: a person must decide something. 2: something could not be read or written.
    """
    if choices["diff"] and choices["as_json"]:
        raise click.UsageError("--diff and --json exclude each other.")
    if _is_stdin(paths) and (len(paths) > 1 or choices["write"] or choices["run"]):
        raise click.UsageError("- (standard input) goes with no other path, nor with --write or --run.")
    try:
        code = _migrate(paths, choices)
    except UserError as error:
        click.echo(f"Error: {error}", err=True)
        code = _FAILED
    except KeyboardInterrupt:
        click.echo("Interrupted. Files that were not written yet are unchanged.", err=True)
        code = _INTERRUPTED
    sys.exit(code)


def _is_stdin(paths: Sequence[Path]) -> bool:
    return any(str(path) == _STDIN for path in paths)


@dataclass
class _Work:
    """One run: the files that can be migrated, by name, the outcome, and what could not be read or written."""

    migration: Migration
    loaded: dict[str, LoadedFile] = field(default_factory=dict[str, "LoadedFile"])
    sources: dict[str, Source] = field(default_factory=dict[str, "Source"])
    faults: list[str] = field(default_factory=list[str])


def _migrate(paths: tuple[Path, ...], choices: dict[str, Any]) -> int:
    from kb_check.migrate.chosen_versions import read_versions  # noqa: PLC0415 - not for --help
    from kb_check.migrate.report import Migration, markdown  # noqa: PLC0415
    from kb_serve.in_use import tell_of_other  # noqa: PLC0415

    versions = read_versions(choices["target"], choices["source"], choices["keep"], home_folder())
    if not choices["target"]:
        tell_of_other(versions.blender)
    report = _report_place(paths[0]) if choices["write"] else None
    work = _Work(Migration(versions))
    _migrate_groups(work, _groups(paths, work.faults))
    if choices["run"]:
        work.migration.trials = _trials(work, paths)
    if report and work.migration.files:
        _write(work, report, markdown(work.migration))
    _print(work, choices, is_filter=_is_stdin(paths))
    for fault in work.faults:
        click.echo(f"Error: {fault}", err=True)
    if work.faults:
        return _FAILED
    differ = any(trial.after.error or trial.differences for trial in work.migration.trials)
    return _DECIDE if differ or not work.migration.is_done else 0


def _print(work: _Work, choices: dict[str, Any], *, is_filter: bool) -> None:
    """Prints the outcome; beside a diff, or code that another program reads, the words go to stderr."""
    from kb_check.command.formats.json_document import dump  # noqa: PLC0415 - not for --help
    from kb_check.migrate.report import as_json, decision_lines, summary  # noqa: PLC0415

    migration = work.migration
    if choices["as_json"]:
        click.echo(dump(as_json(migration)))
        return
    beside = choices["diff"] or is_filter
    if is_filter and not choices["diff"]:
        _print_code(work)
    elif beside or not choices["write"]:
        _print_diff(work)
    for trial in migration.trials:
        click.echo(f"{trial.name}: {trial.verdict}", err=beside)
        for difference in trial.differences:
            click.echo(f"  {difference}", err=beside)
    for line in decision_lines(migration):
        click.echo(line, err=beside)
    if migration.files:
        click.echo(summary(migration), err=beside)
    if not choices["write"] and not beside and any(file.changes for file in migration.files):
        click.echo("Nothing was written: --write does.")


def _groups(paths: Sequence[Path], faults: list[str]) -> list[Group]:
    """The files that the project's configuration leaves in, read; standard input is one."""
    from kb_check.command.configuration import read_configuration  # noqa: PLC0415 - not for --help
    from kb_check.command.inputs import read_inputs  # noqa: PLC0415

    reads_stdin = _is_stdin(paths)  # which goes with no other path
    configuration = read_configuration(paths[0] if paths[0].is_dir() else paths[0].parent)
    named = () if reads_stdin else paths
    inputs = read_inputs(named, configuration, reads_stdin=reads_stdin, gitignore=configuration.gitignore)
    for warning in inputs.left_out:
        click.echo(f"Warning: {warning}", err=True)
    faults += inputs.faults
    return inputs.groups


def _migrate_groups(work: _Work, groups: Sequence[Group]) -> None:
    from kb_check.checker import Checker  # noqa: PLC0415 - not for --help
    from kb_check.migrate.place import version_of  # noqa: PLC0415
    from kb_check.migrate.plan import Migrator  # noqa: PLC0415
    from kb_check.text.reading import read_source  # noqa: PLC0415

    versions = work.migration.versions
    written_for = version_of(versions.source) if versions.source else None
    with ExitStack() as stack:
        checker = stack.enter_context(Checker(versions.base))
        migrator = Migrator(checker, versions.kept(stack), written_for)
        for group in groups:
            sources = {file.name: read_source(file.data, file.name) for file in group}
            wanted = {file.name for file in group if file.wanted}
            for name in sorted(wanted):
                if name.endswith(NOTEBOOK):
                    work.migration.notebooks.append(name)
                elif sources[name].fault:
                    work.faults.append(f"{name} cannot be read: {sources[name].fault}.")
            can = {name for name in wanted if not name.endswith(NOTEBOOK) and not sources[name].fault}
            beside = {name: source.text for name, source in sources.items() if name not in can}
            work.loaded.update({file.name: file for file in group if file.name in can})
            work.sources.update({name: sources[name] for name in can})
            if can:
                texts = {name: sources[name].text for name in sorted(can)}
                work.migration.files += migrator.migrate(texts, beside)


def _print_diff(work: _Work) -> None:
    from kb_check.text.fixes import print_diff  # noqa: PLC0415 - not for --json

    for result in work.migration.files:
        if (data := _bytes(work, result)) is not None:
            print_diff(result.name, work.loaded[result.name].data, data)


def _print_code(work: _Work) -> None:
    """Prints the text of standard input as it is now."""
    from simworlds.terminal.exact import print_exact  # noqa: PLC0415 - for standard input alone

    for result in work.migration.files:
        if (data := _bytes(work, result)) is not None:
            print_exact(data, work.sources[result.name].encoding)


def _bytes(work: _Work, result: FileMigration) -> bytes | None:
    """A file as it is to be written; None where its encoding lacks a letter of the new text, which is a fault."""
    if result.new == result.old:
        return work.loaded[result.name].data
    try:
        return result.new.encode(work.sources[result.name].encoding)
    except UnicodeEncodeError:
        fault = f"{result.name} cannot be migrated: its encoding lacks a letter of the new text."
        if fault not in work.faults:
            work.faults.append(fault)
        return None


def _report_place(first: Path) -> Path:
    """Where the report goes. Raises UserError where somebody else's file is there."""
    from kb_check.migrate.report import is_report  # noqa: PLC0415 - only with --write

    place = (first if first.is_dir() else first.parent) / _REPORT
    if place.exists() and not is_report(_text(place)):
        raise UserError(
            f"{place} is there already, and not a report of this command, which would take its place. Rename it, and "
            "run this again. Nothing was written."
        )
    return place


def _text(place: Path) -> str:
    try:
        return place.read_text(encoding="utf-8", errors="replace") if place.exists() else ""
    except OSError as error:
        raise UserError(f"{place} cannot be read: {error.strerror or error}.") from None


def _write(work: _Work, place: Path, report: str) -> None:
    from kb_check.migrate.report import joined  # noqa: PLC0415
    from kb_check.text.fixes import write_fixed  # noqa: PLC0415 - only with --write
    from simworlds.files import write_whole  # noqa: PLC0415

    for result in work.migration.files:
        data = _bytes(work, result)
        if data is None or result.new == result.old:
            continue
        try:
            write_fixed(Path(result.name), work.loaded[result.name].data, data)
        except OSError as error:
            work.faults.append(f"{result.name} cannot be written: {error.strerror or error}.")
    try:
        write_whole(place, joined(report, _text(place)))
    except OSError as error:
        work.faults.append(f"{place} cannot be written: {error.strerror or error}.")
    else:
        click.echo(f"Report: {place}", err=True)


def _trials(work: _Work, paths: Sequence[Path]) -> list[Trial]:
    """Runs every path that is a script, or the folder of an add-on, as it was and as it is now."""
    from kb_check.migrate.trial import runtime_at_hand, try_out  # noqa: PLC0415 - only with --run

    home, versions = home_folder(), work.migration.versions
    target, source = versions.target, versions.source
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
        elif path.exists() and path.suffix != NOTEBOOK:
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
    for result in work.migration.files if new else ():
        inside = Path(result.name).resolve()
        if inside.is_relative_to(path.resolve()) and (data := _bytes(work, result)) is not None:
            (copy / inside.relative_to(path.resolve()) if path.is_dir() else copy).write_bytes(data)
    return copy
