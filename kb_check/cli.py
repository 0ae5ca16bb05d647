"""The command ``simworlds check``."""

from __future__ import annotations

import gc
import sys
import time
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from simworlds.errors import UserError
from simworlds.operating_system import SYSTEM
from simworlds.settings import cache_folder, home_folder

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from kb_check.cache import ResultCache
    from kb_check.configuration import Configuration
    from kb_check.project import Group
    from kb_check.report import Report

_FOUND, _UNCHECKED = 1, 2
_PATIENCE_SECONDS = 2.0
_STDIN = "-"
_STDIN_NAME = "<stdin>"


@click.command()
@click.argument("paths", nargs=-1, type=click.Path(path_type=Path, allow_dash=True))
@click.option(
    "--blender", metavar="VERSIONS", help="Blender versions, as 5.1 or 4.5,5.1. Default: the one in use."
)
@click.option("--rules", metavar="LIST", help="The rules to check, separated by commas. Default: all.")
@click.option("--json", "form", flag_value="json", help="Print JSON.")
@click.option("--sarif", "form", flag_value="sarif", help="Print SARIF 2.1.0.")
@click.option("--github", "form", flag_value="github", help="Print annotations for GitHub Actions.")
@click.option("--fix", is_flag=True, help="Apply the fixes that are sure.")
@click.option("--diff", is_flag=True, help="Print what --fix would change, and change nothing.")
@click.option("--unsafe-fixes", is_flag=True, help="With --fix and --diff: the other fixes, too.")
@click.option("--no-gitignore", is_flag=True, help="In folders: check what git leaves out, too.")
@click.option("--jobs", type=click.IntRange(1, 256), help="Number of processes. Default: one a core.")
@click.option("--no-cache", is_flag=True, help="Check everything again.")
def check(paths: tuple[Path, ...], form: str | None, **choices: Any) -> None:
    """Check Python code against the API of a Blender, without running it.

    PATHS are files and folders (default: this folder); - reads standard input. Options that hold for a project stand
    in its pyproject.toml, under [tool.simworlds.check].

    For several versions a table says what breaks where, and which of them the code runs in.

    Exit code 0: nothing found. 1: errors were found. 2: something could not be checked.
    """
    if choices["unsafe_fixes"] and not (choices["fix"] or choices["diff"]):
        raise click.UsageError("--unsafe-fixes goes with --fix or --diff.")
    if choices["fix"] and choices["diff"]:
        raise click.UsageError("--fix and --diff exclude each other.")
    # The process ends soon: collecting garbage would only take time.
    gc.disable()
    try:
        code = _check(paths or (Path(),), form, choices)
    except UserError as error:
        click.echo(f"Error: {error}", err=True)
        code = _UNCHECKED
    sys.exit(code)


def _check(paths: tuple[Path, ...], form: str | None, choices: dict[str, Any]) -> int:
    configuration = _configuration(paths, choices)
    written = choices["blender"].split(",") if choices["blender"] else configuration.blender
    versions = list(dict.fromkeys(version.strip() for version in written if version.strip()))
    several = len(versions) > 1
    if several and (choices["fix"] or choices["diff"] or form == "github"):
        names = ", ".join(versions)
        raise click.UsageError(
            f"For several versions ({names}) there are only the table, --json and --sarif."
        )
    base = None if several else _base(versions[0] if versions else None)
    faults: list[str] = []
    run = _Inputs(configuration, _groups(paths, configuration, faults, choices), faults, choices)
    with _cache(choices) as cache:
        reports = (
            _one_version(run, base, cache, form) if base else _several_versions(run, versions, cache, form)
        )
    told = dict.fromkeys(fault for report in reports for fault in report.faults)
    for fault in told:
        click.echo(f"Error: {fault}", err=True)
    if told:
        return _UNCHECKED
    fails = any(configuration.fails(finding) for report in reports for _, finding in report.findings)
    return _FOUND if fails else 0


@dataclass(frozen=True, slots=True)
class _Inputs:
    """What is checked, and how; ``faults`` are about what could not be read."""

    configuration: Configuration
    groups: list[Group]
    faults: list[str]
    choices: dict[str, Any]

    @property
    def jobs(self) -> int:
        return self.choices["jobs"] or SYSTEM.cores()


def _one_version(inputs: _Inputs, base: Path, cache: ResultCache | None, form: str | None) -> list[Report]:
    """Checks for one Blender, with fixes, and prints the report."""
    from kb_check.project import Project  # noqa: PLC0415 - not for --help
    from kb_check.run import Run  # noqa: PLC0415
    from kb_serve.reader import BaseReader  # noqa: PLC0415

    with closing(BaseReader(base)) as reader:
        meta = reader.meta
    project = Project(base, meta["fingerprint"], cache, inputs.jobs)
    run = Run(project, inputs.configuration, inputs.groups, inputs.faults)
    unsafe = inputs.choices["unsafe_fixes"]
    with _progress() as progress:
        if inputs.choices["fix"]:
            run.fix(unsafe=unsafe)
            run.write()
        report = run.check(meta["minor"], progress)
        if inputs.choices["diff"]:
            run.fix(unsafe=unsafe)
    if inputs.choices["diff"]:
        run.print_diff()
    else:
        _print(report, form)
    return [report]


