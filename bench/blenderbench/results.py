"""A folder of results: its system and settings, and the record and scores of each task.

OUT/run.json                     the system, the set and the settings of all results
OUT/level1/TASK/goal.png         a copy, so that scoring needs neither set nor system
OUT/level1/TASK/start/           the scene to be edited, in a folder of its own that the system may read
OUT/level1/TASK/renders/01.png   the rounds of the edit, oldest first
OUT/level1/TASK/record.json      written last: the task has ended
OUT/level1/TASK/scores.json      distances and marks; rewritten by each scoring
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bench.blenderbench.errors import BadResults
from bench.blenderbench.photometric import Convention
from bench.blenderbench.task_scenes import Rendered
from bench.blenderbench.task_set import LEVELS, natural_key
from bench.blenderbench.vlm import EditJudgement
from bench.sweep.records import Provenance
from simworlds.files import write_whole
from simworlds.schemas.faults import first_fault

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_Model = TypeVar("_Model", bound=BaseModel)
_Round = Annotated[str, Field(pattern=r"^renders/\d{2,4}\.png$")]


class _Kept(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class RunSetup(_Kept):
    """The system of a folder of results, its settings, and the set (a folder).

    ``name``: of the system in tables.
    """

    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._+ -]{0,39}$")
    system: str
    set: str
    settings: dict[str, Any] = Field(default_factory=dict[str, Any])


class SetRun(_Kept):
    """``run.json``: the setup, the tasks of the set and their faults, the provenance."""

    setup: RunSetup
    tasks: tuple[str, ...]
    faults: tuple[str, ...]
    provenance: Provenance


class TaskRecord(_Kept):
    """The record of a task. ``why``: the reason why it failed (then it has no ``rounds``, and is tried again).

    ``start_loss``: PL of our render of the start scene against the set's own: the effect of machine and Blender before
    any edit. ``inputs``: SHA-256 of the task's files. ``cost``: US dollars, None where a
    price is unknown.
    """

    task: str
    level: str
    instruction: str
    why: str | None = None
    rounds: tuple[_Round, ...] = ()
    start_loss: float | None = None
    rendered: Rendered | None = None
    models: dict[str, str] = Field(default_factory=dict[str, str])
    cost: float | None = None
    seconds: float
    notes: tuple[str, ...] = ()
    inputs: dict[str, str]
    provenance: Provenance


class RoundScore(_Kept):
    """The distances of one round. ``n_clip`` is None where no weights were named."""

    file: str
    pl: float
    n_clip: float | None = None


class Score(_Kept):
    """The scores of a task, by the round that was ``chosen``.

    A requested score that is missing is None; ``missing`` says why. ``best_round``: it was chosen by N-CLIP, else
    it is the last one. ``clip``: the weights.
    """

    task: str
    level: str
    convention: Convention
    best_round: bool
    rounds: tuple[RoundScore, ...] = ()
    chosen: str | None = None
    pl: float | None = None
    n_clip: float | None = None
    vlm: float | None = None
    judged: EditJudgement | None = None
    clip: dict[str, str | bool] | None = None
    missing: dict[str, str] = Field(default_factory=dict[str, str])
    provenance: Provenance


class TaskFolder:
    """The paths of a task's folder in the results."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.goal = root / "goal.png"  # the copy of the goal's render
        self.start = root / "start" / "start.blend"  # the start scene, in a folder of its own
        self.start_picture = root / "start.png"
        self.started = root / "start.json"  # written when both exist
        self.edit = root / "edit"  # the folder of the edit's run
        self.record = root / "record.json"
        self.scores = root / "scores.json"
        self.renders = root / "renders"  # the rounds


def round_file(number: int) -> str:
    """The render of a round (from 1), relative to the task's folder."""
    return f"renders/{number:02}.png"


def task_folder(out: Path, task: str) -> TaskFolder:
    """The folder of a task, by its id."""
    return TaskFolder(out / task)


def records(out: Path) -> Iterator[tuple[TaskFolder, TaskRecord]]:
    """All tasks that have ended, in order. Raises BadResults for an invalid record."""
    for level in LEVELS:
        paths = (out / level).glob("*/record.json")
        for path in sorted(paths, key=lambda path: natural_key(path.parent.name)):
            record = read(path, TaskRecord)
            if record.task != f"{level}/{path.parent.name}":
                raise BadResults(f"{path} is the record of {record.task[:100]!r}.")
            yield TaskFolder(path.parent), record


def read_run(out: Path) -> SetRun:
    """Reads ``run.json``. Raises BadResults."""
    if not (out / "run.json").is_file():
        raise BadResults(f"{out} has no results: there is no run.json. Make some with 'blenderbench run'.")
    return read(out / "run.json", SetRun)


def read(path: Path, shape: type[_Model]) -> _Model:
    """Reads a model from a file. Raises BadResults."""
    try:
        return shape.model_validate_json(path.read_bytes())
    except OSError as error:
        raise BadResults(f"{path} cannot be read: {error.strerror or error}.") from error
    except ValidationError as error:
        raise BadResults(f"{path} is not valid: {first_fault(error, whole='the file')}.") from error


def write(path: Path, kept: BaseModel) -> None:
    """Writes a model to a file, whole or not at all. Raises OSError."""
    write_whole(path, kept.model_dump_json(indent=1).encode() + b"\n")
