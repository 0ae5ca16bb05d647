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

from kb_check.command.code_path import CodePath
from simworlds.errors import UserError
from simworlds.operating_system import SYSTEM
from simworlds.settings import cache_folder, home_folder

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

    from kb_check.command.cache import ResultCache
    from kb_check.command.configuration import Configuration
    from kb_check.command.inputs import Inputs
    from kb_check.command.report import Report
    from kb_check.command.run import Run

_FOUND, _UNCHECKED = 1, 2
_PATIENCE_SECONDS = 2.0
_STDIN = Path("-")
_FORMS = ("json", "sarif", "github", "diff")
_OF_ONE_VERSION = ("fix", "diff", "github")


@click.command()
@click.argument("paths", nargs=-1, type=CodePath())
@click.option(
    "--blender",
    metavar="VERSIONS",
    multiple=True,
    help="Blender versions, as 5.1 or 4.5,5.1. Default: the one in use.",
)
@click.option(
    "--rules", metavar="LIST", multiple=True, help="The rules to check, separated by commas. Default: all."
)
@click.option("--json", is_flag=True, help="Print JSON.")
@click.option("--sarif", is_flag=True, help="Print SARIF 2.1.0.")
@click.option("--github", is_flag=True, help="Print annotations for GitHub Actions.")
@click.option("--fix", is_flag=True, help="Apply the fixes that are sure. With -: print the mended text.")
@click.option("--diff", is_flag=True, help="Print what --fix would change, and change nothing.")
@click.option("--unsafe-fixes", is_flag=True, help="With --fix and --diff: the other fixes, too.")
@click.option(
    "--stdin-filename",
    metavar="FILE",
    type=CodePath(),
    help="The file that standard input is checked as: what its package registers is known.",
)
@click.option("--no-gitignore", is_flag=True, help="In folders: check what git leaves out, too.")
@click.option("--jobs", type=click.IntRange(1, 256), help="Number of processes. Default: one a core.")
@click.option("--no-cache", is_flag=True, help="Check everything again.")
@click.option("--list-rules", is_flag=True, help="List the rules, and check nothing.")
@click.option("--explain", metavar="RULE", help="Print what a rule finds and why, and check nothing.")
def check(paths: tuple[Path, ...], **choices: Any) -> None:
    """Check Python code against the API of a Blender, without running it.

    PATHS are files and folders (default: this folder); - reads standard input. Options that hold for a project stand
    in its pyproject.toml, under [tool.simworlds.check].

    For several versions a table says what breaks where, and which of them the code runs in.

    Exit code 0: no errors were found. 1: errors were found. 2: something could not be checked.
    """
    form = _form(choices)
    if choices["unsafe_fixes"] and not (choices["fix"] or form == "diff"):
        raise click.UsageError("--unsafe-fixes goes with --fix or --diff.")
    if choices["stdin_filename"]:
        paths = paths or (_STDIN,)
        if _STDIN not in paths:
            raise click.UsageError("--stdin-filename goes with -, which reads standard input.")
    if choices["fix"] and _STDIN in paths and len(paths) > 1:
        raise click.UsageError("--fix - prints one mended text: give no other path.")
    # The process ends soon: collecting garbage would only take time.
    gc.disable()
    try:
        if choices["list_rules"] or choices["explain"] is not None:
            _tell_rules(choices["explain"])
            return
        code = _check(paths or (Path(),), form, choices)
    except UserError as error:
        click.echo(f"Error: {error}", err=True)
        code = _UNCHECKED
    sys.exit(code)


def _form(choices: dict[str, Any]) -> str | None:
    """In which form the findings are printed: None for text."""
    chosen = [form for form in _FORMS if choices[form]]
    excluding = [*chosen, *(["fix"] if choices["fix"] and "diff" in chosen else [])]
    if len(excluding) > 1:
        raise click.UsageError(f"{' and '.join(f'--{name}' for name in excluding)} exclude each other.")
    return chosen[0] if chosen else None


def _tell_rules(name: str | None) -> None:
    """Prints what there is to know of one rule, or the list of all."""
    from kb_check.command.rule_texts import rule_lines, rule_page  # noqa: PLC0415 - seldom
    from simworlds.terminal.markdown import print_markdown  # noqa: PLC0415

    if name is None:
        click.echo("\n".join(rule_lines()))
    else:
        print_markdown(rule_page(name))


def _check(paths: tuple[Path, ...], form: str | None, choices: dict[str, Any]) -> int:
    configuration = _configuration(choices["stdin_filename"] or paths[0], choices)
    versions = _versions(configuration, choices)
    base = _base(versions[0] if versions else None) if len(versions) < 2 else None
    run = _Checking(configuration, _inputs(paths, configuration, choices), form, choices)
    with _cache(choices) as cache:
        reports = _one_version(run, base, cache) if base else _several_versions(run, versions, cache)
    for warning in run.inputs.left_out:
        click.echo(f"Warning: {warning}", err=True)
    told = dict.fromkeys(fault for report in reports for fault in report.faults)
    for fault in told:
        click.echo(f"Error: {fault}", err=True)
    if told:
        return _UNCHECKED
    fails = any(configuration.fails(finding) for report in reports for _, finding in report.findings)
    return _FOUND if fails else 0


