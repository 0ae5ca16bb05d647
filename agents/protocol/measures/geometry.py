"""Measures of geometry: gaps, crossings, extents, poses, surfaces and pieces. Metres."""

from __future__ import annotations

from dataclasses import dataclass

from agents.protocol.facts import Matrix, Vector, WorldBox
from agents.protocol.measures.requests import Measure, Names, Request


class GapMeasure(Measure):
    """The smallest distance between two sets of surfaces, and its two ends. Crossing surfaces are 0 apart."""

    distance: float
    here: Vector
    there: Vector


@dataclass(frozen=True)
class GapRequest(Request[GapMeasure], kind="gap", answer=GapMeasure):
    """How far apart the evaluated surfaces of ``a`` and ``b`` are.

    ``enough``: where they are no farther apart than this, any distance up to it will do as an answer.
    """

    a: Names
    b: Names
    frame: int | None = None
    enough: float = 0.0


class Crossing(Measure):
    """Two meshes that share space: how deep, and where. ``undecided`` says why the depth is unknown.

    ``way``: the shortest move of ``a`` along an axis of the world after which their boxes no longer overlap.
    """

    a: str
    b: str
    depth: float | None = None
    at: Vector | None = None
    way: Vector | None = None
    undecided: str = ""


class CrossingsMeasure(Measure):
    """All pairs that cross."""

    pairs: tuple[Crossing, ...]


@dataclass(frozen=True)
class CrossingsRequest(Request[CrossingsMeasure], kind="crossings", answer=CrossingsMeasure):
    """Which of the named meshes cross: every pair whose boxes overlap by more than ``noise`` is examined.

    ``moving``: only pairs with one of these are examined. ``but``: pairs to leave out.
    """

    names: Names
    frame: int | None = None
    moving: Names | None = None
    but: tuple[tuple[str, str], ...] = ()
    noise: float = 0.0


class BoxesMeasure(Measure):
    """Boxes around evaluated geometry, by object."""

    boxes: dict[str, WorldBox]


@dataclass(frozen=True)
class BoxesRequest(Request[BoxesMeasure], kind="boxes", answer=BoxesMeasure):
    """The boxes around the named objects."""

    names: Names
    frame: int | None = None


class ExtentsMeasure(Measure):
    """The smallest and largest coordinates of some geometry along three axes, from the world's origin."""

    low: Vector
    high: Vector

    @property
    def size(self) -> Vector:
        """The extent along each axis."""
        return (self.high[0] - self.low[0], self.high[1] - self.low[1], self.high[2] - self.low[2])


@dataclass(frozen=True)
class ExtentsRequest(Request[ExtentsMeasure], kind="extents", answer=ExtentsMeasure):
    """How far the named objects reach along the axes: unit vectors of the world, or of the object ``of``."""

    names: Names
    axes: tuple[Vector, Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    frame: int | None = None
    of: str | None = None


class PosesMeasure(Measure):
    """World matrices (16 numbers, row by row), by object."""

    matrices: dict[str, Matrix]


@dataclass(frozen=True)
class PosesRequest(Request[PosesMeasure], kind="poses", answer=PosesMeasure):
    """Where the named objects are, and how they are rotated."""

    names: Names
    frame: int | None = None


class SurfaceMeasure(Measure):
    """An evaluated mesh. ``open_edges`` counts the edges with one face only, or more than two; then ``volume`` is 0."""

    vertices: int
    polygons: int
    finite: bool
    open_edges: int
    volume: float
    area: float
    parts: int


@dataclass(frozen=True)
class SurfaceRequest(Request[SurfaceMeasure], kind="surface", answer=SurfaceMeasure):
    """What an object's evaluated mesh consists of."""

    name: str
    frame: int | None = None


class PiecesMeasure(Measure):
    """Groups of connected objects."""

    pieces: tuple[Names, ...]


@dataclass(frozen=True)
class PiecesRequest(Request[PiecesMeasure], kind="pieces", answer=PiecesMeasure):
    """Which of the named objects are connected.

    The gap between two may be ``share`` of the smaller one's diagonal, but from ``least`` to ``most`` metres.
    """

    names: Names
    least: float
    share: float
    most: float
    frame: int | None = None
