"""What the user says of films."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.loop.record.events import SessionBegan

if TYPE_CHECKING:
    from agents.loop.options import Options, RunLimits
    from agents.loop.record.journal import Journal


@dataclass(frozen=True, slots=True)
class FilmLimits:
    """The ``minutes`` that a film may take, and its ``samples`` instead of the plan's; None where nothing is said.

    ``is_news``: this session was told one of them.
    """

    minutes: float | None = None
    samples: int | None = None
    is_news: bool = False

    @classmethod
    def of(cls, options: Options, limits: RunLimits, journal: Journal) -> FilmLimits:
        """What was said last, as the run began or was resumed; ``limits`` are this session's."""
        minutes = journal.newest(SessionBegan, value=lambda began: began.render_minutes)
        samples = journal.newest(SessionBegan, value=lambda began: began.render_samples)
        is_news = limits.render_minutes is not None or limits.samples is not None
        return cls(minutes or options.render_minutes, samples or options.samples, is_news)
