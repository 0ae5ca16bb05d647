"""The command ``simworlds verify``: checks a .blend against the scene protocol and a plan."""

from __future__ import annotations

import os
import signal
import sys
import tempfile
import threading
import time
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from simworlds.settings import expanded
from simworlds.terminal import options

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from types import FrameType

    from rich.status import Status

    from agents.blender.supervisor import Supervisor
    from agents.blender.tools.base import Call
    from agents.plan.scene import ScenePlan
    from agents.plan.tactical import Withdrawal
    from agents.protocol.findings import Report
    from agents.protocol.report.summary import VerificationScope
    from agents.protocol.rule import Rule

_UNCHECKED = 2
_LOAD_SECONDS, _STAND_SECONDS = 300.0, 600.0
_PATIENCE_SECONDS, _LINE_SECONDS = 2.0, 10.0
_WIDTH = 132  # of a table that does not go to a terminal
_PATH = click.Path(path_type=Path)


class _CannotCheckError(Exception):
    """The scene cannot be checked; the message says why. ``faults`` are those of its plan: (path, sentence)."""

    def __init__(self, message: str, faults: list[tuple[str, str]] | None = None) -> None:
        self.faults = faults or []
        super().__init__(message)

    @property
    def lines(self) -> list[str]:
        """The message, and a line on each fault."""
        return [str(self), *(f"  {path or 'plan'}: {message}" for path, message in self.faults)]


@click.command()
@click.argument("scenes", metavar="SCENE...", nargs=-1, required=True, type=_PATH)
@click.option(
    "--plan",
    type=_PATH,
    help="The scene plan (JSON) that the scene was built to. Default: the plan of the run that made the file.",
)
@click.option("--rules", metavar="LIST", help="Families or rules, such as C,G,V1. Default: all.")
@click.option("--json", "as_json", is_flag=True, help="Print everything as JSON.")
@click.option("--sarif", "sarif", is_flag=True, help="Print the findings as SARIF 2.1.0.")
@click.option("--image", type=_PATH, help="Draw the findings on views of the scene, as a PNG.")
@click.option(
    "--frame",
    type=click.IntRange(-1_048_574, 1_048_574),  # Blender's own bounds
    help="The frame to check. Default: the frame saved in the file.",
)
@click.option("--read", type=_PATH, multiple=True, help="A folder that Blender may read, for linked files.")
@options.VERSION
@options.EXECUTABLE
def verify(
    scenes: tuple[Path, ...], *, as_json: bool, sarif: bool, rules: str | None, **choices: Any
) -> None:
    """Check a .blend against the scene protocol, and against the plan that it was built to.

    The file is not changed, and no script in it runs. Of several files, one log of SARIF holds all. Exit code 0: no
    hard rule is broken. 1: at least one is. 2: it could not be checked: the file cannot be opened, the plan has faults,
    or a rule could not be decided; or the image that was asked for could not be made.
    """
    if as_json and sarif:
        raise click.UsageError("--json and --sarif exclude each other.")
    form = "json" if as_json else "sarif" if sarif else None
    if len(scenes) > 1 and (choices["plan"] or choices["image"] or form == "json"):
        raise click.UsageError("--plan, --image and --json are of one file: give one.")
    _on_signals(_interrupt)
    logs: list[dict[str, Any]] = []
    code = 0
    for scene in scenes:
        try:
            done = _verify(scene, form, _rules(rules), choices, logs)
        except _CannotCheckError as error:
            _print_error(error, form, logs)
            done = _UNCHECKED
        code = max(code, done)
    _print_logs(scenes, logs)
    sys.exit(code)


def _verify(
    scene: Path,
    form: str | None,
    rules: tuple[Rule, ...],
    choices: dict[str, Any],
    logs: list[dict[str, Any]],
) -> int:
    """Checks one scene and prints the report, or adds it to ``logs`` if it is to be SARIF. Returns the exit code."""
    from agents.protocol.report.summary import exit_code  # noqa: PLC0415
    from simworlds.sandbox.errors import BlenderError  # noqa: PLC0415 - not for --help

    # Of a file that is not there, no plan is looked for, nor told that there is none.
    plan = _plan_for(scene, choices["plan"]) if choices["plan"] or scene.exists() else None
    image: Path | None = choices["image"]
    if image is not None:
        _check_image(image)
    try:
        withdrawn = _withdrawn(scene) if plan is not None and choices["plan"] is None else []
        report, checked, fault = _run(scene, rules, plan, choices, withdrawn)
    except BlenderError as error:
        raise _CannotCheckError(f"{scene} could not be checked: {error}") from error
    _print(report, checked, form, logs)
    if fault:
        click.echo(f"Error: no image could be made: {fault}", err=True)
    return _UNCHECKED if fault else exit_code(report)


