"""The commands ``simworlds make``, ``edit``, ``demo``, ``replay``, ``resume``, ``runs`` and ``show``."""

from __future__ import annotations

import os
import signal
import sys
import threading
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from agents.roles.names import ROLES
from simworlds.llm.apis.providers import PROVIDERS, TOLD_DEFAULTS
from simworlds.operating_system import SYSTEM
from simworlds.own_command import own_command
from simworlds.terminal.finite_range import FiniteRange
from simworlds.terminal.options import EXECUTABLE, SANDBOX, VERSION, combine

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from types import FrameType

    from agents.loop.session import Ended, RunSession, Stop

    Command = TypeVar("Command", bound=Callable[..., Any])

_IN_A_PIPE = 5000  # columns: as many as a row may need, so that each run stays one line
EXITS = {"done": 0, "aborted": 1, "failed": 2, "stopped": 3}
_LIBRARY = click.Path(exists=True, file_okay=False, resolve_path=True, path_type=Path)
_FOLDER = click.Path(file_okay=False, resolve_path=True, path_type=Path)
_FILE = click.Path(exists=True, dir_okay=False, resolve_path=True, path_type=Path)


class _RunFolder(click.Path):
    """The folder of a run: its path, or the name that ``simworlds runs`` lists it by."""

    def __init__(self) -> None:
        super().__init__(file_okay=False, resolve_path=True, path_type=Path)

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Any:  # as of click.Path
        """The path; of a bare name that is no run in the current folder, that of the run of this name."""
        from agents.views.run_list import run_named  # noqa: PLC0415 - not for --help

        return super().convert(run_named(str(value)) or value, param, ctx)


_limits = combine(
    click.option(
        "--max-cost",
        type=FiniteRange(0),
        metavar="USD",
        help="Stop before the whole run costs more; holds until another is given.",
    ),
    click.option("--max-minutes", type=FiniteRange(0, min_open=True), help="Stop after this time."),
    click.option("--quiet", is_flag=True, help="Print only the outcome."),
)
_model = combine(
    click.option(
        "--provider",
        type=click.Choice(PROVIDERS),
        default=PROVIDERS[0],
        show_default=True,
        help="The API: Messages, or chat completions as of OpenAI, Ollama, vLLM.",
    ),
    click.option(
        "--model",
        metavar="NAME",
        help=f"The model for all roles.  [default: {TOLD_DEFAULTS}]",
    ),
    click.option(
        "--price", metavar="IN/OUT", help="Dollars per million tokens, of models that are in no list."
    ),
    click.option(
        "--role-model", multiple=True, metavar="ROLE=NAME", help=f"Another model for {', '.join(ROLES)}."
    ),
)
_RENDER = (
    click.option(
        "--render-minutes",
        type=FiniteRange(0, min_open=True),
        help="Time for a film; its samples and size are fitted to it.  [default: what --max-minutes leaves, else 20]",
    ),
    click.option(
        "--samples", type=click.IntRange(1), help="Samples of the rendering, instead of the plan's."
    ),
)
_blender = combine(
    click.option("--run", "root", type=_FOLDER, help="Folder of the run.  [default: a new one]"),
    VERSION,
    EXECUTABLE,
    click.option("--read", type=_FOLDER, multiple=True, help="A folder that Blender may read, as of assets."),
    SANDBOX,
    *_RENDER,
)
_assets = combine(
    click.option("--assets", type=_LIBRARY, help="Your asset library, which the plan may draw on."),
)
_ablations = combine(
    click.option("--no-verifier", is_flag=True, help="Leave the verifier out (ablation)."),
    click.option("--no-stages", is_flag=True, help="Build everything in one pass (ablation)."),
)


@click.command()
@click.argument("prompt")
@_model
@_limits
@_blender
@_assets
@_ablations
def make(prompt: str, **given: Any) -> None:
    """Make a scene from a sentence: a .blend with baked physics, a video and a report.

    Asks a language model (ANTHROPIC_API_KEY; ANTHROPIC_BASE_URL for another server that speaks its API; with
    --provider openai, OPENAI_API_KEY and OPENAI_BASE_URL, of which a server of your own needs only the second). Without
    a key, try 'simworlds demo'. Exit code 0: done. 1: a stage could not be closed. 2: it failed. 3: it was stopped, and
    can be resumed.
    """
    if not prompt.strip():
        raise click.UsageError("PROMPT is empty: say what is to be made.")
    _begin({"prompt": prompt, **_of_model(given)}, given)


