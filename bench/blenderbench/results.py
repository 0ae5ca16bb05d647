"""A folder of results: what made it, and for each task what came of it and how it scored.

OUT/run.json                     which system, on what, with which settings; holds for all that is in it
OUT/level1/TASK/goal.png         a copy, so that scoring needs neither the set nor the system
OUT/level1/TASK/start/           the scene to be edited, alone: what edits it may read its folder
OUT/level1/TASK/renders/01.png   the rounds of the result, oldest first
OUT/level1/TASK/record.json      the task is done: written last, whole or not at all
OUT/level1/TASK/scores.json      its distances and marks; written anew by each scoring
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bench.blenderbench.errors import BadResults
from bench.blenderbench.photometric import Convention
from bench.blenderbench.task_scenes import Rendered
from bench.blenderbench.task_set import LEVELS, in_order
from bench.blenderbench.vlm import Judged
from bench.sweep.records import Provenance
from simworlds.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_Model = TypeVar("_Model", bound=BaseModel)
_Round = Annotated[str, Field(pattern=r"^renders/\d{2,4}\.png$")]


class _Kept(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Setup(_Kept):
    """What a folder of results is made by: a system, with settings of its own, on a set (its folder).

    ``name``: what it is called in tables.
    """

    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._+ -]{0,39}$")
    system: str
    set: str
    settings: dict[str, Any] = Field(default_factory=dict[str, Any])


class Run(_Kept):
    """``run.json``: the setup, the tasks of the set, and how it came to be."""

    setup: Setup
    tasks: tuple[str, ...]
    faults: tuple[str, ...]
    provenance: Provenance


class Record(_Kept):
    """What came of a task. ``why``: it came to nothing (no ``rounds``), and for which reason; it is tried again.

    ``start_loss``: PL of our render of the scene to be edited against the set's own: what machine and Blender make of
    it, before anybody has edited anything. ``inputs``: SHA-256 of the task's files. ``cost``: US dollars, None where a
    price is not known.
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
    """How a task scored, by the round that was ``chosen``.

    What was asked for and could not be scored is None, and ``missing`` says why. ``best_round``: the round was chosen
    by N-CLIP, not the last one. ``clip``: which weights.
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
    judged: Judged | None = None
    clip: dict[str, str | bool] | None = None
    missing: dict[str, str] = Field(default_factory=dict[str, str])
    provenance: Provenance


@dataclass(frozen=True, slots=True)
class Place:
    """A task's folder in the results."""

    root: Path

    @property
    def goal(self) -> Path:
        """The copy of the goal's render."""
        return self.root / "goal.png"

    @property
    def start(self) -> Path:
        """The scene to be edited, in a folder of its own."""
        return self.root / "start" / "start.blend"

    @property
    def start_picture(self) -> Path:
        """Its render."""
        return self.root / "start.png"

    @property
    def started(self) -> Path:
        """Says that both are there."""
        return self.root / "start.json"

    @property
    def edit(self) -> Path:
        """The folder of the edit's run."""
        return self.root / "edit"

    @property
    def record(self) -> Path:
        """What came of it."""
        return self.root / "record.json"

    @property
    def scores(self) -> Path:
        """How it scored."""
        return self.root / "scores.json"

    @property
    def renders(self) -> Path:
        """The folder of the rounds."""
        return self.root / "renders"


def round_file(number: int) -> str:
    """Where the render of a round (from 1) lies, below a task's folder."""
    return f"renders/{number:02}.png"


def place_of(out: Path, task: str) -> Place:
    """The folder of a task, by its id."""
    return Place(out / task)


def records(out: Path) -> Iterator[tuple[Place, Record]]:
    """All tasks that are done, in order. Raises BadResults for a record that is none."""
    for level in LEVELS:
        found = (out / level).glob("*/record.json")
        for path in sorted(found, key=lambda path: in_order(path.parent.name)):
            record = read(path, Record)
            if record.task != f"{level}/{path.parent.name}":
                raise BadResults(f"{path} is the record of {record.task[:100]!r}.")
            yield Place(path.parent), record


def read_run(out: Path) -> Run:
    """What a folder was made by. Raises BadResults."""
    if not (out / "run.json").is_file():
        raise BadResults(f"{out} holds no results: it has no run.json. 'blenderbench run' makes some.")
    return read(out / "run.json", Run)


def read(path: Path, shape: type[_Model]) -> _Model:
    """What is kept in a file. Raises BadResults."""
    try:
        return shape.model_validate_json(path.read_bytes())
    except OSError as error:
        raise BadResults(f"{path} cannot be read: {error.strerror or error}.") from error
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        where = ".".join(map(str, first["loc"])) or "the whole"
        raise BadResults(f"{path} is not what it should be: {where}: {first['msg']}.") from error


def write(path: Path, kept: BaseModel) -> None:
    """Keeps it, whole or not at all. Raises OSError."""
    write_whole(path, kept.model_dump_json(indent=1).encode() + b"\n")
