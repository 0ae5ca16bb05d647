"""What a system is, what it makes of a task, and the scene that it begins with."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

from pydantic import BaseModel, ConfigDict

from bench.blenderbench.errors import BadPicture, NotDone
from bench.blenderbench.photometric import photometric_loss
from bench.blenderbench.pictures import read_picture
from bench.blenderbench.results import read, write
from bench.blenderbench.task_scenes import Rendered, RenderSettings, make_start, render

if TYPE_CHECKING:
    from collections.abc import Callable

    from bench.blenderbench.results import Place
    from bench.blenderbench.task_set import Task

    Tell = Callable[[str], object]


@dataclass(frozen=True, slots=True)
class Made:
    """What a system made of a task: ``rounds`` below the task's folder, oldest first. See Record for the rest."""

    rounds: tuple[str, ...]
    start_loss: float | None = None
    rendered: Rendered | None = None
    models: dict[str, str] = field(default_factory=dict[str, str])
    cost: float | None = 0.0
    notes: tuple[str, ...] = ()


class System(Protocol):
    """Whom tasks are given to."""

    @property
    def kind(self) -> str:
        """What it is asked for as."""
        ...

    @property
    def name(self) -> str:
        """What tables call it, unless they are told otherwise."""
        ...

    @property
    def settings(self) -> dict[str, Any]:
        """All that its results depend on."""
        ...

    @property
    def takes_over(self) -> bool:
        """Whether it only takes over what others made, and so may have changed: that is done anew each time."""
        ...

    def make(self, task: Task, place: Place, tell: Tell) -> Made:
        """Renders of the edited scene. Raises NotDone, NotReady, CannotStart."""
        ...


class Started(BaseModel):
    """A scene to be edited was made: how it was rendered, and in words what did not come along."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    rendered: Rendered
    notes: tuple[str, ...]


def begun(task: Task, place: Place, rendering: RenderSettings, tell: Tell) -> tuple[Started, float | None]:
    """The scene to be edited, unless it is there already, and how far its render is from the set's own."""
    if place.started.is_file():
        started = read(place.started, Started)
    else:
        tell("running start.py")
        place.start.parent.mkdir(exist_ok=True)
        notes = make_start(task, place.start, rendering)
        tell("rendering the start")
        started = Started(
            rendered=render(place.start, place.start_picture, task.size, rendering),
            notes=notes,
        )
        write(place.started, started)
    if task.start is None:
        return started, None
    try:
        return started, photometric_loss(read_picture(place.start_picture), read_picture(task.start))
    except BadPicture as error:
        raise NotDone(str(error)) from error