@click.command()
@click.argument("file", type=_FILE)
@click.argument("instruction")
@click.option("--reference", type=_FILE, help="A picture of what the result should look like.")
@_model
@_limits
@_blender
@_assets
def edit(file: Path, instruction: str, reference: Path | None, **given: Any) -> None:
    """Change a scene as told, and leave the rest alone. The file itself stays as it is.

    Any .blend will do. The report lists every data-block that was changed or left alone. Exit codes as of 'make'.
    """
    if not instruction.strip():
        raise click.UsageError("INSTRUCTION is empty: say what is to be changed.")
    asked = {"mode": "edit", "prompt": instruction, "file": file, "reference": reference, **_of_model(given)}
    _begin(asked, given)


@click.command()
@click.argument("name", required=False)
@_limits
@_blender
def demo(name: str | None, **given: Any) -> None:
    """Play a transcript against a real Blender; needs no key. Without a name: list them.

    What the roles say was written beforehand, by whom the list tells; Blender, verifier, baking and rendering are real.
    """
    from agents.loop.demos import demo_options, listed  # noqa: PLC0415 - not for --help
    from agents.loop.errors import NoRun, RunError  # noqa: PLC0415

    if name is None:
        click.echo(listed())
        return
    with _folder_of(given) as root:
        try:
            asked = demo_options(name, root.with_name(f"{root.name}-input.blend"))
        except NoRun as error:
            raise click.UsageError(str(error)) from error
        except RunError as error:
            click.echo(f"Error: {error}", err=True)
            sys.exit(EXITS["failed"])
        _begin(asked, given | {"root": root})


@click.command()
@click.argument("run", type=_RunFolder())
@_limits
@_blender
def replay(run: Path, **given: Any) -> None:
    """Play the recorded answers of a run against a real Blender, without a key or network, as a run of its own.

    Where the conversation is not the recorded one, it says so, and stops.
    """
    from agents.loop.demos import replay_options  # noqa: PLC0415 - not for --help
    from agents.loop.errors import NoRun  # noqa: PLC0415

    try:
        asked = replay_options(run)
    except NoRun as error:
        raise click.UsageError(str(error)) from error
    _begin(asked, given)


@click.command()
@click.argument("run", type=_RunFolder())
@_limits
@combine(*_RENDER)
def resume(run: Path, **given: Any) -> None:
    """Resume a run that was stopped or killed. Nothing that was done or paid for is done again.

    --render-minutes and --samples are for what is still to be rendered.
    """
    from agents.loop.session import resume as go_on  # noqa: PLC0415 - not for --help

    _work(lambda session: go_on(run, session), run, given, render=True)


@click.command()
def runs() -> None:
    """List the runs, those worked on last first. 'resume', 'show' and 'replay' take the names from any folder, and the
    paths of those that were made elsewhere with --run."""
    from agents.blender.launch import runs_folder  # noqa: PLC0415 - not for --help
    from agents.views.run_list import list_elsewhere, list_runs  # noqa: PLC0415
    from simworlds.terminal.console import Console  # noqa: PLC0415 - not for --help

    found, elsewhere = list_runs(), list_elsewhere()
    console = Console(sys.stdout)
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console.width = _IN_A_PIPE
    for table in (found, elsewhere):
        if table.row_count:
            console.print(table)
    if found.row_count or elsewhere.row_count:
        click.echo("To continue one: simworlds resume NAME. To look at one: simworlds show NAME.")
    none = "There are no other runs" if elsewhere.row_count else "There are no runs"
    click.echo(f"{'The runs are' if found.row_count else none} in {runs_folder()}.")


@click.command()
@click.argument("run", type=_RunFolder())
@click.option("--report", is_flag=True, help="Write report.html again.")
def show(run: Path, *, report: bool) -> None:
    """Show the state or the outcome of a run."""
    from agents.loop.errors import RunError  # noqa: PLC0415
    from agents.views.run_list import shown  # noqa: PLC0415
    from simworlds.terminal.console import Console  # noqa: PLC0415 - not for --help
    from simworlds.terminal.progress import shown_progress  # noqa: PLC0415

    try:
        Console(sys.stdout).print(shown(run))
        if report:
            with shown_progress(in_logs=False) as progress:
                progress("Writing the report", 0, None)
                path = _write_report(run)
            if path is None:
                sys.exit(EXITS["failed"])
            click.echo(path)
    except RunError as error:
        raise click.UsageError(str(error)) from error


def _write_report(run: Path) -> Path | None:
    """Writes the report of a run; where it cannot be written, says why. Raises NoRun."""
    from agents.views.report.page import NAME, write_report  # noqa: PLC0415 - not for --help

    try:
        return write_report(run)
    except OSError as error:
        click.echo(
            f"Error: {run / NAME} cannot be written: {error.strerror or error}. Make room there, then write it again: "
            f"{own_command()} show {SYSTEM.quoted(str(run))} --report",
            err=True,
        )
        return None


