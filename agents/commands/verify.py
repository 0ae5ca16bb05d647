"""The command ``simworlds verify``."""

from __future__ import annotations

import os
import signal
import sys
import tempfile
import threading
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from types import FrameType

    from rich.status import Status

    from agents.blender.supervisor import Supervisor
    from agents.blender.tools.base import Call
    from agents.plan.scene import ScenePlan
    from agents.protocol.findings import Report
    from agents.protocol.report.summary import VerificationScope
    from agents.protocol.rule import Rule

_UNCHECKED, _INTERRUPTED = 2, 130
_LOAD_SECONDS, _STAND_SECONDS = 300.0, 3600.0
_PATIENCE_SECONDS = 2.0
_WIDTH = 132  # of a table that does not go to a terminal
_PATH = click.Path(path_type=Path)


class _CannotCheckError(Exception):
    """The scene cannot be checked; the message says why. ``faults`` are those of a plan: [path, sentence]."""

    def __init__(self, message: str, faults: list[tuple[str, str]] | None = None) -> None:
        self.faults = faults or []
        super().__init__(message)


@click.command()
@click.argument("scene", type=_PATH)
@click.option("--plan", type=_PATH, help="The scene plan (JSON) that the scene was built to.")
@click.option("--rules", metavar="LIST", help="Families or rules, as C,G,V1. Default: all.")
@click.option("--json", "form", flag_value="json", help="Print everything as JSON.")
@click.option("--sarif", "form", flag_value="sarif", help="Print the findings as SARIF 2.1.0.")
@click.option("--image", type=_PATH, help="Draw the findings on views of the scene, as a PNG.")
@click.option("--frame", type=int, help="The frame to check. Default: the one that the file was saved at.")
@click.option("--read", type=_PATH, multiple=True, help="A folder that Blender may read, as of linked files.")
@click.option("--blender", metavar="VERSION", help="Blender version. Default: this environment's.")
@click.option(
    "--blender-exe",
    type=_PATH,
    envvar="BLENDER_EXE",
    show_envvar=True,
    help="The Blender to use, if not bpy.",
)
def verify(scene: Path, form: str | None, rules: str | None, **given: Any) -> None:
    """Check a .blend against the scene protocol, and against the plan that it was built to.

    Any .blend will do; it is not changed, and no script in it runs. Exit code 0: no hard rule is broken. 1: one is.
    2: it could not be checked: the file cannot be opened, the plan contradicts itself, a rule could not be decided.
    """
    _on_signals(_interrupt)
    try:
        try:
            code = _verified(scene, form, _rules(rules), given)
        except _CannotCheckError as error:
            _tell(error, form)
            code = _UNCHECKED
    except KeyboardInterrupt:
        click.echo("Interrupted.", err=True)
        code = _INTERRUPTED
    sys.exit(code)


def _verified(scene: Path, form: str | None, rules: tuple[Rule, ...], given: dict[str, Any]) -> int:
    from agents.protocol.report.summary import exit_code  # noqa: PLC0415
    from simworlds.sandbox.errors import BlenderError  # noqa: PLC0415 - not for --help

    plan = _plan(given["plan"]) if given["plan"] else None
    image: Path | None = given["image"]
    if image is not None and not image.absolute().parent.is_dir():
        raise _CannotCheckError(f"There is no folder {image.absolute().parent} to put {image.name} into.")
    try:
        report, checked = _run(scene, rules, plan, given)
    except BlenderError as error:
        raise _CannotCheckError(f"{scene} could not be checked: {error}") from error
    _print(report, checked, form)
    return exit_code(report)


def _rules(wanted: str | None) -> tuple[Rule, ...]:
    from agents.protocol.verify_request import rules_named  # noqa: PLC0415 - not for --help

    try:
        return rules_named(None if wanted is None else wanted.split(","))
    except ValueError as error:
        raise _CannotCheckError(f"--rules: {error}") from error


def _plan(path: Path) -> ScenePlan:
    """Raises _CannotCheckError, with what contradicts itself in it."""
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
    scene: Path, rules: tuple[Rule, ...], plan: ScenePlan | None, given: dict[str, Any]
) -> tuple[Report, VerificationScope]:
    """Checks, and draws if that is asked for. Raises _CannotCheckError and BlenderError."""
    from agents.blender.tools.base import Call  # noqa: PLC0415 - not for --help
    from agents.blender.verification import verify_scene  # noqa: PLC0415
    from agents.protocol.report.summary import VerificationScope  # noqa: PLC0415

    with _Waiting() as waiting:
        call = Call(waiting.progress)
        waiting.for_(f"Opening {scene.name}")
        with _opened(scene, given, call) as blender:
            waiting.for_("Going to the frame")
            stands = blender.call(
                "stand_at", {"frame": given["frame"]}, timeout=_STAND_SECONDS, progress=call.progress
            ).value
            process = blender.inner_pid
            waiting.for_("Measuring")
            report = verify_scene(blender, rules, plan, call)
            if blender.inner_pid != process:
                # What stands there now is an empty scene, about which nobody has asked.
                raise _CannotCheckError(f"{scene} could not be checked: Blender ended over it.")
            checked = VerificationScope(
                rules,
                file=str(scene),
                scene=str(stands["scene"]),
                frame=int(stands["frame"]),
                blender=blender.launch.runtime.version,
                plan=plan.title if plan else "",
            )
            if given["image"] is not None:
                waiting.for_("Drawing")
                if fault := _draw(blender, report, call, checked, given["image"]):
                    click.echo(f"There is no picture: {fault}", err=True)
    return report, checked


