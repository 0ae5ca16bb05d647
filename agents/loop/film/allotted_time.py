"""How long a film may take: as the user says, else what a session's limit leaves for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.loop.record.events import MendWeighed, PlanMade, RoomTold, SceneRendered
from agents.loop.record.run_state import DEFAULT_RENDER_MINUTES
from simworlds.counting import counted
from simworlds.operating_system import SYSTEM

if TYPE_CHECKING:
    from agents.loop.running.run import Run

_REVIEW_SECONDS = 180.0  # for what follows a film: its review, and saving the result
_REVIEW_SHARE = 0.1  # of the session's limit, which that may take at most
_LEAST_SECONDS = 60.0  # a film always has so long, be it of few frames
_PLANNED_SHARE = 1 / 3  # of the limit, which a film is planned with before it is known what is left
_MENDING_SECONDS = 180.0
_WORTH = 0.5  # of the time that a film took, for which it is rendered anew
_SAMPLES_A_CORE_SECOND = 0.15  # million, of a furnished room
_ROOM = """\
The film may take {minutes} on the {cores} here; no GPU is counted on. In that time Cycles makes some \
{millions:,.0f} million samples (frames × width × height × samples a pixel) of a simple scene, and half as many with \
glass, volumes or many lights. What is planned beyond that is made smaller."""


def _minutes(number: float) -> str:
    return f"{number:g} minute{'s' * (number != 1)}"


def minutes_of(run: Run, ahead: float = 0.0, share: float = 1.0) -> float:
    """How long the film may take.

    Where that is what a limit leaves: ``ahead`` are seconds of work before it, ``share`` is the film's of the rest.
    """
    if run.film_limits.minutes is not None:
        return run.film_limits.minutes
    left, limit = run.deadline.seconds_left, run.deadline.max_minutes
    if left is None or limit is None:
        return DEFAULT_RENDER_MINUTES
    left -= min(_REVIEW_SECONDS, limit * 60 * _REVIEW_SHARE) + ahead
    return round(max(_LEAST_SECONDS, left * share) / 60, 1)


def is_time_to_mend(run: Run, number: int) -> bool:
    """Whether there is time for a coder, and to render the film again that was rendered as the ``number``-th.

    A session that resumes does as was decided before it.
    """
    made, weighed = run.journal.find(SceneRendered(round=number)), run.journal.find(MendWeighed(round=number))
    if weighed is not None:
        return weighed.is_time
    if made is None or made.kind != "animation":
        return True
    if run.film_limits.minutes is not None or run.deadline.seconds_left is None:
        return True
    is_time = minutes_of(run, _MENDING_SECONDS) * 60 >= (made.seconds or 0.0) * _WORTH
    run.journal.note(MendWeighed(round=number, is_time=is_time))
    return is_time


def room_for_film(run: Run) -> str:
    """What a film can have in its time on this machine, in words for who plans it.

    A session that resumes, and a replay, say the same again, also on another machine; "" where the plan was made
    without it.
    """
    if run.journal.find(PlanMade()) is None and run.options.origin != "replay":
        limit = run.deadline.max_minutes
        usual = min(
            DEFAULT_RENDER_MINUTES, round(limit * _PLANNED_SHARE, 1) if limit else DEFAULT_RENDER_MINUTES
        )
        minutes, cores = run.film_limits.minutes or usual, SYSTEM.cores()
        millions = round(minutes * 60 * cores * _SAMPLES_A_CORE_SECOND, -1)
        text = _ROOM.format(minutes=_minutes(minutes), cores=counted(cores, "core"), millions=millions)
        run.journal.note(RoomTold(text=text))
    told = run.journal.find(RoomTold())
    return told.text if told is not None else ""
