"""Renders the missing frames one by one, until all are there or something ends the call."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from agents.blender.render.frame_cache import RenderedFrame
from simworlds.sandbox.errors import BlenderError, Interrupted

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

    from agents.blender.render.frame_cache import FrameCache
    from agents.blender.render.frame_renderer import FrameRenderer
    from agents.blender.render.render_budget import RenderBudget
    from agents.blender.tools.base import Call


# Of a frame's progress: what each trial fills, after which the frame itself begins; where that ends, as it is then
# stored and measured.
_OF_A_TRIAL, _OF_A_FRAME = 0.02, 0.95


class StillStore:
    """The one file of a still, which every call renders anew."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._frame: RenderedFrame | None = None
        path.parent.mkdir(parents=True, exist_ok=True)

    def path(self, number: int) -> Path:
        """The file, whatever the frame."""
        del number
        return self._path

    def get(self, number: int) -> RenderedFrame | None:
        """How it was made; None if it is not here yet."""
        del number
        return self._frame

    def add(self, number: int, frame: RenderedFrame) -> None:
        """Notes that the file has been written."""
        del number
        self._frame = frame


@dataclass(slots=True)
class RenderOutcome:
    """Numbers of frames: ``made`` now, ``kept`` from before, ``dropped`` for the time budget, ``missing``.

    ``stopped`` says why some are missing. ``seconds`` is the time of the whole loop, ``frame_seconds`` the mean of the
    frames made now (None without one).
    """

    made: list[int] = field(default_factory=list[int])
    kept: list[int] = field(default_factory=list[int])
    dropped: list[int] = field(default_factory=list[int])
    missing: list[int] = field(default_factory=list[int])
    stopped: str = ""
    seconds: float = 0.0
    frame_seconds: float | None = None

    @property
    def available(self) -> list[int]:
        """All frames that are on disk."""
        return sorted({*self.made, *self.kept})


def render_frames(  # noqa: PLR0913 - what to render, with what, in which time
    renderer: FrameRenderer,
    store: FrameCache | StillStore,
    frames: list[int],
    call: Call,
    budget: RenderBudget | None,
    *,
    telling: Collection[int] = (),
) -> RenderOutcome:
    """Renders those of ``frames`` that are not in ``store``. Raises BlenderError when there is not a single one.

    Where time is short, those that are ``telling`` are left out last.
    """
    wanted: int | None = renderer.shot.samples
    outcome, todo = RenderOutcome(), list[int]()
    for number in frames:
        reusable = _is_reusable(store.get(number), wanted, budget is not None)
        (outcome.kept if reusable else todo).append(number)
    started = time.monotonic()

    tried = 0.0  # what trials have filled of the first frame's progress

    def render(number: int, samples: int | None, *, trial: bool = False) -> float:
        nonlocal tried
        done = len(frames) - len(todo) - len(outcome.dropped)
        span = (done + tried, done + (tried + _OF_A_TRIAL if trial else _OF_A_FRAME))
        tried = span[1] - done if trial else 0.0
        seconds = renderer.render(number, samples, store.path(number), span, len(frames))
        size = store.path(number).stat().st_size
        store.add(number, RenderedFrame(samples, round(seconds, 3), size, trial))
        if call.progress is not None and not trial:
            call.progress(done + 1, len(frames), f"frame {number}, {seconds:.1f} s")
        return seconds

    try:
        if budget is not None and todo:
            while (few := budget.next_trial(len(todo))) is not None:
                budget.add_trial(few, render(todo[0], few, trial=True))
        while (todo := todo or _taken_up_again(budget, outcome, telling)) and not call.cancelled.is_set():
            samples = wanted
            if budget is not None:
                budget.fit_samples(len(todo) + len(outcome.dropped))
                samples = budget.samples
            number = todo[0]
            trial = store.get(number)
            if trial is not None and trial.trial and (trial.samples or 0) >= (samples or 0):
                store.add(number, replace(trial, trial=False))
            elif budget is not None and _drop_frames(budget, todo, outcome, telling):
                continue
            else:
                seconds = render(number, samples)
                if budget is not None:
                    budget.add_frame(samples, seconds)
            outcome.made.append(todo.pop(0))
        if todo:
            outcome.stopped = "the call was cancelled"
    except BlenderError as error:
        if not outcome.available and not isinstance(error, Interrupted):
            raise
        outcome.stopped = "the call was cancelled" if isinstance(error, Interrupted) else str(error)
    outcome.missing = todo
    outcome.seconds = time.monotonic() - started
    seconds = [frame.seconds for number in outcome.made if (frame := store.get(number))]
    outcome.frame_seconds = sum(seconds) / len(seconds) if seconds else None
    return outcome


def _drop_frames(
    budget: RenderBudget, todo: list[int], outcome: RenderOutcome, telling: Collection[int]
) -> bool:
    """Drops the frames for which there is no time, evenly, ``telling`` ones last; whether there are any.

    At least one frame is rendered.
    """
    count = budget.affordable(len(todo))
    if count == len(todo):
        return False
    is_first = not outcome.available
    stay = _chosen(todo, max(count, int(is_first)), telling, with_first=is_first)
    outcome.dropped += sorted({*todo} - {*stay})
    todo[:] = stay
    return True


def _taken_up_again(
    budget: RenderBudget | None, outcome: RenderOutcome, telling: Collection[int]
) -> list[int]:
    """Dropped frames for which there turned out to be time: ``telling`` ones first, then evenly from all."""
    if budget is None or not outcome.dropped:
        return []
    dropped = sorted(outcome.dropped)
    again = _chosen(dropped, budget.surely_affordable(len(dropped)), telling, with_first=False)
    outcome.dropped = sorted({*dropped} - {*again})
    return again


def _chosen(frames: list[int], count: int, telling: Collection[int], *, with_first: bool) -> list[int]:
    """So many of the frames, in order: those that are ``telling``, and evenly of the others."""
    needed = [frame for frame in frames if frame in telling or (with_first and frame == frames[0])]
    if len(needed) >= count:
        return _spread(needed, count, with_first=with_first)
    others = [frame for frame in frames if frame not in needed]
    return sorted([*needed, *_spread(others, count - len(needed), with_first=False)])


def _spread(frames: list[int], count: int, *, with_first: bool) -> list[int]:
    """So many of the frames, evenly apart."""
    if with_first:
        return [frames[place * len(frames) // count] for place in range(count)]
    return [frames[-(-(place + 1) * len(frames) // count) - 1] for place in range(count)]


def _is_reusable(frame: RenderedFrame | None, samples: int | None, hurried: bool) -> bool:
    """Whether a frame from before will do; with fewer samples only if this call has a time budget too."""
    if frame is None or frame.trial:
        return False
    return hurried or samples is None or (frame.samples or 0) >= samples