def _check_image(image: Path) -> None:
    """Raises _CannotCheckError where an image cannot be put, or would be written over what is none."""
    if image.suffix.lower() != ".png":
        raise _CannotCheckError(f"--image {image} is to be a PNG: give it a name that ends in .png.")
    if not image.absolute().parent.is_dir():
        raise _CannotCheckError(f"The folder {image.absolute().parent} for {image.name} does not exist.")


def _rules(wanted: str | None) -> tuple[Rule, ...]:
    from agents.protocol.verify_request import rules_named  # noqa: PLC0415 - not for --help

    try:
        return rules_named(None if wanted is None else wanted.split(","))
    except ValueError as error:
        raise _CannotCheckError(f"--rules: {error}") from error


def _plan_for(scene: Path, given: Path | None) -> ScenePlan | None:
    """The plan that was given, or that of the run whose result ``scene`` is. Raises _CannotCheckError."""
    if given is not None:
        return _plan(given)
    beside = _plan_of_run(scene.parent)
    if beside is None:
        if above := _plan_of_run(scene.absolute().parent.parent):
            click.echo(
                "The file is checked without a plan. To check it against that of its run, which asks for what later "
                f"stages build, too: --plan {above}",
                err=True,
            )
        return None
    try:
        plan = _plan(beside)
    except _CannotCheckError as error:
        if not _is_of_an_edit(beside):
            click.echo("\n".join(["Warning: the scene is checked without a plan.", *error.lines]), err=True)
        return None
    click.echo(f"The plan is {beside}, of the run that made the file.", err=True)
    return plan


def _plan_of_run(folder: Path) -> Path | None:
    """The plan in a folder, if the folder is a run's."""
    from agents.loop.record.journal import NAME, PLAN_NAME  # noqa: PLC0415 - not for --help

    path = folder / PLAN_NAME
    return path if path.is_file() and (folder / NAME).is_file() else None


def _withdrawn(scene: Path) -> list[Withdrawal]:
    """What the planner took back in the run whose result ``scene`` is, as far as its journal can be read."""
    from agents.loop.errors import NoRun  # noqa: PLC0415 - only beside a run's result
    from agents.loop.record.journal import NAME, read_rows  # noqa: PLC0415 - likewise
    from agents.loop.review.withdrawals import withdrawn_in  # noqa: PLC0415 - likewise

    try:
        return list(withdrawn_in(read_rows(scene.parent / NAME)))
    except NoRun:
        return []


def _is_of_an_edit(path: Path) -> bool:
    """Whether a file is the plan of an edit, which tells of no scene."""
    from agents.plan.edit import EditPlan  # noqa: PLC0415 - only beside a run's result

    try:
        EditPlan.model_validate_json(path.read_bytes())
    except (OSError, ValueError):
        return False
    return True


def _plan(path: Path) -> ScenePlan:
    """Raises _CannotCheckError, with the plan's faults."""
    from agents.protocol.verify_request import plan_from  # noqa: PLC0415 - not for --help

    try:
        plan, faults = plan_from(path.read_bytes())
    except OSError as error:
        raise _CannotCheckError(f"The plan {path} cannot be read: {error.strerror or error}.") from error
    if plan is None:
        raise _CannotCheckError(
            f"The plan {path} cannot be used:", [(fault.path, fault.message) for fault in faults]
        )
    return plan


# Blender


