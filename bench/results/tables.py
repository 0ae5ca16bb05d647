"""The tables of a report: the paper's Table 1, coverage, comparisons, ablations, cost."""

from __future__ import annotations

from collections import Counter
from statistics import fmean, median
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from bench.results import paper
from bench.results.figures import OVERALL, ablations, comparisons, figures_of
from bench.results.scores import METRICS, TITLES
from bench.scenes.spec import specs

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from bench.results.figures import AblationRow, SystemComparison
    from bench.results.scores import Metric, ResultSet, SystemResults

NONE = "–"
_CELLS, _INTERVAL, _BOUND = "cells", "interval", "bound"
# The rows of Table 1.
NAMES = {
    "cloth": "Cloth",
    "fluid": "Fluid",
    "rigid": "Rigid body",
    "particle": "Particle",
    "soft": "Soft body",
    "static": "Static",
    OVERALL: "Overall",
    _CELLS: "over cells",
    _INTERVAL: "95 % interval",
    _BOUND: "if not scored is 0",
}
_NOTE = (
    "A category's score is the mean of its levels' means; overall is the macro average over cells of category and "
    "level, with its 95 % interval by the bootstrap over scenes within cells. The last row counts scenes that were not "
    "scored as 0."
)
_SIDE_BY_SIDE = 2  # systems, with all metrics in one table as the paper has it


def tables(results: ResultSet, *, baseline: str | None = None, with_paper: bool = False) -> list[Table]:
    """All tables that have content."""
    result = [*table_1(results, with_paper=with_paper), coverage(results)]
    if (missing := not_scored(results)) is not None:
        result.append(missing)
    if rows := comparisons(results, baseline):
        result.append(_comparisons(rows))
    if configurations := ablations(results):
        result.append(_ablations(configurations, with_paper=with_paper))
    return [*result, cost(results)]


# Table 1


def table_1(results: ResultSet, *, with_paper: bool = False) -> Iterator[Table]:
    """Scores per category and overall: one table for few systems, else one for each metric."""
    columns = {system.name: _columns(system) for system in results.systems}
    if with_paper:
        columns |= {f"{name} ({paper.SOURCE})": _published(name) for name in paper.TABLE_1}
    if len(columns) <= _SIDE_BY_SIDE:
        yield _table_1(METRICS, columns, "Results by category", _NOTE)
        return
    for metric in METRICS:
        yield _table_1(
            (metric,), columns, f"{TITLES[metric]} by category", _NOTE if metric == METRICS[-1] else ""
        )


def _table_1(
    metrics: Sequence[Metric], columns: Mapping[str, Mapping[Metric, dict[str, str]]], title: str, note: str
) -> Table:
    many = len(metrics) > 1
    header = [f"{TITLES[metric]} {name}" if many else name for metric in metrics for name in columns]
    rows: list[tuple[str, ...]] = []
    for row, name in NAMES.items():
        cells = [column.get(metric, {}).get(row, NONE) for metric in metrics for column in columns.values()]
        if any(cell != NONE for cell in cells):
            rows.append((name, *cells))
    return Table(title, ("category", *header), tuple(rows), note)


def _columns(system: SystemResults) -> dict[Metric, dict[str, str]]:
    columns: dict[Metric, dict[str, str]] = {}
    for metric, figures in figures_of(system).items():
        overall = figures[OVERALL]
        columns[metric] = {category: number(figure.value) for category, figure in figures.items()}
        columns[metric][_CELLS] = f"{overall.cells} of {cells_of(metric)}"
        columns[metric][_INTERVAL] = span(overall.low, overall.high)
        columns[metric][_BOUND] = number(overall.bound)
    return columns


def _published(name: str) -> dict[Metric, dict[str, str]]:
    return {
        metric: {
            **{category: number(value) for category, value in rows.items()},
            _CELLS: f"{cells_of(metric)}",
        }
        for metric, rows in paper.TABLE_1[name].items()
    }


def cells_of(metric: Metric) -> int:
    """How many cells of category and level count for a score."""
    return len({spec.cell for spec in specs() if metric != "mpr" or spec.category != "static"})


# Coverage


def coverage(results: ResultSet) -> Table:
    """How many scenes each score is based on."""
    rows = [
        (
            system.name,
            f"{len(system.scenes)} of {len(specs())}",
            *(
                f"{figures[OVERALL].scenes} of {figures[OVERALL].asked}"
                for figures in figures_of(system).values()
            ),
        )
        for system in results.systems
    ]
    header = ("system", "scenes", *(f"{TITLES[metric]} scored" for metric in METRICS))
    return Table("Coverage", header, tuple(rows), "Scenes that a system was not given do not count.")