def _several_versions(
    inputs: _Inputs, versions: list[str], cache: ResultCache | None, form: str | None
) -> list[Report]:
    """Checks for several Blenders, and prints what breaks where."""
    from kb_check.versions import check_versions  # noqa: PLC0415 - for several versions alone

    with _progress() as progress:
        report = check_versions(
            inputs.groups,
            versions,
            home_folder(),
            configuration=inputs.configuration,
            faults=inputs.faults,
            cache=cache,
            jobs=inputs.jobs,
            progress=progress,
        )
    if form == "json":
        from kb_check.formats.json_format import dump  # noqa: PLC0415 - one of them is used

        click.echo(dump(report.as_json()))
    elif form == "sarif":
        from kb_check.formats.sarif import as_sarif  # noqa: PLC0415

        click.echo(as_sarif(*report.reports))
    else:
        for line in report.text_lines():
            click.echo(line)
    return list(report.reports)


def _configuration(paths: tuple[Path, ...], choices: dict[str, Any]) -> Configuration:
    """What the project of the first path wants, and what the options say."""
    from dataclasses import replace  # noqa: PLC0415 - not for --help

    from kb_check.configuration import known_rules, read_configuration  # noqa: PLC0415

    first = paths[0]
    configuration = read_configuration(first if first.is_dir() else first.parent)
    if choices["rules"]:
        names = [name.strip() for name in choices["rules"].split(",")]
        configuration = replace(configuration, rules=known_rules(names, "--rules"))
    return configuration


def _base(version: str | None) -> Path:
    from kb_serve.bases import Bases  # noqa: PLC0415 - not for --help

    with closing(Bases(home_folder(), default=version)) as bases:
        return bases.file()


def _groups(
    paths: tuple[Path, ...], configuration: Configuration, faults: list[str], choices: dict[str, Any]
) -> list[Group]:
    """The files, read; standard input is one."""
    from kb_check.files import find_files  # noqa: PLC0415 - not for --help
    from kb_check.project import LoadedFile  # noqa: PLC0415
    from kb_check.run import load  # noqa: PLC0415
    from kb_check.source import MOST_BYTES  # noqa: PLC0415

    named = [path for path in paths if str(path) != _STDIN]
    gitignore = configuration.gitignore and not choices["no_gitignore"]
    found = find_files(named, configuration.exclude, configuration.folder, gitignore=gitignore)
    faults += found.faults
    groups = load(found.groups, faults)
    if len(named) < len(paths):
        if choices["fix"]:
            raise click.UsageError("--fix cannot change standard input. Use --diff.")
        data = sys.stdin.buffer.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            faults.append(f"Standard input is larger than {MOST_BYTES >> 20} MiB.")
        else:
            groups.append((LoadedFile(_STDIN_NAME, data),))
    return groups


@contextmanager
def _cache(choices: dict[str, Any]) -> Generator[ResultCache | None]:
    """The results of earlier runs, unless they are not wanted."""
    from kb_check.cache import ResultCache  # noqa: PLC0415 - not for --help

    if choices["no_cache"]:
        yield None
        return
    with ResultCache(cache_folder(home_folder()) / "check.sqlite") as cache:
        yield cache


@contextmanager
def _progress() -> Generator[Callable[[int, int], None]]:
    """Shows on a terminal how far the check is, once it takes longer than two seconds."""
    from simworlds.terminal.lines import is_terminal  # noqa: PLC0415 - not for --help

    if not is_terminal(sys.stderr):
        yield lambda _done, _total: None
        return
    from simworlds.terminal.progress import shown_progress  # noqa: PLC0415 - not for --help

    began = time.monotonic()
    with shown_progress() as shown:

        def progress(done: int, total: int) -> None:
            if time.monotonic() - began >= _PATIENCE_SECONDS:
                shown("Checking", done, total)

        yield progress


def _print(report: Report, form: str | None) -> None:
    if form == "json":
        from kb_check.formats.json_format import as_json  # noqa: PLC0415 - one of them is used

        click.echo(as_json(report))
    elif form == "sarif":
        from kb_check.formats.sarif import as_sarif  # noqa: PLC0415

        click.echo(as_sarif(report))
    elif form == "github":
        from kb_check.formats.github import github_lines  # noqa: PLC0415

        for line in github_lines(report):
            click.echo(line)
    else:
        _print_text(report)


def _print_text(report: Report) -> None:
    from kb_check.formats.text import text_lines  # noqa: PLC0415 - not for --json

    if not sys.stdout.isatty():
        for line in text_lines(report):
            click.echo("".join(text for text, _ in line))
        return
    from rich.text import Text  # noqa: PLC0415 - only for a terminal

    from simworlds.terminal.console import Console  # noqa: PLC0415

    console = Console(sys.stdout)
    for line in text_lines(report):
        console.print(Text.assemble(*line), soft_wrap=True)
