"""The commands ``simworlds kb …``: build, look into, check and compare knowledge bases."""

from __future__ import annotations

import functools
import json
import sys
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import click

from kb_build.errors import KBBuildError
from simworlds.errors import UserError
from simworlds.how_to_get_bases import how_to_get
from simworlds.operating_system import SYSTEM
from simworlds.own_command import own_command
from simworlds.releases import ROLES, USUAL
from simworlds.settings import (
    BASE_URL_VARIABLE,
    base_path,
    built_bases,
    corpora_folder,
    home_folder,
    summaries_path,
)
from simworlds.terminal.finite_range import FiniteRange
from simworlds.terminal.output_file import OutputFile
from simworlds.terminal.termination import unwind_on_termination

if TYPE_CHECKING:
    from collections.abc import Callable

    from kb_build.blender.extract_reader import Extract
    from kb_build.pipeline import BuildReport
    from simworlds.terminal.progress import Progress

_OTHERS = {"pack": "kb_serve.packs.cli"}
_PATH = click.Path(path_type=Path)
_P = ParamSpec("_P")
_T = TypeVar("_T")


def reports_errors(command: Callable[_P, _T]) -> Callable[_P, _T]:
    """Turns errors into one message and the exit code 2."""

    @functools.wraps(command)
    def run(*args: _P.args, **kwargs: _P.kwargs) -> _T:
        try:
            return command(*args, **kwargs)
        except UserError as error:
            click.echo(f"Error: {error}", err=True)
            sys.exit(2)

    return run


def replaces_files_whole(command: Callable[_P, _T]) -> Callable[_P, _T]:
    """Has a user who interrupts the command told that the files which it would have replaced are the old ones."""

    @functools.wraps(command)
    def run(*args: _P.args, **kwargs: _P.kwargs) -> _T:
        try:
            return command(*args, **kwargs)
        except KeyboardInterrupt:
            raise KeyboardInterrupt("The old files are unchanged.") from None

    return run