def _run(
    scene: Path,
    rules: tuple[Rule, ...],
    plan: ScenePlan | None,
    choices: dict[str, Any],
    withdrawn: list[Withdrawal],
) -> tuple[Report, VerificationScope, str]:
    """Checks the scene, and draws the image if one is wanted; gives why that failed, "" if it did not.

    Raises _CannotCheckError and BlenderError.
    """
    from agents.blender.checks.verification import ScenePosition, verify_scene  # noqa: PLC0415
    from agents.blender.tools.base import Call  # noqa: PLC0415 - not for --help
    from agents.protocol.report.summary import VerificationScope  # noqa: PLC0415

    with _StatusLine() as status:
        call = Call(status.progress)
        status.show(f"Opening {scene.name}")
        with _opened(scene, choices, call) as blender:
            status.show("Going to the frame")
            position = blender.call(
                "go_to_frame",
                {"frame": choices["frame"]},
                ScenePosition.model_validate,
                timeout=_STAND_SECONDS,
                progress=call.progress,
            ).value
            process = blender.inner_pid
            status.show("Measuring")
            report = _without(verify_scene(blender, rules, plan, call, plays=True), withdrawn)
            if blender.inner_pid != process:
                # The new Blender has an empty scene.
                raise _CannotCheckError(f"{scene} could not be checked: Blender ended while checking it.")
            checked = VerificationScope(
                rules,
                file=str(scene),
                scene=position.scene,
                frame=position.frame,
                blender=blender.launch.runtime.version,
                plan=plan.title if plan else "",
            )
            fault = ""
            if choices["image"] is not None:
                status.show("Drawing")
                fault = _draw(blender, report, call, checked, choices["image"])
    return report, checked, fault


def _without(report: Report, withdrawn: list[Withdrawal]) -> Report:
    """The report with findings about what the run's planner took back as soft ones."""
    from agents.loop.review.withdrawals import as_soft, format_withdrawn  # noqa: PLC0415 - not for --help

    findings, told = as_soft(report.findings, withdrawn)
    if not told:
        return report
    return replace(report, findings=tuple(findings), remarks=(*report.remarks, format_withdrawn(withdrawn)))


@contextmanager
def _opened(scene: Path, choices: dict[str, Any], call: Call) -> Generator[Supervisor]:
    """A Blender with the file open, in a temporary run folder. Raises _CannotCheckError and BlenderError."""
    from agents.blender.files.run_folder import RunFolder  # noqa: PLC0415
    from agents.blender.files.saved_files import (  # noqa: PLC0415
        LoadedFile,
        caches_folder,
        find_blend_file,
        is_blend_name,
    )
    from agents.blender.launch import make_launch  # noqa: PLC0415 - not for --help
    from agents.blender.supervisor import Supervisor  # noqa: PLC0415

    real = expanded(scene).resolve()
    with tempfile.TemporaryDirectory(prefix="simworlds-verify-", ignore_cleanup_errors=True) as temporary:
        folder = RunFolder.make(Path(temporary).resolve() / "run")
        if not real.exists():
            raise _CannotCheckError(f"There is no file {scene}.")
        if not is_blend_name(real.name):
            raise _CannotCheckError(f"{scene} is not a .blend file.")
        find_blend_file(str(real), folder, (real.parent,))
        launch = make_launch(
            folder.workspace,
            version=choices["blender"],
            blender_exe=choices["blender_exe"],
            # Blender may read the file and the caches beside it, but nothing else in that folder.
            read=(*choices["read"], *(path for path in (real, caches_folder(real)) if path.exists())),
        )
        with Supervisor(launch, folder) as blender:
            loaded = blender.call(
                "load",
                {"path": str(real), "workspace": folder.workspace.for_blender()},
                LoadedFile.model_validate,
                timeout=_LOAD_SECONDS,
                what=f"opening {scene.name}",
                progress=call.progress,
            ).value
            for file in loaded.external:
                if file.missing and file.what.startswith("library"):
                    raise _CannotCheckError(
                        f"{scene} links {file.path}, which cannot be read: give its folder with --read."
                    )
            yield blender


def _draw(blender: Supervisor, report: Report, call: Call, checked: VerificationScope, target: Path) -> str:
    """Draws the image; returns why that failed, "" if it did not."""
    from agents.blender.sheets.findings_sheet import draw_findings  # noqa: PLC0415
    from simworlds.files import write_whole  # noqa: PLC0415 - only for --image
    from simworlds.sandbox.errors import BlenderError  # noqa: PLC0415 - likewise

    try:
        write_whole(target, draw_findings(blender, report, call, checked.title), durable=False)
    except BlenderError as error:  # what was measured is told all the same
        return str(error)
    except OSError as error:
        return f"{target} cannot be written: {error.strerror or error}."
    return ""