def _of_model(given: dict[str, Any]) -> dict[str, Any]:
    asked = {name: given[name] for name in ("provider", "model", "price") if given[name] is not None}
    models = dict(choice.partition("=")[::2] for choice in given["role_model"])
    for role, name in models.items():
        if role not in ROLES or not name:
            raise click.UsageError(f"--role-model takes ROLE=NAME with a role of {', '.join(ROLES)}.")
    return asked | {"models": models}


def _limited(given: dict[str, Any], *, render: bool) -> Any:
    from agents.loop.options import RunLimits  # noqa: PLC0415 - not for --help

    names = ("max_cost", "max_minutes", *(("render_minutes", "samples") if render else ()))
    return RunLimits(**{name: given[name] for name in names})


@contextmanager
def _folder_of(given: dict[str, Any]) -> Generator[Path]:
    """The folder that was chosen for a run, else a new one, which goes again if nothing has come into it."""
    if given["root"] is not None:
        yield given["root"]
        return
    from agents.blender.files.run_folder import new_root  # noqa: PLC0415 - not for --help
    from agents.blender.launch import runs_folder  # noqa: PLC0415

    try:
        root = new_root(runs_folder())
    except OSError as error:
        click.echo(
            f"Error: No folder for a run can be made in {runs_folder()}: {error.strerror or error}. Choose one with "
            "--run, or set SIMWORLDS_HOME.",
            err=True,
        )
        sys.exit(EXITS["failed"])
    try:
        yield root
    finally:
        with suppress(OSError):
            root.rmdir()


def _begin(asked: dict[str, Any], given: dict[str, Any]) -> None:
    from pydantic import ValidationError  # noqa: PLC0415 - not for --help

    from agents.loop.options import Options  # noqa: PLC0415
    from agents.loop.session import begin  # noqa: PLC0415
    from simworlds.schemas.faults import every_fault  # noqa: PLC0415

    names = ("blender", "blender_exe", "read", "assets", "sandbox", "render_minutes", "samples")
    asked = asked | {name: given[name] for name in names if given.get(name) is not None}
    asked |= {"verifier": not given.get("no_verifier", False), "stages": not given.get("no_stages", False)}
    try:
        options = Options(**asked)
    except ValidationError as error:
        raise click.UsageError(every_fault(error)) from error
    from agents.commands.sandbox_warning import warn  # noqa: PLC0415 - not for --help
    from simworlds.sandbox.confinement.confined_command import best_sandbox  # noqa: PLC0415

    warn(best_sandbox(options.sandbox))
    with _folder_of(given) as root:
        _work(lambda session: begin(root, options, session), root, given)


def _work(
    work: Callable[[RunSession], Ended], root: Path, given: dict[str, Any], *, render: bool = False
) -> None:
    from agents.loop.errors import RunError  # noqa: PLC0415 - not for --help
    from agents.loop.record.elsewhere import remembered  # noqa: PLC0415
    from agents.loop.record.reducer import read_run_state  # noqa: PLC0415
    from agents.loop.session import RunSession, Stop, resume_command  # noqa: PLC0415
    from agents.views.live_view import RunView, make_view  # noqa: PLC0415
    from agents.views.report.early import ReportWriter  # noqa: PLC0415

    stop = Stop(threading.Event())
    try:
        before = read_run_state(root)
        watched = RunView(before) if given["quiet"] else make_view(sys.stderr, str(root), before)
        with remembered(root), watched as view, _signals(stop):
            watcher = ReportWriter(view, root)
            ended = work(RunSession(_limited(given, render=render), watcher, stop))
        report = _write_report(root)
    except RunError as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(EXITS["failed"])
    if ended.why:
        click.echo(f"{ended.how.capitalize()}: {ended.why}", err=True)
    for path in (ended.file, ended.shown, report):
        if path is not None and path.exists():
            click.echo(path)
    if ended.how in ("stopped", "failed") and ended.again:
        click.echo(f"Continue with: {resume_command(root)}", err=True)
    sys.exit(EXITS[ended.how])


@contextmanager
def _signals(stop: Stop) -> Generator[None]:
    """The first Ctrl-C asks for a stop at the next safe point, the second for one now."""

    def ask(_number: int, _frame: FrameType | None) -> None:
        if stop.event.is_set():
            stop.now()
            raise KeyboardInterrupt
        stop.event.set()
        click.echo(
            "\nStopping at the next safe point. Press Ctrl-C again to stop now. The run can be resumed.",
            err=True,
        )

    before = {number: signal.signal(number, ask) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