class _KbGroup(click.Group):
    """The group, with the commands of parts that are built on this one: they stand here by name, as it must not
    import them.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The names, sorted."""
        return sorted([*super().list_commands(ctx), *_OTHERS])

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of that name; that of another part is loaded now."""
        if cmd_name not in _OTHERS:
            return super().get_command(ctx, cmd_name)
        command = getattr(import_module(_OTHERS[cmd_name]), cmd_name)
        assert isinstance(command, click.Command)
        return command


@click.group(cls=_KbGroup)
def kb() -> None:
    """Build, look into, check and compare knowledge bases, and write packs of them."""


def _roles(_context: click.Context, _parameter: click.Parameter, value: str | None) -> frozenset[str]:
    roles = frozenset(role.strip() for role in (value or "").split(",") if role.strip())
    if unknown := roles - set(ROLES):
        raise click.BadParameter(f"{', '.join(sorted(unknown))}: give manual, guides or both (manual,guides)")
    return roles


@kb.command()
@click.argument("version", required=False)
@click.option("--blender-exe", type=_PATH, help="Ask this Blender instead of a bpy package.")
@click.option("--manual", type=_PATH, help="The manual: a folder or archive, RST or HTML.")
@click.option("--guides", type=_PATH, help="The API guides: a folder or archive, RST or HTML.")
@click.option("--no-pages", is_flag=True, help="Leave out manual and guides.")
@click.option(
    "--summaries",
    type=click.Choice(["shipped", "extractive", "claude", "none"]),
    default="shipped",
    show_default=True,
    help="How pages are summarised: by what ships with SimWorlds; by sentences of their own; by Claude where nothing "
    "ships, which needs ANTHROPIC_API_KEY and costs money.",
)
@click.option("--max-cost", type=FiniteRange(min=0), help="The most that claude may cost, in US dollars.")
@click.option("--model", help="The model that claude's summaries are made with.")
@click.option("--require", callback=_roles, metavar="ROLES", help="Fail without: manual, guides or both.")
@click.option("--jobs", type=click.IntRange(1, 64), default=2, show_default=True, help="Processes at most.")
@click.option(
    "--force",
    is_flag=True,
    help="Build even if nothing has changed, or if the new base lacks pages that the old one has.",
)
@click.option("--offline", is_flag=True, help="Download no documentation.")
@click.option("--fresh", is_flag=True, help="Download documentation again that was downloaded before.")
@click.option("--out", type=OutputFile(), help="Write the base to this file.")
@reports_errors
@replaces_files_whole
def build(version: str | None, **given: Any) -> None:
    """Build a Blender's knowledge base.

    VERSION is 5.1 or 5.1.2; without it, the Blender of this environment, else 5.1. Nothing is
    done when nothing has changed.
    """
    if not SYSTEM.limits_processes:
        raise KBBuildError(
            "a base cannot be built on Windows, where the processes that read documentation cannot be held to limits. "
            f"Fetch a ready one ({own_command()} kb fetch {version or USUAL} --from URL|FILE), or build it in WSL"
        )
    from kb_build import pipeline  # noqa: PLC0415 - other commands do without
    from simworlds.terminal.progress import shown_progress  # noqa: PLC0415

    unwind_on_termination()
    options = pipeline.BuildOptions(
        blender_exe=given["blender_exe"],
        manual=given["manual"],
        guides=given["guides"],
        corpora=corpora_folder(),
        pages=not given["no_pages"],
        summaries=given["summaries"],
        max_cost=given["max_cost"],
        model=given["model"],
        require=given["require"],
        jobs=given["jobs"],
        force=given["force"],
        offline=given["offline"],
        fresh=given["fresh"],
        output=given["out"].expanduser().absolute() if given["out"] else None,
    )
    with shown_progress() as progress:
        report = pipeline.build(version, options=options, home=home_folder(), progress=progress)
    _tell(report)


def _tell(report: BuildReport) -> None:
    from kb_build.base_report import build_lines, warning_lines  # noqa: PLC0415 - only here

    click.echo("\n".join(build_lines(report)))
    sys.stdout.flush()
    for line in warning_lines(report):
        click.echo(line, err=True)


@kb.command()
@click.argument("version", required=False)
@click.option("--json", "as_json", is_flag=True, help="All facts about the base, as JSON.")
@reports_errors
def info(version: str | None, as_json: bool) -> None:
    """Show what is in a base.

    VERSION is 5.1, or a base's path; without it, all bases are listed.
    """
    from kb_build.base_report import base_facts, base_lines, bases_lines  # noqa: PLC0415 - only here

    home = home_folder()
    if version is None:
        bases = [base_facts(path) for path in built_bases(home).values()]
        click.echo(json.dumps(bases, indent=2) if as_json else "\n".join(bases_lines(bases, home)))
    else:
        bases = [base_facts(_base(version))]
        if as_json:
            click.echo(json.dumps(bases[0], indent=2, ensure_ascii=False))
        elif "fault" not in bases[0]:
            click.echo("\n".join(base_lines(bases[0])))
    if faults := [facts["fault"] for facts in bases if "fault" in facts]:
        raise KBBuildError("\n".join(faults))


def _base(version: str) -> Path:
    """The file of a version's base, or the file itself where a path is given."""
    try:
        return base_path(home_folder(), version)
    except UserError:
        path = Path(version)
        if path.is_file() or path.suffix == ".sqlite":
            return path
        raise KBBuildError(
            f"{version!r} is neither a Blender version, as 5.1, nor the file of a base."
        ) from None


