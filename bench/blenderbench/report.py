"""The paper's table for folders of results: means by level and over all tasks, with notes on their basis."""

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

    from bench.blenderbench.results import SetRun, TaskRecord

_HEADS = {"pl": "PL↓", "n_clip": "N-CLIP↓", "vlm": "VLM↑"}
_DIGITS = {"paper": 2, "peer": 4}
_NONE = "–"


@dataclass(frozen=True, slots=True)
class Cell:
    """A mean, over how many tasks; None over none."""

    mean: float | None
    tasks: int


@dataclass(frozen=True, slots=True)
class SetResults:
    """A scored folder of results. ``rows``: level or ``overall`` → metric → its mean over the scored tasks.

    The overall mean is over tasks, as the paper's; it is not the mean of the levels where these differ in number.
    """

    run: SetRun
    records: tuple[TaskRecord, ...]
    scores: tuple[Score, ...]
    rows: dict[str, dict[str, Cell]]

    @property
    def name(self) -> str:
        """The system's name."""
        return self.run.setup.name

    @property
    def convention(self) -> str:
        """The convention of the distances."""
        return self.scores[0].convention


def read_results(out: Path) -> SetResults:
    """Reads a folder. Raises BadResults if it is not scored, or in different ways."""
    run = read_run(out)
    finished = list(records(out))
    if unscored := [record.task for place, record in finished if not place.scores.is_file()]:
        raise BadResults(f"{out}: {', '.join(unscored)} not scored yet. Run 'blenderbench score {out}'.")
    scores = tuple(read(place.scores, Score) for place, _ in finished)
    if not scores:
        raise BadResults(f"{out} has no finished task.")
    ways = {(result.convention, result.best_round, str(result.clip), _judge(result)) for result in scores}
    if len({way[:3] for way in ways}) > 1 or len({way[3] for way in ways if way[3]}) > 1:
        raise BadResults(f"{out}: tasks were scored with different options. Score them again, all at once.")
    return SetResults(run, tuple(record for _, record in finished), scores, _rows(scores))


def _judge(result: Score) -> tuple[str, str, str] | None:
    judged = result.judged
    return (judged.provider, judged.model, judged.prompt_version) if judged else None


def _rows(scores: Sequence[Score]) -> dict[str, dict[str, Cell]]:
    levels = {level: [result for result in scores if result.level == level] for level in LEVELS}
    rows = {level: of for level, of in levels.items() if of} | {OVERALL: list(scores)}
    return {row: {metric: _cell(metric, of) for metric in METRICS} for row, of in rows.items()}


def _cell(metric: str, scores: Sequence[Score]) -> Cell:
    values = [value for result in scores if (value := getattr(result, metric)) is not None]
    return Cell(fmean(values) if values else None, len(values))


def as_markdown(results: Sequence[SetResults], *, published: bool = False) -> str:
    """The table and notes on how to read it. Raises BadResults for results that cannot be compared."""
    if len({result.convention for result in results}) > 1:
        raise BadResults(
            "Results of both conventions cannot be in one table. Score them with the same convention."
        )
    if published and results[0].convention != "paper":
        raise BadResults("The published figures use the paper's convention. Score without --peer.")
    digits = _DIGITS[results[0].convention]
    systems = [result.name for result in results] + (list(PUBLISHED) if published else [])
    head = ("", *(f"{system} {_HEADS[metric]}" for system in systems for metric in METRICS))
    body = tuple(
        (_label(row), *_figures(results, row, digits), *(_published(row) if published else ()))
        for row in (*LEVELS, OVERALL)
        if any(row in result.rows for result in results)
    )
    notes = "\n".join(f"- {note}" for result in results for note in _notes(result))
    return f"{format_table(Table('BlenderBench', head, body))}\n\n{notes}"


def as_data(results: Sequence[SetResults]) -> list[dict[str, Any]]:
    """The same for programs."""
    return [
        {
            "system": result.name,
            "setup": result.run.setup.model_dump(mode="json"),
            "convention": result.convention,
            "best_round": result.scores[0].best_round,
            "rows": {
                row: {metric: {"mean": cell.mean, "tasks": cell.tasks} for metric, cell in cells.items()}
                for row, cells in result.rows.items()
            },
            "scores": [score.model_dump(mode="json") for score in result.scores],
            "notes": list(_notes(result)),
        }
        for result in results
    ]


def _label(row: str) -> str:
    return "Overall" if row == OVERALL else f"Level {row[-1]}"


def _figures(results: Sequence[SetResults], row: str, digits: int) -> Iterator[str]:
    for result in results:
        cells = result.rows.get(row, {})
        of = sum(row in (score.level, OVERALL) for score in result.scores)
        for metric in METRICS:
            cell = cells.get(metric, Cell(None, 0))
            share = "" if cell.tasks in (0, of) else f" ({cell.tasks} of {of})"
            yield _NONE if cell.mean is None else f"{cell.mean:.{digits}f}{share}"


def _published(row: str) -> Iterator[str]:
    for rows in PUBLISHED.values():
        yield from (f"{value:.2f}" for value in rows[row])


def _notes(result: SetResults) -> Iterator[str]:
    """Notes on a system: how many tasks, how they were scored, which scores are missing, and what limits them."""
    first, tasks = result.scores[0], len(result.run.tasks)
    done = len(result.scores)
    yield f"{result.name}: {done} of {tasks} tasks; {_rule(first)}"
    if result.run.faults:
        yield f"{result.name}: {len(result.run.faults)} tasks of the set cannot be used: {' '.join(result.run.faults)}"
    losses = [record.start_loss for record in result.records if record.start_loss is not None]
    if losses:
        yield (
            f"{result.name}: start scenes rendered here differ from the set's own renders by PL "
            f"{fmean(losses):.2f} on average and {max(losses):.2f} at most; this part is not due to the system"
        )
    if spent := list(_spent(result)):
        yield f"{result.name}: cost {', '.join(spent)}"
    if first.clip is not None and not first.clip["openai"]:
        yield f"{result.name}: N-CLIP does not use OpenAI's weights: {first.clip['source']}"
    for score in result.scores:
        for why in dict.fromkeys(score.missing.values()):
            names = ", ".join(_HEADS[metric][:-1] for metric in METRICS if score.missing.get(metric) == why)
            yield f"{result.name}: {score.task} has no {names}: {why}"


def _spent(result: SetResults) -> Iterator[str]:
    """The cost of models, as far as prices are known."""
    judged = [score.judged.spent.cost for score in result.scores if score.judged]
    for what, costs in (("the edits", [record.cost for record in result.records]), ("the marks", judged)):
        known = [cost for cost in costs if cost is not None]
        if sum(known):
            yield f"${sum(known):.2f} for {what} of {len(known)} tasks"


def _rule(first: Score) -> str:
    sides = {"paper": "at the goal's size, × 100", "peer": "at the render's size, not × 100"}
    rounds = "the round with the best N-CLIP counts" if first.best_round else "the last round counts"
    judge = f"; marks by {first.judged.model}, wording {first.judged.prompt_version}" if first.judged else ""
    return f"distances {sides[first.convention]}; {rounds}{judge}"
