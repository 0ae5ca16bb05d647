"""Measures of places and directions. Metres, degrees."""

from __future__ import annotations

from dataclasses import dataclass

from agents.protocol.facts import Vector
from agents.protocol.measures.requests import Measure, Names, Request


class FootprintMeasure(Measure):
    """How ``a`` lies over ``b``, seen from above.

    ``share`` of its outline has ``b`` below or above it. ``sunk`` is how far ``a`` begins below the top of ``b``, where
    that is largest: negative where it is above all of it, None where the outlines share nothing.
    """

    share: float
    sunk: float | None = None
    at: Vector | None = None


@dataclass(frozen=True)
class FootprintRequest(Request[FootprintMeasure], kind="over", answer=FootprintMeasure):
    """How ``a`` lies over ``b``."""

    a: Names
    b: Names
    frame: int | None = None


class DirectionMeasure(Measure):
    """On which side of ``b`` the objects ``a`` lie.

    ``angle``: between the direction and the line to the middle of ``a`` from the nearest point of ``b`` in the plane
    through its middle across the direction; along axis 0 or 1, as seen along axis 2. ``gap``: the largest gap between
    the two along any of the directions that are tried, negative where they overlap in all. ``at``: the middle of ``a``.
    """

    angle: float
    gap: float
    at: Vector


@dataclass(frozen=True)
class DirectionRequest(Request[DirectionMeasure], kind="beside", answer=DirectionMeasure):
    """Where ``a`` lies as seen from ``b``: along axis 0, 1 or 2, in its direction or (``way`` −1) against it.

    The axes are those of the object ``of`` (its X made horizontal, if ``level``; its Z is up then), or the world's. The
    gap is looked for in that direction, along the axes of the world and of the objects ``turned``, and between the
    middles, as far as these are within ``cone`` of it.
    """

    a: Names
    b: Names
    axis: int
    way: float
    turned: Names
    cone: float
    of: str | None = None
    level: bool = False
    frame: int | None = None