@kb.command()
@click.argument("version", required=False)
@click.option(
    "--reference",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="Identifiers that must resolve: a Sphinx objects.inv, or a text file with one on each line.",
)
@click.option(
    "--live/--no-live", default=True, help="Whether to start Blender to compare values (default: yes)."
)
@click.option("--json", "as_json", is_flag=True, help="The findings as JSON.")
@reports_errors
def verify(version: str | None, reference: Path | None, live: bool, as_json: bool) -> None:
    """Check that a base is whole and true.

    What it tells of new things is compared with the Blender that it was built from, if that is at hand.
    VERSION is 5.1, or a base's path (default: the newest base). The exit code is 1 when something is wrong.
    """
    from kb_build.verify import verify_base  # noqa: PLC0415 - only here
    from simworlds.terminal.progress import shown_progress  # noqa: PLC0415

    bases = list(built_bases(home_folder()).values())
    if version is None and not bases:
        raise KBBuildError(f"There is no knowledge base yet. {how_to_get(USUAL)}")
    base = _base(version) if version else bases[-1]
    with shown_progress(in_logs=False) as progress:
        progress(f"Checking {base.name}", 0, None)
        verification = verify_base(base, reference, live=live)
    click.echo(json.dumps(verification.as_json(), indent=2) if as_json else "\n".join(verification.lines()))
    sys.exit(0 if verification.sound else 1)


@kb.command("export")
@click.argument("version")
@click.option("--output", type=OutputFile(), help="The file to write (default: blender-X.Y.tar.xz, here).")
@reports_errors
@replaces_files_whole
def export_command(version: str, output: Path | None) -> None:
    """Pack a base into one file that others can fetch.

    VERSION is 5.1, or a base's path. The file holds the base without this machine's paths, a manifest (version, size,
    SHA-256, licences and whom to name) and a notice; the same base gives the same bytes.
    """
    from kb_build.base_file import read_meta  # noqa: PLC0415 - only here
    from kb_build.ready.export import export_base, ready_name  # noqa: PLC0415
    from simworlds.terminal.progress import shown_progress  # noqa: PLC0415

    unwind_on_termination()
    base = _base(version)
    target = output or Path(ready_name(read_meta(base).get("minor", "")))
    with shown_progress() as progress:
        exported = export_base(base, target.expanduser().absolute(), progress=progress)
    click.echo(
        f"{exported.path}: Blender {exported.manifest.blender}, {exported.size / 1e6:.1f} MB\n"
        f"Fetch it: {own_command()} kb fetch {exported.manifest.minor} --from '{target}#sha256={exported.sha256}'\n"
        "Pass its notice on with it: the manual's text is CC-BY-SA-4.0, what comes from Blender GPL-3.0-or-later."
    )


@kb.command("fetch")
@click.argument("version")
@click.option(
    "--from",
    "source",
    envvar=BASE_URL_VARIABLE,
    show_envvar=True,
    required=True,
    metavar="URL|PATH",
    help="A file that kb export has written, its address, or the folder or address that it lies in; #sha256=… behind "
    "it pins the file.",
)
@reports_errors
@replaces_files_whole
def fetch_command(version: str, source: str) -> None:
    """Fetch a ready base instead of building it.

    A download that broke off is continued. A file that differs in one byte from what it should be is refused.
    """
    from kb_build.ready.fetch import fetch_base  # noqa: PLC0415 - only here
    from simworlds.terminal.progress import shown_progress  # noqa: PLC0415

    unwind_on_termination()
    with shown_progress() as progress:
        fetched = fetch_base(version, source, home=home_folder(), progress=progress)
    click.echo(f"{fetched.path}: Blender {fetched.manifest.blender}, {fetched.manifest.size / 1e6:.1f} MB")
    for row in fetched.manifest.licences:
        click.echo(f"  {row.licence}: {row.part} ({row.attribution})")


