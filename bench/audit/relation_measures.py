"""What Blender measures of two things at one frame, for relations: plain numbers, in metres, by ``bench/inside``."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

Corner: TypeAlias = tuple[float, float, float]
Reaches: TypeAlias = tuple[float, float, float, float]
# Beyond bounds and distance: how deep and by what share either is in the other; that and which is over which;
# containment; where both lie for who looks.
Want: TypeAlias = Literal["depth", "columns", "inside", "view"]


@dataclass(frozen=True, slots=True)
class Measured:
    """Two things, ``a`` and ``b``, at a frame. What was not asked for, or does not exist, is None.

    ``empty``: which of them has nothing to measure; then there is no more. ``a_low`` … ``b_high``: corners of bounds.
    ``gap``: the least distance of their surfaces, 0 where they cross. ``depth``: how deep one is in the other: of the
    points of either that are in the other's solid, or cut off by its sheet, the greatest distance to the surface.
    ``a_in_b``, ``b_in_a``: the share of the one's surface that is in the other's solid. ``inside``: the share of ``a``
    that ``b`` encloses, as a bowl does.

    On vertical lines through both: ``clearance``: the least free height between something of ``a`` and what of ``b``
    lies beneath it; ``contact``: the height of ``b`` there; ``over``: the share of ``a`` on those lines that has ``b``
    under it and not over it; ``lines``: how many were looked at.

    ``right``, ``near``: how far both reach to the right of who looks, and towards them: low, high of ``a``, of ``b``.
    """

    frame: int
    empty: tuple[Literal["a", "b"], ...] = ()
    a_low: Corner = (0.0, 0.0, 0.0)
    a_high: Corner = (0.0, 0.0, 0.0)
    b_low: Corner = (0.0, 0.0, 0.0)
    b_high: Corner = (0.0, 0.0, 0.0)
    gap: float | None = None
    depth: float | None = None
    a_in_b: float = 0.0
    b_in_a: float = 0.0
    inside: float | None = None
    clearance: float | None = None
    contact: float | None = None
    over: float | None = None
    lines: int = 0
    right: Reaches | None = None
    near: Reaches | None = None


@dataclass(frozen=True, slots=True)
class Pair:
    """What is to be measured: two things as names of their objects, at turns (0 start, 1 middle, 2 end) of the clip."""

    a: tuple[str, ...]
    b: tuple[str, ...]
    turns: tuple[int, ...]
    tolerance: float
    wants: tuple[Want, ...] = field(default=())
