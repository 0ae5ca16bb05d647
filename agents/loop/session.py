"""A session: one process's work on a run, from its beginning or where it stands, to its end or a safe point."""

from __future__ import annotations

import logging
import os
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal, Protocol

from pydantic import ValidationError

from agents.blender.blender_sessions import SessionSetup
from agents.loop.algorithm import make
from agents.loop.answer_source import LiveOptions, check_model, make_model, repeat_told
from agents.loop.edit.edit_mode import edit
from agents.loop.edit.inputs import check_inputs
from agents.loop.errors import Aborted, NoRun, Stopping, Unusable
from agents.loop.film.film_limits import FilmLimits
from agents.loop.leaving import LATEST, leave
from agents.loop.options import BEFORE_DRAFTS, Options, RunLimits
from agents.loop.record.events import RunBegan, RunEnded, SessionBegan
from agents.loop.record.journal import NAME, Journal
from agents.loop.record.reducer import read_run_state
from agents.loop.running.deadline import Deadline
from agents.loop.running.position import Position
from agents.loop.running.run import Run
from agents.loop.running.run_files import SCENE, RunFiles
from agents.loop.running.run_tools import RunTools
from agents.loop.running.tool_client import ToolClient
from agents.roles.names import ROLES
from simworlds.errors import UserError
from simworlds.folder_lock import locked
from simworlds.installed import own_version
from simworlds.llm.errors import Misfit, ModelError, OverBudget
from simworlds.llm.spending import Spending
from simworlds.operating_system import SYSTEM
from simworlds.own_command import own_command
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.errors import CannotStart, Refusal
from simworlds.sandbox.launch import find_blender

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable

    from agents.loop.record.events import Event
    from simworlds.llm.apis.retries import Retry

_LOG = logging.getLogger(__name__)
RESULTS = ("video.mp4", "still.png", "draft.mp4", LATEST)  # what a run shows, the best first
_STRONGER = (
    "'resume' asks it again. If that does not help, start a new run with a stronger model, for this role alone "
    "(--role-model ROLE=NAME) or for all (--model NAME)."
)
How = Literal["done", "aborted", "stopped", "failed"]


class Watcher(Protocol):
    """Gets what happens in a session. May be called from any thread."""

    def take(self, event: Event) -> None:
        """An event was written to the journal."""
        ...

    def saying(self, role: str, text: str) -> None:
        """The next words of a model, as they come."""
        ...

    def asking_again(self, role: str, why: str) -> None:
        """A model gave no whole answer and is asked again: what was wrong, and when."""
        ...

    def progress(self, tool: str, done: float, total: float | None, text: str) -> None:
        """How far a tool has got."""
        ...


@dataclass(frozen=True, slots=True)
class Ended:
    """How a session ended. ``file`` is the .blend, ``shown`` the video or still.

    ``again``: whether resuming may help.
    """

    how: How
    why: str = ""
    file: Path | None = None
    shown: Path | None = None
    again: bool = True


@dataclass(slots=True)
class Stop:
    """Asks a session to end: at the next safe point, or now."""

    event: threading.Event
    tools: ToolClient | None = None

    def now(self) -> None:
        """Cancels running tool calls. From any thread."""
        self.event.set()
        if self.tools is not None:
            self.tools.cancel_calls()


@dataclass(frozen=True, slots=True)
class RunSession:
    """A session's limits, its watcher, and how it is asked to stop."""

    limits: RunLimits
    watcher: Watcher
    stop: Stop


def begin(root: Path, options: Options, session: RunSession) -> Ended:
    """Begins a run in ``root``, a folder that is new or empty. Raises NoRun; Unusable, then there is no folder."""
    check_inputs(options)
    try:
        is_free = not root.exists() or not any(root.iterdir())
    except OSError as error:
        raise _unusable(root, error) from error
    if not is_free:
        goes_on = f", or continue the run in it: {resume_command(root)}" if (root / NAME).is_file() else "."
        raise NoRun(f"{root} is not empty. Choose another folder{goes_on}")
    return _work(root, session, _beginning(options, session.limits))


def _unusable(root: Path, error: OSError) -> NoRun:
    return NoRun(f"{root} cannot be used as the folder of a run: {error.strerror or error}.")


def _beginning(options: Options, limits: RunLimits) -> RunBegan:
    """What a run is, to be journalled first. Raises NoRun; Unusable where no model or no Blender can be used."""
    try:
        check_model(options, limits.max_cost)
        return RunBegan(
            version=own_version(),
            mode=options.mode,
            prompt=options.prompt,
            source=options.source_text,
            models=_models(options),
            blender=find_blender(options.blender, options.blender_exe).version,
            options=options.model_dump(mode="json"),
        )
    except OverBudget as error:
        raise Unusable(f"{error} The options: --price IN/OUT, --max-cost USD.") from error
    except ModelError as error:
        raise Unusable(f"{error} What needs no key: simworlds demo.") from error
    except CannotStart as error:
        raise Unusable(str(error)) from error


def resume_command(root: Path) -> str:
    """The command that continues the run in ``root``, to be pasted."""
    return f"{own_command()} resume {SYSTEM.quoted(str(root))}"


def resume(root: Path, session: RunSession) -> Ended:
    """Continues the run in ``root``. Raises NoRun."""
    if not (root / NAME).is_file():
        raise NoRun(f"{root} is not a run: it has no {NAME}. 'simworlds runs' lists the runs.")
    ending = read_run_state(root).ending
    if ending and ending.outcome == "done":
        told = f"The run was finished already.{_too_late(session.limits)}"
        return Ended("done", told, root / (ending.file or ""), root / (ending.video or ""))
    return _work(root, session)