@kb.command("diff")
@click.argument("old")
@click.argument("new")
@click.option("--prefix", default="", help="Only symbols below this path: bpy.types.Mesh, bpy.ops, …")
@click.option("--interface", is_flag=True, help="Include panels, menus and other interface classes.")
@click.option("--limit", type=click.IntRange(min=1), help="Show at most this many lines of each kind.")
@click.option("--json", "as_json", is_flag=True, help="The differences as JSON.")
@reports_errors
def diff_command(old: str, new: str, **given: Any) -> None:
    """Compare two Blenders' APIs.

    Lists what NEW has added, removed and changed since OLD. Each is a version, or the path of a Blender
    executable. Blender itself is asked, not its base: a bpy package that is not at hand is installed, 350 MB.
    """
    from kb_build.versions.diff import diff, format_diff, is_under  # noqa: PLC0415 - only here
    from simworlds.terminal.progress import shown_progress  # noqa: PLC0415

    as_json = given["as_json"]
    if as_json and given["limit"]:
        raise click.UsageError("--limit shortens what is shown; --json gives all. Leave out one of them.")
    unwind_on_termination()
    with shown_progress() as progress:
        extracts = _ask(old, progress), _ask(new, progress)
        differences = diff(*extracts, interface=given["interface"])
    if prefix := given["prefix"]:
        if not any(is_under(symbol.path, prefix) for extract in extracts for symbol in extract.symbols):
            raise KBBuildError(
                f"neither Blender {differences.old} nor {differences.new} has {prefix}. Write it as bpy.types.Mesh"
            )
        differences = differences.under(prefix)
    click.echo(
        json.dumps(differences.to_json(), indent=2)
        if as_json
        else format_diff(differences, limit=given["limit"])
    )


def _ask(name: str, progress: Progress) -> Extract:
    """The API of a Blender that is named by its version or by its executable."""
    from kb_build.blender.extract_reader import read_extract  # noqa: PLC0415 - only here
    from kb_build.blender.extractor import extract_api  # noqa: PLC0415
    from simworlds.sandbox.runtime import find_runtime  # noqa: PLC0415

    home, executable = home_folder(), Path(name)
    if executable.is_file():
        runtime = find_runtime(None, home=home, blender_exe=executable, progress=progress)
    else:
        runtime = find_runtime(name, home=home, progress=progress)
    return read_extract(extract_api(runtime, home=home, progress=progress))


@kb.command()
@click.argument("versions", nargs=-1)
@click.option("--blender-exe", "blender_exes", type=_PATH, multiple=True, help="Another Blender to include.")
@click.option(
    "--stubs", type=_PATH, help="A folder with type stubs of versions that have no bpy package, each in X.Y."
)
@click.option(
    "--out", type=OutputFile(), help="The file to write (default: the one that SimWorlds came with)."
)
@click.option("--force", is_flag=True, help="Write even if the old file has more symbols.")
@reports_errors
@replaces_files_whole
def history(
    versions: tuple[str, ...],
    blender_exes: tuple[Path, ...],
    stubs: Path | None,
    out: Path | None,
    force: bool,
) -> None:
    """Write the history file: which version has which symbol.

    Asks VERSIONS (default: all that have a bpy package, or none with --stubs); each is installed on first use, 350 MB.
    Stubs are the packages fake-bpy-module-X.Y, unpacked; the report tells how well they agree with Blender.
    """
    from kb_build.base_report import history_lines  # noqa: PLC0415
    from kb_build.versions.history import HISTORY_FILE  # noqa: PLC0415 - only here
    from kb_build.versions.history_builder import build_history  # noqa: PLC0415
    from simworlds.releases import releases  # noqa: PLC0415
    from simworlds.terminal.progress import shown_progress  # noqa: PLC0415

    unwind_on_termination()
    wanted = versions or (() if stubs else tuple(release.minor for release in releases()))
    with shown_progress() as progress:
        report = build_history(
            wanted,
            home=home_folder(),
            output=out or HISTORY_FILE,
            blender_exes=blender_exes,
            stubs=stubs,
            force=force,
            progress=progress,
        )
    click.echo("\n".join(history_lines(report)))


@kb.command("merge-summaries")
@click.argument("file", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@reports_errors
@replaces_files_whole
def merge_summaries(file: Path) -> None:
    """Merge a colleague's summaries into yours.

    Adds the summaries in FILE that are new, so that they are not paid for twice.
    """
    from kb_build.summaries.store import SummaryStore  # noqa: PLC0415 - only here

    store = SummaryStore(summaries_path(home_folder()))
    new = store.merge(file)
    click.echo(f"{new:,} summaries are new, {store.count():,} in all, in {store.path}")