# Output


def _print_logs(scenes: tuple[Path, ...], logs: list[dict[str, Any]]) -> None:
    """Prints logs of SARIF, one of each scene, as one."""
    from agents.protocol.report.json_report import dump_json  # noqa: PLC0415 - not for --help
    from simworlds.formats.sarif import sarif_log, tell_apart  # noqa: PLC0415 - likewise

    runs = [run for log in logs for run in log["runs"]]
    tell_apart(runs, [f"simworlds-verify/{scene.as_posix()}/" for scene in scenes])
    if logs:
        click.echo(dump_json(sarif_log(runs)))


def _print(report: Report, checked: VerificationScope, form: str | None, logs: list[dict[str, Any]]) -> None:
    from agents.protocol.report.json_report import as_json, dump_json  # noqa: PLC0415 - not for --help
    from agents.protocol.report.sarif import as_sarif  # noqa: PLC0415
    from agents.protocol.report.table import as_table  # noqa: PLC0415

    if form == "json":
        click.echo(dump_json(as_json(report, checked)))
        return
    if form == "sarif":
        logs.append(as_sarif(report, checked))
        return
    from simworlds.terminal.console import Console  # noqa: PLC0415 - not for --json

    console = Console(sys.stdout, soft_wrap=False)
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console.width = _WIDTH
    console.print(as_table(report, checked, console.width))


def _print_error(error: _CannotCheckError, form: str | None, logs: list[dict[str, Any]]) -> None:
    """Prints the error on stderr, and for --json and --sarif also in their form on stdout."""
    from agents.protocol.report.json_report import dump_json  # noqa: PLC0415 - not for --help
    from agents.protocol.report.sarif import sarif_failure  # noqa: PLC0415 - not for --help

    text = "\n".join(["Error: " + error.lines[0], *error.lines[1:]])
    click.echo(text, err=True)
    if form == "json":
        faults = [{"path": path, "message": message} for path, message in error.faults]
        click.echo(dump_json({"error": str(error), "faults": faults}))
    elif form == "sarif":
        logs.append(sarif_failure(text))


class _StatusLine:
    """Shows on stderr what is being done, once the command takes longer than two seconds."""

    def __init__(self) -> None:
        self._text = self._what = ""
        self._status: Status | None = None
        self._late = False
        self._since = 0.0
        self._timer = threading.Timer(_PATIENCE_SECONDS, self._begin)
        self._timer.daemon = True

    def __enter__(self) -> _StatusLine:
        self._timer.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._timer.cancel()
        self._timer.join()
        if self._status is not None:
            self._status.stop()

    def show(self, what: str) -> None:
        """Sets what is being done."""
        self._what = what
        self._say(what)

    def progress(self, done: float, total: float | None, text: str) -> None:
        """Sets how far it is."""
        share = f" {done / total:.0%}" if total else ""
        line = f"{self._what}{share} {text}".rstrip()
        if self._status is not None:
            self._update(line)
        elif self._late and time.monotonic() - self._since >= _LINE_SECONDS:
            self._say(line)

    def _say(self, text: str) -> None:
        self._text = text
        if self._status is not None:
            self._update(text)
        elif self._late:
            self._since = time.monotonic()
            click.echo(f"{text} …", err=True)

    def _update(self, line: str) -> None:
        from rich.text import Text  # noqa: PLC0415 - only when it takes long

        assert self._status is not None
        self._status.update(Text(line))  # a string would be read as markup

    def _begin(self) -> None:
        if sys.stderr.isatty():
            from rich.text import Text  # noqa: PLC0415 - only when it takes long

            from simworlds.terminal.console import Console  # noqa: PLC0415

            self._status = Console(sys.stderr).status(Text(self._text))
            self._status.start()
        else:
            click.echo(f"{self._text} …", err=True)
        self._since = time.monotonic()
        self._late = True


def _on_signals(handler: Callable[[int, FrameType | None], NoReturn]) -> None:
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, handler)


def _interrupt(_number: int, _frame: FrameType | None) -> NoReturn:
    """Unwinds once, ignoring further signals, so that no process or folder stays behind."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    raise KeyboardInterrupt
