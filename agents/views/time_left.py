"""How long the rest of a run may take: by the stages that are done, and by what is known of its film."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.loop.record.run_state import ToolCall
from agents.loop.running.run_tools import RENDER
from agents.views.formatting import format_time

if TYPE_CHECKING:
    from agents.loop.record.run_state import RunState
    from agents.plan.part import Stage
    from agents.views.now import Now

_RENDER: Stage = "render"
_ENOUGH = 0.2  # of the stages have to be done before it can be told how long the rest takes
_AT_LEAST = 0.2  # of a stage is always left
_ENOUGH_FRAMES = 0.05  # of a film have to be there before they tell how long the rest takes


def describe_time_left(run_state: RunState, now: Now) -> str:
    """``about 5 min left, and at most 20 min for the film``; "" where nothing is known, or nothing is left."""
    film = film_left(run_state, now)
    left = seconds_left(run_state, now.seconds - run_state.seconds)
    if film is not None and run_state.film:
        return f"about {_rounded(film + (left or 0.0))} left"
    stages = f"about {_rounded(left)} left" if left is not None else ""
    budget = f"at most {_rounded(film)} for the film" if film is not None else ""
    return ", and ".join(filter(None, (stages, budget)))


def _rounded(seconds: float) -> str:
    step = 60 if seconds >= 90 else 10  # it is no more exact than that
    return format_time(max(1, round(seconds / step)) * step)


def seconds_left(run_state: RunState, since: float = 0.0) -> float | None:
    """How long the rest may take if its stages are like those that are done, ``since`` seconds after the last row.

    A stage that is under way longer than those is taken to be nearly done; the others still take their time. A film
    that is still to come is not in it: see ``film_left``. None while that would be no more than a guess.
    """
    if run_state.ending or not _ENOUGH <= run_state.share_done < 1:
        return None
    closed = [stage.seconds for stage in run_state.stages if stage.state == "closed"]
    own = [name for name in run_state.planned if name != _RENDER or run_state.film_seconds is None]
    waiting = sum(run_state.state_of(name) == "waiting" for name in own)
    each = sum(closed) / len(closed)
    current = run_state.current
    if current is None or current.name not in own:
        return each * waiting if waiting else None
    return each * waiting + max(each * _AT_LEAST, each - current.seconds - since)


def film_left(run_state: RunState, now: Now) -> float | None:
    """Seconds of a film that is still to be rendered: by its frames once there are some, else as it was fitted.

    None without one; before it is fitted, the most that it may take.
    """
    whole = run_state.film_seconds
    if whole is None or run_state.ending:
        return None
    progress = now.progress.get(RENDER)
    if (
        run_state.film is None
        or progress is None
        or progress.total != run_state.film.frames
        or not run_state.film.frames
    ):
        return whole
    share = min(1.0, max(0.0, progress.done / run_state.film.frames))
    pending = (step for step in run_state.pending if isinstance(step, ToolCall) and step.name == RENDER)
    began = next((step.began for step in pending), None)
    worked = 0.0 if began is None else now.seconds - began  # 0 where another process renders: nothing tells
    return worked * (1 - share) / share if worked > 1 and share >= _ENOUGH_FRAMES else whole * (1 - share)