def _too_late(limits: RunLimits) -> str:
    """What is said of options for a rendering that is made; "" without any."""
    given = {"--render-minutes": limits.render_minutes, "--samples": limits.samples}
    named = [option for option, value in given.items() if value is not None]
    if not named:
        return ""
    return f" {' and '.join(named)} change{'s' * (len(named) == 1)} nothing of it: what is rendered stays."


def _work(root: Path, session: RunSession, began: RunBegan | None = None) -> Ended:
    """Works on the run in ``root``; ``began`` says what a new one is. Raises NoRun, RunError."""
    root = root.resolve()
    with ExitStack() as stack:
        try:
            root.mkdir(parents=True, exist_ok=True)
            stack.enter_context(locked(root))
        except Refusal as refusal:
            raise NoRun(str(refusal)) from refusal
        except OSError as error:
            raise _unusable(root, error) from error
        journal = Journal(root / NAME)
        stack.callback(journal.close)
        journal.listen(session.watcher.take)
        if began is not None:
            journal.note(began)
        options = _options(journal)
        ended = _with_results(root, _ended(lambda: _run(root, options, journal, session)))
        file, video = _within(root, ended.file), _within(root, ended.shown)
        journal.append(RunEnded(outcome=ended.how, why=ended.why, file=file, video=video))
        return ended


def _ended(run: Callable[[], Ended]) -> Ended:
    """Runs a session; what ends it early becomes its outcome."""
    try:
        return run()
    except (Stopping, OverBudget) as stopping:
        holds = (
            " It holds until 'resume' gets another --max-cost." if isinstance(stopping, OverBudget) else ""
        )
        return Ended("stopped", f"{stopping}{holds}")
    except KeyboardInterrupt:
        return Ended("stopped", "You interrupted the run.")
    except Aborted as aborted:
        return Ended("aborted", str(aborted))
    except Unusable as error:
        return Ended("failed", str(error), again=False)
    except (UserError, OSError) as error:
        helps = f" {_STRONGER}" if isinstance(error, Misfit) else ""
        return Ended("failed", f"{error}{helps}")


def _with_results(root: Path, ended: Ended) -> Ended:
    """However it ended, with the scene and the pictures that there are by now."""
    file, *shown = (path if path.is_file() else None for path in map(root.joinpath, (SCENE, *RESULTS)))
    return replace(ended, file=ended.file or file, shown=ended.shown or next(filter(None, shown), None))


def _run(root: Path, options: Options, journal: Journal, session: RunSession) -> Ended:
    stop, limits = session.stop, session.limits
    journal.append(
        SessionBegan(
            pid=os.getpid(),
            render_minutes=limits.render_minutes,
            render_samples=limits.samples,
            max_minutes=limits.max_minutes,
            max_cost=limits.max_cost,
        )
    )
    repeat_told(options, journal)
    files = RunFiles(root)
    files.checkpoints.mkdir(exist_ok=True)
    setup = _setup(options, files)
    with ExitStack() as stack:
        max_cost = journal.newest(SessionBegan, value=lambda began: began.max_cost)
        pause = stop.event.wait  # asked to stop, nobody waits for an overloaded server
        live = LiveOptions(Spending(max_cost, options.prices), _retrying(session), pause, stack)
        model = make_model(root, options, journal, live)
        client = stack.enter_context(ToolClient(setup, _same_blender(options), session.watcher.progress))
        stop.tools = client
        deadline, position = Deadline(stop.event, limits.max_minutes), Position()
        run = Run(
            options,
            FilmLimits.of(options, limits, journal),
            deadline,
            files,
            journal,
            RunTools(client, journal, files, position, deadline, has_time=options.origin == "replay"),
            model,
            session.watcher.saying,
            position,
        )
        try:
            rendering = (edit if options.mode == "edit" else make)(run)
        except (Stopping, OverBudget):
            if not stop.event.is_set():
                leave(run)
            raise
        finally:
            stop.tools = None
    return Ended("done", "", files.scene, rendering.path)


def _setup(options: Options, files: RunFiles) -> SessionSetup:
    """How the Blender of a run is set up."""
    return SessionSetup(
        best_sandbox(options.sandbox),
        version=options.blender,
        blender_exe=options.blender_exe,
        read=(files.checkpoints, *_readable(options)),
        run=files.of_blender,
        assets=options.assets,
        tell=_LOG.info,
    )


def _models(options: Options) -> dict[str, str]:
    """Role → the model that answers, or answered in the record; none where a transcript was written."""
    match options.origin:
        case "session":
            return {}
        case "replay":
            return dict(read_run_state(Path(options.source)).models)
        case _:
            return {role: options.model_of(role) for role in ROLES}


def _options(journal: Journal) -> Options:
    began = journal.find(RunBegan())
    if began is None:
        raise NoRun(
            f"{journal.path} does not say what the run is: it was killed before it began. Start a new run."
        )
    try:
        return Options.model_validate({**BEFORE_DRAFTS, **began.options})
    except ValidationError as error:
        raise NoRun(f"{journal.path} does not say what the run is to do: {error}") from error


def _readable(options: Options) -> tuple[Path, ...]:
    return (*options.read, *((options.file.parent,) if options.file else ()))


def _same_blender(options: Options) -> list[str]:
    """The options of ``simworlds serve`` for the Blender of this run."""
    given = {"--blender": options.blender, "--blender-exe": options.blender_exe}
    return [word for name, value in given.items() if value is not None for word in (name, str(value))]


def _retrying(session: RunSession) -> Callable[[Retry], object]:
    def tell(retry: Retry) -> None:
        if session.stop.event.is_set():
            raise Stopping("You asked the run to stop.")
        session.watcher.asking_again(retry.ask.role, str(retry))

    return tell


def _within(root: Path, path: Path | None) -> str | None:
    return str(path.relative_to(root)) if path else None
