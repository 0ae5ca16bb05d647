"""The list of runs, and the state of one."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from agents.blender.launch import runs_folder
from agents.loop.errors import NoRun
from agents.loop.record.elsewhere import runs_elsewhere
from agents.loop.record.events import RunEnded
from agents.loop.record.journal import NAME
from agents.loop.record.reducer import read_run_state
from agents.loop.record.run_state import RunState
from agents.views.rich_views import run_summary, runs_table

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table


FILM = "animation"  # what blender_render calls a film's frames


def list_runs() -> Table:
    """All runs of the runs' folder that have a journal, newest first; of one that cannot be read, just that."""
    dated: list[tuple[float, Path]] = []
    for path in runs_folder().glob(f"*/{NAME}"):
        with suppress(OSError):  # it has just been removed
            dated.append((path.stat().st_mtime, path.parent))
    return runs_table((run.name, _known_of(run)) for _, run in sorted(dated, reverse=True))


def list_elsewhere() -> Table:
    """The runs in other folders, by their paths, newest first."""
    return runs_table(((str(root), _known_of(root)) for root in runs_elsewhere()), by_path=True)


def run_named(name: str) -> Path | None:
    """The run that is listed by this name, unless the name is the path of a run; None if there is no such run."""
    path = runs_folder() / name
    is_listed = path.parent == runs_folder() and (path / NAME).is_file()
    return path if is_listed and not (Path(name) / NAME).is_file() else None


def _known_of(run: Path) -> RunState:
    try:
        return read_run_state(run)
    except NoRun:
        return RunState(ending=RunEnded(outcome="unreadable"))


def shown(run: Path) -> RenderableType:
    """How a run stands. Raises NoRun."""
    if not (run / NAME).is_file():
        raise NoRun(f"{run} is not a run: it has no {NAME}. 'simworlds runs' lists the runs.")
    state = read_run_state(run)
    frames = run / "blender" / "frames" / FILM
    return run_summary(state, sum(1 for _ in frames.glob("*.png")) if state.film else 0)
