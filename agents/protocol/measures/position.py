"""What the rules about places and directions have measured. Metres, degrees."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from agents.protocol.facts import Vector
from agents.protocol.measures.measure import Measure, Names, Request


class OverMeasure(Measure):
    """How something lies over something else, seen from above.

    ``share`` of its outline has the other one below or above it; ``sunk`` is how far it begins below the top of the
    other one, at the place where that is most: negative where it is above all of it, None where nothing is shared.
    """

    share: float
    sunk: float | None = None
    at: Vector | None = None


@dataclass(frozen=True)
class Over(Request[OverMeasure]):
    """How ``a`` lies over ``b``."""

    kind: ClassVar[str] = "over"
    answer: ClassVar[type[Measure]] = OverMeasure
    a: Names
    b: Names
    frame: int | None = None


class BesideMeasure(Measure):
    """On which side something lies.

    ``angle``: between the direction and the way to the middle of ``a`` from the nearest place of ``b``, taken in the
    plane through the middle of ``b`` across the direction; along axis 0 or 1, as seen along axis 2. ``gap``: the widest
    there is between the two along any of the directions that are tried, negative where they overlap in all. ``at``: the
    middle of ``a``.
    """

    angle: float
    gap: float
    at: Vector


@dataclass(frozen=True)
class Beside(Request[BesideMeasure]):
    """Where ``a`` lies, seen from ``b``: along axis 0, 1 or 2, in its direction or (``way`` −1) against it.

    The axes are those of the object ``of`` (its X brought level, if ``level``; its Z is up then), or the world's. The
    gap is looked for in that direction, along the axes of the world and of the objects ``turned``, and between the
    middles: where they are within ``cone`` of it.
    """

    kind: ClassVar[str] = "beside"
    answer: ClassVar[type[Measure]] = BesideMeasure
    a: Names
    b: Names
    axis: int
    way: float
    turned: Names
    cone: float
    of: str | None = None
    level: bool = False
    frame: int | None = None
