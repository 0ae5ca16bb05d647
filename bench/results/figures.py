"""The figures of a report: of each system by category and overall, of pairs of systems, of ablations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.results import statistics
from bench.results.scores import METRICS
from bench.scenes.spec import CATEGORIES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from bench.results.scores import Metric, ResultSet, SceneResult, SystemResults

OVERALL = "overall"


@dataclass(frozen=True, slots=True)
class MacroAverage:
    """A macro average over cells. ``low`` to ``high``: its 95 % interval, None if unknown.

    ``scenes`` of the ``asked`` ones were scored, in ``cells`` cells. ``bound``: the average with unscored scenes as 0;
    None if no scene was scored.
    """

    value: float | None
    low: float | None
    high: float | None
    bound: float | None
    scenes: int
    asked: int
    cells: int


@dataclass(frozen=True, slots=True)
class SystemComparison:
    """``first`` minus ``second`` over the scenes that both have a score for; ``p`` of the paired permutation test."""

    first: str
    second: str
    metric: Metric
    scenes: int
    difference: float | None
    low: float | None
    high: float | None
    p: float | None
    exact: bool


@dataclass(frozen=True, slots=True)
class AblationRow:
    """A row of the ablations: a system with or without some of its parts, over scenes that all its variants have."""

    system: str
    without: tuple[str, ...]
    scores: dict[Metric, float | None]
    scenes: dict[Metric, int]


def figures_of(system: SystemResults) -> dict[Metric, dict[str, MacroAverage]]:
    """By metric, the figures of each category that has scenes, and OVERALL."""
    return {metric: _by_category(system, metric) for metric in METRICS}


def _by_category(system: SystemResults, metric: Metric) -> dict[str, MacroAverage]:
    asked = [scene for scene in system.scenes.values() if scene.asks(metric)]
    figures: dict[str, MacroAverage] = {}
    for category in CATEGORIES:
        own = [scene for scene in asked if scene.spec.category == category]
        if own:
            figures[category] = macro_average(own, metric)
    figures[OVERALL] = macro_average(asked, metric)
    return figures


def macro_average(asked: Sequence[SceneResult], metric: Metric) -> MacroAverage:
    """The figure of some scenes."""
    scored = [scene for scene in asked if scene.score(metric) is not None]
    cells = _cells(scored, lambda scene: scene.score(metric) or 0.0)
    low, high = statistics.interval(cells) or (None, None)
    bound = statistics.macro(_cells(asked, lambda scene: scene.score(metric) or 0.0)) if scored else None
    return MacroAverage(statistics.macro(cells), low, high, bound, len(scored), len(asked), len(cells))


def _cells(scenes: Iterable[SceneResult], value: Callable[[SceneResult], float]) -> dict[str, list[float]]:
    cells: dict[str, list[float]] = {}
    for scene in sorted(scenes, key=lambda scene: scene.spec.id):
        cells.setdefault(scene.spec.cell, []).append(value(scene))
    return cells


def compare(first: SystemResults, second: SystemResults, metric: Metric) -> SystemComparison:
    """The paired comparison of two systems."""
    first_scores, second_scores = (_scores(system, metric) for system in (first, second))
    cells = {name: scene.spec.cell for name, scene in first.scenes.items()}
    pairs = statistics.differences(first_scores, second_scores, cells)
    low, high = statistics.interval(pairs) or (None, None)
    p, exact = statistics.permutation(pairs) or (None, True)
    count = sum(len(values) for values in pairs.values())
    return SystemComparison(
        first.name, second.name, metric, count, statistics.macro(pairs), low, high, p, exact
    )


def _scores(system: SystemResults, metric: Metric) -> dict[str, float]:
    return {
        name: value
        for name, scene in sorted(system.scenes.items())
        if (value := scene.score(metric)) is not None
    }


def comparisons(results: ResultSet, baseline: str | None = None) -> list[SystemComparison]:
    """Every other system against the ``baseline`` (the first), by each metric that both have a score of."""
    against = results.system(baseline) if baseline is not None else next(iter(results.systems), None)
    if against is None:
        return []
    every = (
        compare(system, against, metric)
        for system in results.systems
        if system is not against
        for metric in METRICS
    )
    return [comparison for comparison in every if comparison.scenes]


def ablations(results: ResultSet) -> list[AblationRow]:
    """The variants of each ablated system, the full one first; [] if no system was ablated.

    Variants of one system have the same settings; their scores are over the scenes that all of them have.
    """
    groups: dict[str, list[SystemResults]] = {}
    for system in results.systems:
        groups.setdefault(f"{system.info.kind} {sorted(system.info.settings.items())}", []).append(system)
    families = [
        group
        for group in groups.values()
        if len(group) > 1 and any(system.info.ablations for system in group)
    ]
    return [row for family in families for row in _configurations(family)]


def _configurations(family: list[SystemResults]) -> list[AblationRow]:
    common = {
        metric: set[str].intersection(*({*_scores(system, metric)} for system in family))
        for metric in METRICS
    }
    rows: list[AblationRow] = []
    for system in sorted(family, key=lambda system: (len(system.info.ablations), system.info.ablations)):
        shared = {metric: [system.scenes[name] for name in sorted(common[metric])] for metric in METRICS}
        rows.append(
            AblationRow(
                system.name,
                system.info.ablations,
                {metric: macro_average(shared[metric], metric).value for metric in METRICS},
                {metric: len(shared[metric]) for metric in METRICS},
            )
        )
    return rows
