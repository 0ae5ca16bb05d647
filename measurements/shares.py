"""Shares of what was asked: as a number, as a figure with a target, and in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from measurements.report import TargetFigure

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


def share_of(met: Sequence[bool]) -> float:
    """The share that is met; 0 of nothing."""
    return sum(met) / max(1, len(met))


def count_of(met: Sequence[bool]) -> str:
    """``3 of 4``."""
    return f"{sum(met)} of {len(met)}"


def share_figure(key: str, met: Iterable[bool]) -> TargetFigure:
    """The share that is met as the figure of a target, with the numbers that it was made of."""
    each = list(met)
    return TargetFigure(key, share_of(each), count_of(each))
