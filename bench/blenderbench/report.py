"""The paper's table of a folder of results: means a level and over all tasks, and what they stand on."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import fmean
from typing import TYPE_CHECKING, Any

from bench.blenderbench.errors import BadResults
from bench.blenderbench.published import OVERALL, PUBLISHED
from bench.blenderbench.results import Score, read, read_run, records
from bench.blenderbench.score import METRICS
from bench.blenderbench.task_set import LEVELS
from bench.markdown_tables import Table, format_table

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from bench.blenderbench.results import Record, Run

_HEADS = {"pl": "PL↓", "n_clip": "N-CLIP↓", "vlm": "VLM↑"}
_DIGITS = {"paper": 2, "peer": 4}
_NONE = "–"


@dataclass(frozen=True, slots=True)
class Cell:
    """A mean, over how many tasks; None over none."""

    mean: float | None
    tasks: int


@dataclass(frozen=True, slots=True)
class Results:
    """A folder of results, scored. ``rows``: level or ``overall`` → metric → its mean over the tasks scored.

    The overall mean is over tasks, as the paper's; it is not the mean of the levels where these differ in number.
    """

    run: Run
    records: tuple[Record, ...]
    scores: tuple[Score, ...]
    rows: dict[str, dict[str, Cell]]

    @property
    def name(self) -> str:
        """What the system is called."""
        return self.run.setup.name

    @property
    def convention(self) -> str:
        """How distances were taken."""
        return self.scores[0].convention


def read_results(out: Path) -> Results:
    """What a folder holds. Raises BadResults for one that is not scored, or in different ways."""
    run = read_run(out)
    found = list(records(out))
    if unscored := [record.task for place, record in found if not place.scores.is_file()]:
        raise BadResults(f"{out}: {', '.join(unscored)} not scored yet: 'blenderbench score {out}'.")
    scores = tuple(read(place.scores, Score) for place, _ in found)
    if not scores:
        raise BadResults(f"{out} holds no task that is done.")
    ways = {(one.convention, one.best_round, str(one.clip), _judge(one)) for one in scores}
    if len({way[:3] for way in ways}) > 1 or len({way[3] for way in ways if way[3]}) > 1:
        raise BadResults(f"{out}: tasks were scored in different ways. Score them again, all at once.")
    return Results(run, tuple(record for _, record in found), scores, _rows(scores))


def _judge(one: Score) -> tuple[str, str, str] | None:
    judged = one.judged
    return (judged.provider, judged.model, judged.prompt_version) if judged else None


def _rows(scores: Sequence[Score]) -> dict[str, dict[str, Cell]]:
    levels = {level: [one for one in scores if one.level == level] for level in LEVELS}
    rows = {level: of for level, of in levels.items() if of} | {OVERALL: list(scores)}
    return {row: {metric: _cell(metric, of) for metric in METRICS} for row, of in rows.items()}


def _cell(metric: str, scores: Sequence[Score]) -> Cell:
    values = [value for one in scores if (value := getattr(one, metric)) is not None]
    return Cell(fmean(values) if values else None, len(values))


def as_markdown(found: Sequence[Results], *, published: bool = False) -> str:
    """The table, and below it what one has to know to read it. Raises BadResults for what cannot stand side by side."""
    if len({one.convention for one in found}) > 1:
        raise BadResults("Results of both conventions cannot stand in one table. Score them alike.")
    if published and found[0].convention != "paper":
        raise BadResults("The published figures are of the paper's convention. Score without --peer.")
    digits = _DIGITS[found[0].convention]
    systems = [one.name for one in found] + (list(PUBLISHED) if published else [])
    head = ("", *(f"{system} {_HEADS[metric]}" for system in systems for metric in METRICS))
    body = tuple(
        (_label(row), *_figures(found, row, digits), *(_published(row) if published else ()))
        for row in (*LEVELS, OVERALL)
        if any(row in one.rows for one in found)
    )
    notes = "\n".join(f"- {note}" for one in found for note in _notes(one))
    return f"{format_table(Table('BlenderBench', head, body))}\n\n{notes}"


def as_data(found: Sequence[Results]) -> list[dict[str, Any]]:
    """The same for programs."""
    return [
        {
            "system": one.name,
            "setup": one.run.setup.model_dump(mode="json"),
            "convention": one.convention,
            "best_round": one.scores[0].best_round,
            "rows": {
                row: {metric: {"mean": cell.mean, "tasks": cell.tasks} for metric, cell in cells.items()}
                for row, cells in one.rows.items()
            },
            "scores": [score.model_dump(mode="json") for score in one.scores],
            "notes": list(_notes(one)),
        }
        for one in found
    ]


def _label(row: str) -> str:
    return "Overall" if row == OVERALL else f"Level {row[-1]}"


def _figures(found: Sequence[Results], row: str, digits: int) -> Iterator[str]:
    for one in found:
        cells = one.rows.get(row, {})
        of = sum(row in (score.level, OVERALL) for score in one.scores)
        for metric in METRICS:
            cell = cells.get(metric, Cell(None, 0))
            share = "" if cell.tasks in (0, of) else f" ({cell.tasks} of {of})"
            yield _NONE if cell.mean is None else f"{cell.mean:.{digits}f}{share}"


def _published(row: str) -> Iterator[str]:
    for rows in PUBLISHED.values():
        yield from (f"{value:.2f}" for value in rows[row])


def _notes(one: Results) -> Iterator[str]:
    """Of a system: how many tasks, how they were scored, what was not, and what of it a reader has to doubt."""
    first, tasks = one.scores[0], len(one.run.tasks)
    done = len(one.scores)
    yield f"{one.name}: {done} of {tasks} tasks; {_rule(first)}"
    if one.run.faults:
        yield f"{one.name}: {len(one.run.faults)} tasks of the set cannot be used: {' '.join(one.run.faults)}"
    losses = [record.start_loss for record in one.records if record.start_loss is not None]
    if losses:
        yield (
            f"{one.name}: scenes as they start, rendered here, differ from the set's own renders by PL "
            f"{fmean(losses):.2f} on average and {max(losses):.2f} at most: so much is not the system's"
        )
    if spent := list(_spent(one)):
        yield f"{one.name}: cost {', '.join(spent)}"
    if first.clip is not None and not first.clip["openai"]:
        yield f"{one.name}: N-CLIP has other weights than OpenAI's: {first.clip['source']}"
    for score in one.scores:
        for why in dict.fromkeys(score.missing.values()):
            names = ", ".join(_HEADS[metric][:-1] for metric in METRICS if score.missing.get(metric) == why)
            yield f"{one.name}: {score.task} has no {names}: {why}"


def _spent(one: Results) -> Iterator[str]:
    """What models cost, as far as prices are known."""
    judged = [score.judged.spent.cost for score in one.scores if score.judged]
    for what, costs in (("the edits", [record.cost for record in one.records]), ("the marks", judged)):
        known = [cost for cost in costs if cost is not None]
        if sum(known):
            yield f"${sum(known):.2f} for {what} of {len(known)} tasks"


def _rule(first: Score) -> str:
    sides = {"paper": "at the goal's size, × 100", "peer": "at the render's size, not × 100"}
    rounds = "the round that N-CLIP likes best counts" if first.best_round else "the last round counts"
    judge = f"; marks by {first.judged.model}, wording {first.judged.prompt_version}" if first.judged else ""
    return f"distances {sides[first.convention]}; {rounds}{judge}"
