"""The model of a session: it plays back what the journal holds, then asks a live model or another record."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agents.loop.errors import NoRun
from agents.loop.record.events import MendWeighed, RoomTold, TimeTold, read_event
from agents.loop.record.journal import NAME, read_rows
from agents.roles.names import ROLES
from simworlds.llm.apis.attempts import Settings
from simworlds.llm.apis.providers import connect
from simworlds.llm.errors import OverBudget
from simworlds.llm.records.recorded import Recorded, Recording, read_turns
from simworlds.llm.spending import Metered, no_price

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from contextlib import ExitStack

    from agents.loop.options import Options
    from agents.loop.record.journal import Journal, Row
    from simworlds.llm.apis.retries import Retry
    from simworlds.llm.messages import Model
    from simworlds.llm.spending import Spending

_MODEL = ("model.asked", "model.answered")
_OF_TIME = (RoomTold, TimeTold, MendWeighed)
TRANSCRIPTS = Path(str(files("agents") / "transcripts"))


@dataclass(frozen=True, slots=True)
class LiveOptions:
    """What a live model needs: ``tell`` gets each retry, ``pause`` waits before it, ``closing`` ends it."""

    spending: Spending
    tell: Callable[[Retry], object]
    pause: Callable[[float], object]
    closing: ExitStack


def check_model(options: Options, max_cost: float | None) -> None:
    """Raises ModelError if a live model is to answer, and could not be asked: a key or a package is missing, or the
    price that a limit of cost needs.
    """
    if options.origin != "live":
        return
    connect(options.provider, Settings(prices=options.prices)).close()
    if max_cost is not None:
        for model in map(options.model_of, ROLES):
            if options.prices.of(model) is None:
                raise OverBudget(no_price(model, max_cost))


def make_model(root: Path, options: Options, journal: Journal, live: LiveOptions) -> Model:
    """The model of a session; its answers are journalled, and counted where they are paid for.

    Raises ModelError (no key, a broken record), NoRun.
    """
    for answer in read_turns(journal.rows):
        if answer.turn.live:
            live.spending.carry(answer.role, answer.stage, answer.turn)
    rows = _without_failed_end(journal.rows)
    folders = {str(root): "run"}
    skip = Counter((answer.role, answer.stage) for answer in read_turns(rows))
    source = _source(options, folders, skip, live)
    first = max((row["n"] for row in journal.rows if row["type"] in _MODEL), default=0) + 1
    return Recorded(
        rows, folders=folders, then=Recording(source, journal.append_row, folders=folders, first=first)
    )


def _without_failed_end(rows: Iterable[Row]) -> list[Row]:
    """A journal's questions and answers, without an answer on which a session failed: resuming asks again."""
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
    live: LiveOptions,
) -> Model:
    match options.origin:
        case "session":
            return Recorded(TRANSCRIPTS / options.source, skip=skip)
        case "replay":
            other = Path(options.source)
            rows = _without_failed_end(read_rows(other / NAME))
            return Recorded(rows, folders=folders | {str(other): "run"}, skip=skip)
        case _:

            def on_retry(retry: Retry) -> Any:
                live.spending.before_retry(retry)
                live.tell(retry)

            model = connect(options.provider, Settings(prices=options.prices), on_retry, pause=live.pause)
            live.closing.callback(model.close)
            return Metered(model, live.spending)


def repeat_told(options: Options, journal: Journal) -> None:
    """Notes what the roles of a replayed run were told of time, which a replay tells again: on any machine, and within
    any limit. Raises NoRun.
    """
    if options.origin != "replay":
        return
    for event in map(read_event, read_rows(Path(options.source) / NAME)):
        if isinstance(event, _OF_TIME):
            journal.note(event)


def transcripts() -> list[str]:
    """The names of the transcripts that come with the package."""
    return sorted(path.parent.name for path in TRANSCRIPTS.glob("*/session.toml"))


def transcript_folder(name: str) -> Path:
    """The folder of a transcript. Raises NoRun."""
    if name not in transcripts():
        raise NoRun(f"There is no demo {name!r}. Choose one of {', '.join(transcripts())}.")
    return TRANSCRIPTS / name