def _versions(configuration: Configuration, choices: dict[str, Any]) -> tuple[str, ...]:
    """The Blenders that are asked for; none for the one in use."""
    from kb_check.command.configuration import versions_in  # noqa: PLC0415 - not for --help

    given = choices["blender"]
    versions = versions_in(given) if given else configuration.blender
    if given and not versions:
        raise click.UsageError("--blender names no version: write it as 5.1 or 4.5,5.1.")
    wanted = [f"--{name}" for name in _OF_ONE_VERSION if choices[name]]
    if len(versions) > 1 and wanted:
        where = "--blender" if given else f"{configuration.file}"
        raise click.UsageError(
            f"{wanted[0]} is for one version, and {where} names several ({', '.join(versions)}). "
            f"Give one, as --blender {versions[-1]}."
        )
    return versions


@dataclass(frozen=True, slots=True)
class _Checking:
    """What is checked, and how."""

    configuration: Configuration
    inputs: Inputs
    form: str | None
    choices: dict[str, Any]

    @property
    def jobs(self) -> int:
        return self.choices["jobs"] or SYSTEM.cores()


def _one_version(checking: _Checking, base: Path, cache: ResultCache | None) -> list[Report]:
    """Checks for one Blender, with fixes, and prints the report."""
    from kb_check.command.formats.printing import print_report  # noqa: PLC0415 - not for --help
    from kb_check.command.project import Project  # noqa: PLC0415
    from kb_check.command.run import Run  # noqa: PLC0415
    from kb_serve.in_use import tell_of_other  # noqa: PLC0415
    from kb_serve.reader import BaseReader  # noqa: PLC0415

    with closing(BaseReader(base)) as reader:
        meta = reader.meta
    inputs, choices = checking.inputs, checking.choices
    if not (choices["blender"] or checking.configuration.blender):
        tell_of_other(meta["blender"])
    project = Project(base, meta["fingerprint"], cache, checking.jobs)
    run = Run(project, checking.configuration, inputs.groups, inputs.faults)
    unsafe = choices["unsafe_fixes"]
    is_filter = choices["fix"] and inputs.typed is not None
    with _progress() as progress:
        if choices["fix"]:
            run.fix(unsafe=unsafe)
            if not is_filter:
                run.write()
        report = run.check(meta["minor"], progress)
        if choices["diff"]:
            run.fix(unsafe=unsafe)
    if choices["diff"]:
        run.print_diff()
    elif is_filter:
        _print_mended(run, inputs.typed or b"")
        print_report(report, checking.form, sys.stderr)
    else:
        print_report(report, checking.form, sys.stdout)
    return [report]


def _print_mended(run: Run, typed: bytes) -> None:
    """Prints what fixes have made of standard input, which is all that was to be checked, if it was."""
    from simworlds.terminal.exact import print_exact  # noqa: PLC0415 - seldom

    print_exact(next((file.data for group in run.groups for file in group if file.wanted), typed))


def _several_versions(
    checking: _Checking, versions: Sequence[str], cache: ResultCache | None
) -> list[Report]:
    """Checks for several Blenders, and prints what breaks where."""
    from kb_check.command.versions import check_versions  # noqa: PLC0415 - for several versions alone

    with _progress() as progress:
        report = check_versions(
            checking.inputs.groups,
            versions,
            home_folder(),
            configuration=checking.configuration,
            faults=checking.inputs.faults,
            cache=cache,
            jobs=checking.jobs,
            progress=progress,
        )
    if checking.form == "json":
        from kb_check.command.formats.json_document import dump  # noqa: PLC0415 - one of them is used

        click.echo(dump(report.as_json()))
    elif checking.form == "sarif":
        from kb_check.command.formats.sarif import as_sarif  # noqa: PLC0415

        click.echo(as_sarif(*report.reports))
    else:
        for line in report.text_lines():
            click.echo(line)
    return list(report.reports)


def _configuration(first: Path, choices: dict[str, Any]) -> Configuration:
    """What the project of the first path wants, and what the options say."""
    from dataclasses import replace  # noqa: PLC0415 - not for --help

    from kb_check.command.configuration import known_rules, read_configuration  # noqa: PLC0415

    configuration = read_configuration(first if first.is_dir() else first.parent)
    if choices["rules"]:
        names = [name.strip() for text in choices["rules"] for name in text.split(",")]
        configuration = replace(configuration, rules=known_rules(names, "--rules"))
    return configuration


def _base(version: str | None) -> Path:
    from kb_serve.bases import Bases  # noqa: PLC0415 - not for --help

    with closing(Bases(home_folder(), default=version)) as bases:
        return bases.file()


def _inputs(paths: tuple[Path, ...], configuration: Configuration, choices: dict[str, Any]) -> Inputs:
    from kb_check.command.inputs import read_inputs  # noqa: PLC0415 - not for --help

    return read_inputs(
        [path for path in paths if path != _STDIN],
        configuration,
        reads_stdin=_STDIN in paths,
        stdin_name=choices["stdin_filename"],
        gitignore=configuration.gitignore and not choices["no_gitignore"],
    )


@contextmanager
def _cache(choices: dict[str, Any]) -> Generator[ResultCache | None]:
    """The results of earlier runs, unless they are not wanted."""
    from kb_check.command.cache import ResultCache  # noqa: PLC0415 - not for --help

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
