"""The interface of systems that edit scenes, their output, and the scene that they start from."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

from pydantic import BaseModel, ConfigDict

from bench.blenderbench.errors import TaskFailed, UnreadableRender
from bench.blenderbench.photometric import photometric_loss
from bench.blenderbench.pictures import read_picture
from bench.blenderbench.results import read, write
from bench.blenderbench.task_scenes import EditRenderSettings, Rendered, make_start, render

if TYPE_CHECKING:
    from collections.abc import Callable

    from bench.blenderbench.results import TaskFolder
    from bench.blenderbench.task_set import BenchTask

    Tell = Callable[[str], object]


@dataclass(frozen=True, slots=True)
class EditOutput:
    """A system's result for a task. ``rounds``: files below the task's folder, oldest first. Others: see TaskRecord."""

    rounds: tuple[str, ...]
    start_loss: float | None = None
    rendered: Rendered | None = None
    models: dict[str, str] = field(default_factory=dict[str, str])
    cost: float | None = 0.0
    notes: tuple[str, ...] = ()


class EditSystem(Protocol):
    """A system that edits scenes."""

    @property
    def kind(self) -> str:
        """Its name on the command line."""
        ...

    @property
    def name(self) -> str:
        """Its default name in tables."""
        ...

    @property
    def settings(self) -> dict[str, Any]:
        """Everything that its results depend on."""
        ...

    @property
    def takes_over(self) -> bool:
        """Whether it only copies results of others, which may have changed: it then runs every time."""
        ...

    def make(self, task: BenchTask, place: TaskFolder, tell: Tell) -> EditOutput:
        """Edits a scene and returns its renders. Raises TaskFailed, EditSystemNotReady, CannotStart."""
        ...


class PreparedStart(BaseModel):
    """A start scene: how it was rendered, and in words what could not be packed."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    rendered: Rendered
    notes: tuple[str, ...]


def prepare_start(
    task: BenchTask, place: TaskFolder, rendering: EditRenderSettings, tell: Tell
) -> tuple[PreparedStart, float | None]:
    """Makes the start scene if it is missing. Returns it, and the PL of its render against the set's own, if there is
    one. Raises TaskFailed.
    """
    if place.started.is_file():
        started = read(place.started, PreparedStart)
    else:
        tell("running start.py")
        place.start.parent.mkdir(exist_ok=True)
        notes = make_start(task, place.start, rendering)
        tell("rendering the start")
        started = PreparedStart(
            rendered=render(place.start, place.start_picture, task.size, rendering),
            notes=notes,
        )
        write(place.started, started)
    if task.start is None:
        return started, None
    try:
        return started, photometric_loss(read_picture(place.start_picture), read_picture(task.start))
    except UnreadableRender as error:
        raise TaskFailed(str(error)) from error
