"""Makes the frames that are missing, one after the other, until they are there or something ends it."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Protocol

from agents.blender.render.frame_cache import Made
from simworlds.sandbox.errors import BlenderError, Interrupted

if TYPE_CHECKING:
    from pathlib import Path

    from agents.blender.render.frame_renderer import Shoot
    from agents.blender.render.render_budget import Pace
    from agents.blender.tools.base import Call


class Place(Protocol):
    """Where frames go: a Reel, or a Single."""

    def path(self, frame: int) -> Path:
        """The file of a frame."""
        ...

    def made(self, frame: int) -> Made | None:
        """How it was made; None if it is not there."""
        ...

    def add(self, frame: int, made: Made) -> None:
        """It is there now."""
        ...


class Single:
    """The place of a still, which is made afresh every time."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._made: Made | None = None
        path.parent.mkdir(parents=True, exist_ok=True)

    def path(self, frame: int) -> Path:
        """Always the same."""
        del frame
        return self._path

    def made(self, frame: int) -> Made | None:
        """How it was made; None if it is not there yet."""
        del frame
        return self._made

    def add(self, frame: int, made: Made) -> None:
        """It is there now."""
        del frame
        self._made = made


@dataclass(slots=True)
class Taken:
    """Frames: ``made`` now, ``kept`` from before, ``dropped`` for the time budget, ``missing`` because of ``stopped``.

    ``seconds`` is what all of it took, ``each`` what a frame took that was made now (None without one).
    """

    made: list[int] = field(default_factory=list[int])
    kept: list[int] = field(default_factory=list[int])
    dropped: list[int] = field(default_factory=list[int])
    missing: list[int] = field(default_factory=list[int])
    stopped: str = ""
    seconds: float = 0.0
    each: float | None = None

    @property
    def there(self) -> list[int]:
        """All that can be seen."""
        return sorted({*self.made, *self.kept})


def take(shoot: Shoot, place: Place, frames: list[int], call: Call, pace: Pace | None) -> Taken:
    """Makes the ``frames`` that are not there. Raises BlenderError when not a single one can be had."""
    asked: int | None = shoot.shot["samples"]
    taken, todo = Taken(), list[int]()
    for frame in frames:
        (taken.kept if _stands(place.made(frame), asked, pace is not None) else todo).append(frame)
    started = time.monotonic()

    def make(frame: int, samples: int | None, *, trial: bool = False) -> float:
        done = len(frames) - len(todo) - len(taken.dropped)
        seconds = shoot.frame(frame, samples, place.path(frame), done, len(frames))
        size = place.path(frame).stat().st_size
        place.add(frame, Made(samples, round(seconds, 3), size, trial))
        if call.progress is not None and not trial:
            call.progress(done + 1, len(frames), f"frame {frame}, {seconds:.1f} s")
        return seconds

    try:
        if pace is not None and todo:
            while (few := pace.trial(len(todo))) is not None:
                pace.tried(few, make(todo[0], few, trial=True))
        while todo and not call.given_up.is_set():
            samples = asked
            if pace is not None:
                pace.settle(len(todo))
                samples = pace.samples
            frame = todo[0]
            tried = place.made(frame)
            if tried is not None and tried.trial and (tried.samples or 0) >= (samples or 0):
                place.add(frame, replace(tried, trial=False))
            elif pace is not None and _thin(pace, todo, taken):
                continue
            else:
                seconds = make(frame, samples)
                if pace is not None:
                    pace.took(samples, seconds)
            taken.made.append(todo.pop(0))
        if todo:
            taken.stopped = "it was given up"
    except BlenderError as error:
        if not taken.there and not isinstance(error, Interrupted):
            raise
        taken.stopped = "it was given up" if isinstance(error, Interrupted) else str(error)
    taken.missing = todo
    taken.seconds = time.monotonic() - started
    spent = [made.seconds for frame in taken.made if (made := place.made(frame))]
    taken.each = sum(spent) / len(spent) if spent else None
    return taken


def _thin(pace: Pace, todo: list[int], taken: Taken) -> bool:
    """Leaves out the frames for which there is no time; whether there are any. One frame is made in any case."""
    every = pace.every(len(todo))
    if every == 1:
        return False
    begin = every - 1 if taken.there else 0
    stay = todo[begin::every] if every else todo[: not taken.there]
    dropped = sorted({*todo} - {*stay})
    taken.dropped += dropped
    todo[:] = stay
    return bool(dropped)


def _stands(made: Made | None, samples: int | None, hurried: bool) -> bool:
    """Whether a frame that is there will do: one of fewer samples only where time is short this time, too."""
    if made is None or made.trial:
        return False
    return hurried or samples is None or (made.samples or 0) >= samples