@contextmanager
def _opened(scene: Path, given: dict[str, Any], call: Call) -> Generator[Supervisor]:
    """A Blender with the file open, in a run's folder that goes with it. Raises _CannotCheckError, BlenderError."""
    from agents.blender.launch import make_launch  # noqa: PLC0415 - not for --help
    from agents.blender.run_folder import RunFolder  # noqa: PLC0415
    from agents.blender.saved_files import Loaded, beside, checked, find  # noqa: PLC0415
    from agents.blender.supervisor import Supervisor  # noqa: PLC0415

    real = scene.expanduser().resolve()
    with tempfile.TemporaryDirectory(prefix="simworlds-verify-", ignore_cleanup_errors=True) as place:
        folder = RunFolder.make(Path(place).resolve() / "run")
        if not real.exists():
            raise _CannotCheckError(f"There is no file {scene}.")
        find(str(real), folder, (real.parent,))
        launch = make_launch(
            folder.workspace,
            version=given["blender"],
            blender_exe=given["blender_exe"],
            # It may read the file and the caches beside it, but nothing else of that folder.
            read=(*given["read"], *(one for one in (real, beside(real)) if one.exists())),
        )
        with Supervisor(launch, folder) as blender:
            loaded = checked(
                Loaded,
                blender.call(
                    "load",
                    {"path": str(real), "workspace": str(folder.workspace), "lent": False},
                    timeout=_LOAD_SECONDS,
                    what=f"opening {scene.name}",
                    progress=call.progress,
                ).value,
            )
            if absent := [
                one.path for one in loaded.external if one.missing and one.what.startswith("library")
            ]:
                raise _CannotCheckError(
                    f"{scene} links {absent[0]}, which cannot be read: give its folder with --read."
                )
            yield blender


def _draw(blender: Supervisor, report: Report, call: Call, checked: VerificationScope, target: Path) -> str:
    """Draws; returns why there is no picture, "" if there is one."""
    from agents.blender.sheets.findings_sheet import draw_findings  # noqa: PLC0415
    from simworlds.sandbox.errors import Refusal  # noqa: PLC0415 - only for --image

    try:
        target.write_bytes(draw_findings(blender, report, call, checked.title))
    except Refusal as error:
        return str(error)
    except OSError as error:
        return f"{target} cannot be written: {error.strerror or error}."
    return ""


# What is said


def _print(report: Report, checked: VerificationScope, form: str | None) -> None:
    from agents.protocol.report.json_report import as_json, dump_json  # noqa: PLC0415 - not for --help
    from agents.protocol.report.sarif import as_sarif  # noqa: PLC0415
    from agents.protocol.report.table import as_table  # noqa: PLC0415

    if form is not None:
        click.echo(dump_json((as_json if form == "json" else as_sarif)(report, checked)))
        return
    from rich.console import Console  # noqa: PLC0415 - the other ways do without

    console = Console(highlight=False, soft_wrap=False)
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console.width = _WIDTH
    console.print(as_table(report, checked, console.width))


def _tell(error: _CannotCheckError, form: str | None) -> None:
    """The reason on stderr; for machines also where they look for the report."""
    from agents.protocol.report.json_report import dump_json  # noqa: PLC0415 - not for --help
    from agents.protocol.report.sarif import sarif_failure  # noqa: PLC0415 - not for --help

    lines = [f"Error: {error}", *(f"  {path or 'plan'}: {message}" for path, message in error.faults)]
    click.echo("\n".join(lines), err=True)
    if form == "json":
        faults = [{"path": path, "message": message} for path, message in error.faults]
        click.echo(dump_json({"error": str(error), "faults": faults}))
    elif form == "sarif":
        click.echo(dump_json(sarif_failure("\n".join(lines))))


class _Waiting:
    """Says on stderr what is being done, once the whole takes longer than two seconds."""

    def __init__(self) -> None:
        self._text = self._what = ""
        self._status: Status | None = None
        self._late = False
        self._timer = threading.Timer(_PATIENCE_SECONDS, self._begin)
        self._timer.daemon = True

    def __enter__(self) -> _Waiting:
        self._timer.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._timer.cancel()
        self._timer.join()
        if self._status is not None:
            self._status.stop()

    def for_(self, what: str) -> None:
        """What is being done from here on."""
        self._what = what
        self._say(what)

    def progress(self, done: float, total: float | None, text: str) -> None:
        """How far that is."""
        share = f" {done / total:.0%}" if total else ""
        if self._status is not None:
            self._status.update(f"{self._what}{share} {text}".rstrip())

    def _say(self, text: str) -> None:
        self._text = text
        if self._status is not None:
            self._status.update(text)
        elif self._late:
            click.echo(f"{text} …", err=True)

    def _begin(self) -> None:
        if sys.stderr.isatty():
            from rich.console import Console  # noqa: PLC0415 - only for who waits

            self._status = Console(stderr=True).status(self._text)
            self._status.start()
        else:
            click.echo(f"{self._text} …", err=True)
        self._late = True


def _on_signals(handler: Callable[[int, FrameType | None], NoReturn]) -> None:
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, handler)


def _interrupt(_number: int, _frame: FrameType | None) -> NoReturn:
    """Unwinds once, and undisturbed: no process and no folder stays behind."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    raise KeyboardInterrupt
