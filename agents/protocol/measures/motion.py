"""What the rules about motion and framing have measured. Metres, radians, frames.

What follows something over time names its first and last frame (``start``, ``end``); every frame between is looked at.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from agents.protocol.facts import Vector
from agents.protocol.measures.measure import Measure, Names, Request


class PathMeasure(Measure):
    """A motion: every list has an entry for each frame from ``start`` on.

    ``measured`` is what of it was followed: vertices, particles, fluid or origin; ``deforms``: its points move against
    each other; ``size``: its largest extent. ``centres`` are the means of its points, ``origins`` those of its objects'
    own origins; None where there is nothing of it. ``speeds`` (m/s) are the means over its points, or that of the
    centre where points cannot be followed; ``rotations`` are axes as long as the angle: both since the frame before,
    None where unknown. ``ways``: how far its points are, on average, from where they were at the last mark.
    """

    start: int
    measured: str
    deforms: bool
    size: float
    centres: tuple[Vector | None, ...]
    origins: tuple[Vector | None, ...]
    speeds: tuple[float | None, ...]
    rotations: tuple[Vector | None, ...]
    ways: tuple[float | None, ...]


@dataclass(frozen=True)
class Path(Request[PathMeasure]):
    """How the named objects move together. ``marks`` are frames from which ways are measured."""

    kind: ClassVar[str] = "path"
    answer: ClassVar[type[Measure]] = PathMeasure
    names: Names
    start: int
    end: int
    marks: tuple[int, ...] = ()


class TogetherMeasure(Measure):
    """How far ``a`` shifted and turned against ``b`` at most, and at which frame; ``turn`` is None where one of them
    has no rotation: particles and fluids."""

    shift: float
    shift_frame: int
    at: Vector | None = None
    turn: float | None = None
    turn_frame: int | None = None


@dataclass(frozen=True)
class Together(Request[TogetherMeasure]):
    """How ``a`` keeps its place in ``b``, where the two are nearest, from the first frame on."""

    kind: ClassVar[str] = "together"
    answer: ClassVar[type[Measure]] = TogetherMeasure
    a: Names
    b: Names
    start: int
    end: int


class TouchesMeasure(Measure):
    """The frames at which two things touch, or come to touch on the way from the frame before."""

    frames: tuple[int, ...]


@dataclass(frozen=True)
class Touches(Request[TouchesMeasure]):
    """When ``a`` and ``b`` are at most ``within`` apart, beside what their collisions keep.

    ``once``: only the first time is asked for.
    """

    kind: ClassVar[str] = "touches"
    answer: ClassVar[type[Measure]] = TouchesMeasure
    a: Names
    b: Names
    start: int
    end: int
    within: float
    once: bool = False


class PassageMeasure(Measure):
    """The deepest that something was in a collider, and when; 0 where it stayed outside.

    ``through``: it was on one side at the frame before, and on the other one at this.
    """

    depth: float
    through: bool = False
    frame: int | None = None
    at: Vector | None = None


@dataclass(frozen=True)
class Passage(Request[PassageMeasure]):
    """How deep the objects ``a`` get into the colliders ``b`` on their way; less than ``beyond`` is not looked at."""

    kind: ClassVar[str] = "passage"
    answer: ClassVar[type[Measure]] = PassageMeasure
    a: Names
    b: Names
    start: int
    end: int
    beyond: float


class ViewMeasure(Measure):
    """What the active camera sees of something: shares of its samples ``inside`` of the picture and, of these,
    ``hidden`` by other things; ``cover`` is the share of the picture that its outline fills.

    All None where there is nothing of it yet.
    """

    inside: float | None = None
    cover: float | None = None
    hidden: float | None = None
    by: Names = ()
    at: Vector | None = None


@dataclass(frozen=True)
class View(Request[ViewMeasure]):
    """How the scene's active camera sees the named objects. ``by`` names what hides them, most of all first."""

    kind: ClassVar[str] = "view"
    answer: ClassVar[type[Measure]] = ViewMeasure
    names: Names
    frame: int | None = None
