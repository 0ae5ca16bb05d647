"""What Blender measures of two groups of objects at one frame, in metres (by ``bench/audit/inside/measure.py``)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

Corner: TypeAlias = tuple[float, float, float]
Extents: TypeAlias = tuple[float, float, float, float]
# What to measure beyond bounds and distance. depth: how deep, and by what share, either is in the other. columns: that,
# and which is over which. inside: containment. view: extents as the camera sees them.
Quantity: TypeAlias = Literal["depth", "columns", "inside", "view"]


@dataclass(frozen=True, slots=True)
class PairMeasurement:
    """Two groups of objects, ``a`` and ``b``, at a frame. Quantities that were not requested or do not exist are None.

    ``empty``: which of them has no geometry; then the rest is not set. ``a_low`` … ``b_high``: corners of bounds.
    ``gap``: the least distance of their surfaces, 0 if they intersect. ``depth``: how deep one penetrates the other:
    the greatest distance to the surface of points of either that are in the other's solid, or cut off by its sheet.
    ``a_in_b``, ``b_in_a``: the share of one's surface that is in the other's solid. ``inside``: the share of ``a`` that
    ``b`` encloses, as a bowl does.

    On vertical lines through both: ``clearance``: the least gap between a part of ``a`` and the part of ``b`` below it;
    ``contact``: the height of ``b`` there; ``over``: the share of ``a`` on those lines that has ``b`` below and not
    above; ``lines``: how many stretches of ``a`` were compared.

    ``right``, ``near``: extents to the right of the camera, and towards it: low, high of ``a``, low, high of ``b``.
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
    right: Extents | None = None
    near: Extents | None = None


@dataclass(frozen=True, slots=True)
class PairRequest:
    """What to measure: two groups of objects (by name), at turns (0 start, 1 middle, 2 end) of the clip."""

    a: tuple[str, ...]
    b: tuple[str, ...]
    turns: tuple[int, ...]
    tolerance: float
    wants: tuple[Quantity, ...] = field(default=())
