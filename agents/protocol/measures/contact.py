"""What the rules about contact and containment have measured. Metres, degrees."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from agents.protocol.facts import Vector
from agents.protocol.measures.measure import Measure, Names, Request


class DepthMeasure(Measure):
    """The greatest depth of one thing in another; ``at`` is where, None for things that are apart."""

    depth: float
    at: Vector | None = None


@dataclass(frozen=True)
class Depth(Request[DepthMeasure]):
    """How deep ``a`` and ``b`` are in each other."""

    kind: ClassVar[str] = "depth"
    answer: ClassVar[type[Measure]] = DepthMeasure
    a: Names
    b: Names
    frame: int | None = None


class SupportMeasure(Measure):
    """What bears a child.

    ``opposed``: the least cosine between normals of the child and of what is right below it at a contact, None without
    any; then ``clearance`` is the height of the child above what is below it, None over nothing. ``bearing``: the
    outline of the contacts whose normals are opposed, ``centre`` the child's centre of mass.
    """

    centre: Vector
    opposed: float | None = None
    clearance: float | None = None
    at: Vector | None = None
    bearing: tuple[Vector, ...] = ()


@dataclass(frozen=True)
class Support(Request[SupportMeasure]):
    """Where the child's surface is at most ``within`` from its parents', from above.

    The contacts bear it where the cosine of the normals is at most ``opposed``.
    """

    kind: ClassVar[str] = "support"
    answer: ClassVar[type[Measure]] = SupportMeasure
    child: Names
    parents: Names
    within: float
    opposed: float
    frame: int | None = None


class FlushMeasure(Measure):
    """How a face of the child lies at one of the parent.

    ``angle`` is between the two, ``stands_out`` how far the child's reaches beyond the parent's; both None where
    they do not touch. ``touching``: the outline of all contacts.
    """

    angle: float | None = None
    stands_out: float | None = None
    at: Vector | None = None
    touching: tuple[Vector, ...] = ()


@dataclass(frozen=True)
class Flush(Request[FlushMeasure]):
    """How a face of the child, at most ``within`` from the parent, lies at it. ``sideways``: not on top of it."""

    kind: ClassVar[str] = "flush"
    answer: ClassVar[type[Measure]] = FlushMeasure
    child: Names
    parent: Names
    within: float
    sideways: bool
    frame: int | None = None


class OpeningMeasure(Measure):
    """How a filler sits in an opening.

    ``unbounded``: the widest angle around the filler in which the host has no rim; 360 where there is no opening.
    ``gap``: the greatest distance of the rim from the filler, None without a rim.
    """

    unbounded: float
    gap: float | None = None
    at: Vector | None = None


@dataclass(frozen=True)
class Opening(Request[OpeningMeasure]):
    """How the filler sits in an opening of the host."""

    kind: ClassVar[str] = "opening"
    answer: ClassVar[type[Measure]] = OpeningMeasure
    filler: Names
    host: Names
    frame: int | None = None


class EnclosureMeasure(Measure):
    """Shares of the content's samples: ``inside`` the cavity, and in the container's ``wall``; ``at``: one outside."""

    inside: float
    wall: float
    at: Vector | None = None


@dataclass(frozen=True)
class Enclosure(Request[EnclosureMeasure]):
    """How much of the content is in the container's cavity; ``noise`` deep in its wall still counts as in it."""

    kind: ClassVar[str] = "enclosure"
    answer: ClassVar[type[Measure]] = EnclosureMeasure
    content: Names
    container: Names
    noise: float
    frame: int | None = None


@dataclass(frozen=True)
class Embedding(Request[DepthMeasure]):
    """How far the part would have to be pulled to be out of the host."""

    kind: ClassVar[str] = "embedding"
    answer: ClassVar[type[Measure]] = DepthMeasure
    part: Names
    host: Names
    frame: int | None = None