def not_scored(results: ResultSet) -> Table | None:
    """How many scenes were not scored or judged, by reason, most frequent first; None if all were."""
    whys = Counter(
        (system.name, "not judged" if metric == "vlm" else "not scored", why)
        for system in results.systems
        for scene in system.scenes.values()
        for metric in ("mpr" if scene.asks("mpr") else "spr", "vlm")
        if (why := scene.why_not(metric))
    )
    rows = tuple((name, str(count), what, why[:200]) for (name, what, why), count in whys.most_common())
    return Table("Not scored", ("system", "scenes", "", "why"), rows) if rows else None


# Comparisons and ablations


def _comparisons(rows: Iterable[SystemComparison]) -> Table:
    cells = tuple(
        (
            f"{row.first} − {row.second}",
            TITLES[row.metric],
            str(row.scenes),
            number(row.difference, signed=True),
            span(row.low, row.high, signed=True),
            probability(row),
        )
        for row in rows
    )
    note = (
        "Differences of the macro averages over the scenes that both systems have; the interval by the paired "
        "bootstrap; p by the paired permutation test, two-sided, not corrected for the number of comparisons."
    )
    return Table(
        "Systems compared", ("systems", "score", "scenes", "difference", "95 % interval", "p"), cells, note
    )


def probability(comparison: SystemComparison) -> str:
    """p, marked if it is not exact."""
    return NONE if comparison.p is None else f"{comparison.p:.4f}{'' if comparison.exact else ' (drawn)'}"


def _ablations(rows: Sequence[AblationRow], *, with_paper: bool) -> Table:
    cells = [
        (
            row.system,
            " and ".join(part.replace("-", " ") for part in row.without) or "full",
            *(number(row.scores[metric]) for metric in METRICS),
            str(max(row.scenes.values())),
        )
        for row in rows
    ]
    if with_paper:
        cells += [
            (f"SimWorlds ({paper.SOURCE})", " and ".join(without).replace("-", " ") or "full",
             *(number(scores[metric]) for metric in METRICS), "15")
            for without, scores in paper.ABLATIONS.items()
        ]  # fmt: skip
    note = "Over the scenes that all configurations of a system have a score for."
    header = ("system", "configuration", *(TITLES[metric] for metric in METRICS), "scenes")
    return Table("Ablations", header, tuple(cells), note)


# Cost


def cost(results: ResultSet) -> Table:
    """The mean cost and time per scene: of the system, of scoring, of judging."""
    header = ("system", "models", "$ per scene", "minutes per scene", "audit s", "frames s", "judge $")
    rows = tuple(
        (system.name, ", ".join(models(system)) or NONE, *_took(system)) for system in results.systems
    )
    note = "Means over scenes with a known value; in brackets the median of the minutes."
    return Table("Cost per scene", header, rows, note)


def models(system: SystemResults) -> list[str]:
    """The models that made a system's scenes."""
    names = Counter(
        name
        for scene in system.scenes.values()
        if scene.record.produced is not None
        for name in {*scene.record.produced.models.values()}
    )
    return sorted(names)


def _took(system: SystemResults) -> Iterator[str]:
    records = [scene.record for scene in system.scenes.values()]
    produced = [record.produced for record in records if record.produced is not None]
    costs = [step.cost for step in produced if step.cost is not None]
    minutes = [step.minutes for step in produced if step.minutes is not None]
    audits = [step.seconds for record in records if (step := record.audited) and step.file is not None]
    frames = [step.seconds for record in records if (step := record.framed) and step.frames]
    judged = [step.cost for record in records if (step := record.judged) and step.cost is not None]
    yield f"{fmean(costs):.2f}" if costs else NONE
    yield f"{fmean(minutes):.1f} ({median(minutes):.1f})" if minutes else NONE
    yield f"{fmean(audits):.1f}" if audits else NONE
    yield f"{fmean(frames):.1f}" if frames else NONE
    yield f"{fmean(judged):.3f}" if judged else NONE


# Numbers


def number(value: float | None, *, signed: bool = False) -> str:
    """A value with two decimals, as in the paper."""
    if value is None:
        return NONE
    return f"{value:+.2f}".replace("-", "−") if signed else f"{value:.2f}"


def span(low: float | None, high: float | None, *, signed: bool = False) -> str:
    """An interval."""
    return (
        NONE
        if low is None or high is None
        else f"{number(low, signed=signed)} to {number(high, signed=signed)}"
    )
