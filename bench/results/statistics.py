"""Macro averages over cells, their intervals, and tests whether two systems differ. Pure functions of numbers.

Values are grouped by cell (category and level). A macro average is the mean of the cells' means: a scene's weight is
one over the number of cells, divided by the number of scenes in its cell.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import numpy

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    Cells: TypeAlias = Mapping[str, Sequence[float]]
    Numbers: TypeAlias = NDArray[numpy.float64]

SEED = 0
DRAWS = 10_000
LEVEL = 0.95
EXACT_UP_TO = 16  # scenes: 65,536 ways to swap two systems' results
_ROUNDING = 1e-12


def macro(cells: Cells) -> float | None:
    """The mean of the means of the cells that have values; None without any."""
    means = [sum(values) / len(values) for values in cells.values() if values]
    return sum(means) / len(means) if means else None


def interval(cells: Cells, *, seed: int = SEED, draws: int = DRAWS) -> tuple[float, float] | None:
    """The 95 % interval of the macro average, by the bootstrap over scenes within cells (percentiles).

    None if no cell has two values: then nothing is known of how scenes vary. With few scenes per cell, it is somewhat
    too narrow.
    """
    filled = [numpy.asarray(values, dtype=numpy.float64) for values in cells.values() if values]
    if not any(len(values) > 1 for values in filled):
        return None
    random = numpy.random.default_rng(seed)
    total = numpy.zeros(draws)
    for values in filled:
        total += values[random.integers(0, len(values), (draws, len(values)))].mean(axis=1)
    low, high = numpy.quantile(total / len(filled), [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    return float(low), float(high)


def differences(
    first: Mapping[str, float], second: Mapping[str, float], cells: Mapping[str, str]
) -> dict[str, list[float]]:
    """By cell, first minus second of each scene that both have. ``cells``: scene → its cell."""
    cells_of: dict[str, list[float]] = {}
    for scene, value in first.items():
        if scene in second:
            cells_of.setdefault(cells[scene], []).append(value - second[scene])
    return cells_of


def permutation(cells: Cells, *, seed: int = SEED, draws: int = 2 * DRAWS) -> tuple[float, bool] | None:
    """(two-sided p of the paired permutation test on differences, whether it is exact); None without pairs.

    The statistic is the macro average of the differences. If few scenes differ, all swaps are counted; otherwise
    ``draws`` of them are drawn, and the observed one counts as one more, so that p is never 0.
    """
    filled = [numpy.asarray(values, dtype=numpy.float64) for values in cells.values() if values]
    if not filled:
        return None
    weighted = numpy.concatenate([values / (len(filled) * len(values)) for values in filled])
    weighted = weighted[weighted != 0]
    observed = abs(weighted.sum()) - _ROUNDING
    if len(weighted) <= EXACT_UP_TO:
        swapped = numpy.abs(_all_signs(len(weighted)) @ weighted)
        return float((swapped >= observed).mean()), True
    random = numpy.random.default_rng(seed)
    signs = random.integers(0, 2, (draws, len(weighted))) * 2.0 - 1.0
    extreme = int((numpy.abs(signs @ weighted) >= observed).sum())
    return (1 + extreme) / (1 + draws), False


def _all_signs(count: int) -> Numbers:
    """Every way to choose ``count`` signs, a row each."""
    ways = numpy.arange(2**count)[:, None]
    return (ways >> numpy.arange(count) & 1) * 2.0 - 1.0
