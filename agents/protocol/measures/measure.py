"""What rules may ask Blender to measure, and what it answers. Metres, radians, frames.

A request is a frozen record; equal requests are measured once. Blender answers all of them in one batch, stepping
through the frames that they name in order. ``None`` as a frame is the one that the scene stands at.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from agents.protocol.facts import Box, Matrix, Vector

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

Names = tuple[str, ...]


class Measure(BaseModel):
    """What was measured."""

    model_config = ConfigDict(frozen=True, extra="ignore")


Answer = TypeVar("Answer", bound=Measure)


class Unmeasured(Exception):  # noqa: N818 - reads as the state it names
    """Something could not be measured; the message says why."""


@dataclass(frozen=True)
class Request(Generic[Answer]):
    """Something to measure. ``kind`` names the measuring function, ``answer`` the type of what comes back."""

    kind: ClassVar[str]
    answer: ClassVar[type[Measure]]

    def told(self) -> dict[str, Any]:
        """It as JSON."""
        return {"kind": self.kind, **asdict(self)}


class GapMeasure(Measure):
    """The smallest distance between two sets of surfaces, and where it is. Crossing surfaces are 0 apart."""

    distance: float
    here: Vector
    there: Vector


@dataclass(frozen=True)
class Gap(Request[GapMeasure]):
    """How far apart the evaluated surfaces of ``a`` and ``b`` are.

    ``enough``: any distance up to this one will do as an answer, if they are no farther apart.
    """

    kind: ClassVar[str] = "gap"
    answer: ClassVar[type[Measure]] = GapMeasure
    a: Names
    b: Names
    frame: int | None = None
    enough: float = 0.0


class Crossing(Measure):
    """Two meshes that share space: how deep, and where. ``undecided`` says why the depth could not be told.

    ``way``: the shortest move of ``a`` along an axis of the world after which not even their boxes overlap.
    """

    a: str
    b: str
    depth: float | None = None
    at: Vector | None = None
    way: Vector | None = None
    undecided: str = ""


class CrossingsMeasure(Measure):
    """Every pair that crosses."""

    pairs: tuple[Crossing, ...]


@dataclass(frozen=True)
class Crossings(Request[CrossingsMeasure]):
    """Which of the named meshes go through each other: all pairs whose boxes overlap are looked at.

    ``moving``: of these, only the pairs with one of those. ``but``: pairs that nobody asks about. Boxes that overlap by
    no more than ``noise`` are not looked into.
    """

    kind: ClassVar[str] = "crossings"
    answer: ClassVar[type[Measure]] = CrossingsMeasure
    names: Names
    frame: int | None = None
    moving: Names | None = None
    but: tuple[tuple[str, str], ...] = ()
    noise: float = 0.0


class BoxesMeasure(Measure):
    """Boxes around evaluated geometry, by object."""

    boxes: dict[str, Box]


@dataclass(frozen=True)
class Boxes(Request[BoxesMeasure]):
    """Boxes around the named objects at a frame."""

    kind: ClassVar[str] = "boxes"
    answer: ClassVar[type[Measure]] = BoxesMeasure
    names: Names
    frame: int | None = None


class ExtentsMeasure(Measure):
    """The reach of some geometry along three axes, from the world's origin."""

    low: Vector
    high: Vector

    @property
    def size(self) -> Vector:
        """How far it goes along each axis."""
        return (self.high[0] - self.low[0], self.high[1] - self.low[1], self.high[2] - self.low[2])


@dataclass(frozen=True)
class Extents(Request[ExtentsMeasure]):
    """How far the named objects reach along the axes: unit vectors of the world, or of the object ``of``."""

    kind: ClassVar[str] = "extents"
    answer: ClassVar[type[Measure]] = ExtentsMeasure
    names: Names
    axes: tuple[Vector, Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    frame: int | None = None
    of: str | None = None


class PosesMeasure(Measure):
    """World matrices (16 numbers, row by row), by object."""

    matrices: dict[str, Matrix]


@dataclass(frozen=True)
class Poses(Request[PosesMeasure]):
    """Where the named objects are, and how they are turned, at a frame."""

    kind: ClassVar[str] = "poses"
    answer: ClassVar[type[Measure]] = PosesMeasure
    names: Names
    frame: int | None = None


class SurfaceMeasure(Measure):
    """An evaluated mesh as such. ``open_edges`` border one face only, or more than two; ``volume`` is 0 then."""

    vertices: int
    polygons: int
    finite: bool
    open_edges: int
    volume: float
    area: float
    parts: int


@dataclass(frozen=True)
class Surface(Request[SurfaceMeasure]):
    """What an object's evaluated mesh is made of."""

    kind: ClassVar[str] = "surface"
    answer: ClassVar[type[Measure]] = SurfaceMeasure
    name: str
    frame: int | None = None


class PiecesMeasure(Measure):
    """Groups of objects that hang together."""

    pieces: tuple[Names, ...]


@dataclass(frozen=True)
class Pieces(Request[PiecesMeasure]):
    """Which of the named objects hang together.

    The gap between two may be ``share`` of the smaller one's diagonal, but at least ``least`` metres and at ``most``.
    """

    kind: ClassVar[str] = "pieces"
    answer: ClassVar[type[Measure]] = PiecesMeasure
    names: Names
    least: float
    share: float
    most: float
    frame: int | None = None


class Measures:
    """The answers to a batch. Asking for what was not measured raises Unmeasured, saying why."""

    def __init__(self, answers: dict[Request[Any], Measure | str]) -> None:
        self._answers = answers

    def __getitem__(self, request: Request[Answer]) -> Answer:
        found = self._answers.get(request)
        if found is None:
            raise Unmeasured("it was not asked for")
        if isinstance(found, str):
            raise Unmeasured(found)
        return found  # pyright: ignore[reportReturnType] - the answer's type is the request's own


def measure(
    requests: Iterable[Request[Any]], ask: Callable[[list[dict[str, Any]]], list[dict[str, Any]]]
) -> Measures:
    """Has a batch measured. ``ask`` answers in the same order, each ``{"value": …}`` or ``{"unmeasured": reason}``."""
    wanted = list(dict.fromkeys(requests))
    answers: dict[Request[Any], Measure | str] = {}
    if wanted:
        told = ask([request.told() for request in wanted])
        if len(told) != len(wanted):
            told = [{"unmeasured": f"Blender gave {len(told)} answers to {len(wanted)} questions"}] * len(
                wanted
            )
        for request, answer in zip(wanted, told, strict=True):
            if "value" in answer:
                try:
                    answers[request] = request.answer.model_validate(answer["value"])
                except ValidationError as error:
                    answers[request] = f"Blender's answer is none: {error.errors()[0]['msg']}"
            else:
                answers[request] = str(answer.get("unmeasured") or "Blender gave no answer")
    return Measures(answers)
