"""Measures of motion and framing. Metres, radians, frames.

Requests over time name their first and last frame (``start``, ``end``); every frame between is measured.
"""

from __future__ import annotations

from dataclasses import dataclass

from agents.protocol.facts import Vector
from agents.protocol.measures.requests import Measure, Names, Request


class MotionPathMeasure(Measure):
    """A motion; each list has an entry per frame from ``start`` on.

    ``measured`` says what was followed: vertices, particles, fluid or origin. ``deforms``: its points move relative to
    each other. ``size``: its largest extent. ``centres`` are the means of its surface, particles or fluid, ``origins``
    the means of its objects' origins; None where it does not exist. ``speeds`` (m/s) are means of the same, or the
    speed of the centre where points cannot be followed; ``rotations`` are axes as long as the angle: both since the
    frame before, None where unknown. ``ways``: the mean distance of its points from where they were at the last mark.
    ``reaches``: how far its farthest point is from where its centre was at the last mark (or first, if it began to
    exist later).
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
    reaches: tuple[float | None, ...] = ()


@dataclass(frozen=True)
class MotionPathRequest(Request[MotionPathMeasure], kind="path", answer=MotionPathMeasure):
    """How the named objects move together. ``marks`` are the frames from which distances are measured."""

    names: Names
    start: int
    end: int
    marks: tuple[int, ...] = ()


class RelativeMotionMeasure(Measure):
    """The largest shift and rotation of ``a`` relative to ``b``, with their frames.

    ``turn`` is None where one of the two has no rotation: particles and fluids.
    """

    shift: float
    shift_frame: int
    at: Vector | None = None
    turn: float | None = None
    turn_frame: int | None = None


@dataclass(frozen=True)
class RelativeMotionRequest(Request[RelativeMotionMeasure], kind="together", answer=RelativeMotionMeasure):
    """How ``a`` keeps its place relative to ``b``, where the two are nearest, from the first frame on."""

    a: Names
    b: Names
    start: int
    end: int


class ContactFramesMeasure(Measure):
    """The frames at which two objects touch, or come to touch on the way from the frame before."""

    frames: tuple[int, ...]


@dataclass(frozen=True)
class ContactFramesRequest(Request[ContactFramesMeasure], kind="touches", answer=ContactFramesMeasure):
    """When ``a`` and ``b`` are at most ``within`` apart, on top of the distance that their collision settings keep.

    ``once``: only the first frame is wanted.
    """

    a: Names
    b: Names
    start: int
    end: int
    within: float
    once: bool = False


class PassageMeasure(Measure):
    """The largest depth of an object in a collider, and its frame; 0 where it stayed outside.

    ``through``: it passed from one side to the other since the frame before. ``pair``: the mesh and the collider's
    mesh that got so deep.
    """

    depth: float
    through: bool = False
    frame: int | None = None
    at: Vector | None = None
    pair: tuple[str, str] | None = None


@dataclass(frozen=True)
class PassageRequest(Request[PassageMeasure], kind="passage", answer=PassageMeasure):
    """How deep the objects ``a`` get into the colliders ``b`` on their way; depths below ``beyond`` are ignored.

    ``but_first``: what is in each other at the first frame already is as deep as it may be.
    """

    a: Names
    b: Names
    start: int
    end: int
    beyond: float
    but_first: bool = False


class CameraViewMeasure(Measure):
    """What the active camera sees of an object; all None where the object does not exist yet.

    ``inside``: the share of its samples in the picture; ``hidden``: the share of these that other objects hide;
    ``cover``: the share of the picture that its outline fills.
    """

    inside: float | None = None
    cover: float | None = None
    hidden: float | None = None
    by: Names = ()
    at: Vector | None = None


@dataclass(frozen=True)
class CameraViewRequest(Request[CameraViewMeasure], kind="view", answer=CameraViewMeasure):
    """How the active camera sees the named objects. In the answer, ``by`` names what hides them, the most first."""

    names: Names
    frame: int | None = None


class MatterMeasure(Measure):
    """The liquid or gas of a domain; all None while there is none.

    ``volume``: what a liquid's surface encloses, in m³. Shares of all matter: ``lid`` within a cell or two of the
    domain's top, ``sides`` of its sides, ``away`` outside its sources.
    """

    volume: float | None = None
    lid: float | None = None
    sides: float | None = None
    away: float | None = None


@dataclass(frozen=True)
class MatterRequest(Request[MatterMeasure], kind="matter", answer=MatterMeasure):
    """How much there is in a fluid's domain, and where. ``sources`` are the meshes that it comes out of."""

    domain: str
    sources: Names
    frame: int | None = None
