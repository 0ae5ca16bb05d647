"""Who answers for the roles in a sitting: what the journal has heard already, then a live model or another record."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agents.loop.errors import NoRun
from agents.loop.journal import NAME, read_rows
from simworlds.llm.claude import Claude
from simworlds.llm.recorded import Recorded, Recording, read_turns
from simworlds.llm.spending import Metered

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from contextlib import ExitStack

    from agents.loop.journal import Journal, Row
    from agents.loop.options import Options
    from simworlds.llm.messages import Model
    from simworlds.llm.retries import Retry
    from simworlds.llm.spending import Spending

_MODEL = ("model.asked", "model.answered")
SESSIONS = Path(str(files("agents") / "sessions"))


@dataclass(frozen=True, slots=True)
class Line:
    """The line to a live model: ``tell`` hears of every retry, ``pause`` waits before it, ``closing`` ends it."""

    spending: Spending
    tell: Callable[[Retry], object]
    pause: Callable[[float], object]
    closing: ExitStack


def answering(root: Path, options: Options, journal: Journal, line: Line) -> Model:
    """The model of a sitting; its answers are journalled, and counted where they are paid for.

    Raises ModelError (no key, a record that is none), NoRun.
    """
    for one in read_turns(journal.rows):
        if one.turn.live:
            line.spending.carry(one.role, one.stage, one.turn)
    rows = _led_on(journal.rows)
    folders = {str(root): "run"}
    skip = Counter((one.role, one.stage) for one in read_turns(rows))
    source = _source(options, folders, skip, line)
    first = max((row["n"] for row in journal.rows if row["type"] in _MODEL), default=0) + 1
    return Recorded(
        rows, folders=folders, then=Recording(source, journal.append, folders=folders, first=first)
    )


def _led_on(rows: Iterable[Row]) -> list[Row]:
    """A journal's questions and answers, but for answers over which a sitting failed: to go on is to ask anew."""
    kept: list[Row] = []
    first = 0  # of those in kept between which nothing else was written
    for row in rows:
        if row["type"] in _MODEL:
            kept.append(row)
            continue
        last = kept[-1] if kept[first:] else {}
        if (row["type"], row.get("outcome"), last.get("type")) == ("run.ended", "failed", "model.answered"):
            del kept[first:]
        first = len(kept)
    return kept


def _source(
    options: Options,
    folders: dict[str, str],
    skip: Mapping[tuple[str, str], int],
    line: Line,
) -> Model:
    match options.origin:
        case "session":
            return Recorded(SESSIONS / options.source, skip=skip)
        case "replay":
            other = Path(options.source)
            rows = _led_on(read_rows(other / NAME))
            return Recorded(rows, folders=folders | {str(other): "run"}, skip=skip)
        case _:

            def told(retry: Retry) -> Any:
                line.spending.before_retry(retry)
                line.tell(retry)

            claude = Claude(tell=told, pause=line.pause)
            line.closing.callback(claude.close)
            return Metered(claude, line.spending)


def sessions() -> list[str]:
    """The names of the sessions that come with the package."""
    return sorted(path.parent.name for path in SESSIONS.glob("*/session.toml"))


def session_folder(name: str) -> Path:
    """The folder of one. Raises NoRun."""
    if name not in sessions():
        raise NoRun(f"There is no session {name!r}; there are {', '.join(sessions())}.")
    return SESSIONS / name
