"""Measures of contact and containment. Metres, degrees."""

from __future__ import annotations

from dataclasses import dataclass

from agents.protocol.facts import Vector
from agents.protocol.measures.requests import Measure, Names, Request


class DepthMeasure(Measure):
    """The largest depth of two objects in each other, and where; ``at`` is None if they are apart."""

    depth: float
    at: Vector | None = None


@dataclass(frozen=True)
class DepthRequest(Request[DepthMeasure], kind="depth", answer=DepthMeasure):
    """How deep ``a`` and ``b`` are in each other."""

    a: Names
    b: Names
    frame: int | None = None


class SupportMeasure(Measure):
    """What supports a child.

    ``opposed``: the smallest cosine between the normals of the child and of what is right below it at a contact; None
    without contacts, and then ``clearance`` is the child's height above what is below it, None over nothing.
    ``bearing``: the outline of the contacts with opposed normals; ``centre``: the child's centre of mass.
    """

    centre: Vector
    opposed: float | None = None
    clearance: float | None = None
    at: Vector | None = None
    bearing: tuple[Vector, ...] = ()


@dataclass(frozen=True)
class SupportRequest(Request[SupportMeasure], kind="support", answer=SupportMeasure):
    """Where the child rests on its parents: at most ``within`` above them.

    A contact supports the child where the cosine of the normals is at most ``opposed``.
    """

    child: Names
    parents: Names
    within: float
    opposed: float
    frame: int | None = None


class FlushMeasure(Measure):
    """How a face of the child lies against a face of the parent.

    ``angle`` is between the two faces, ``stands_out`` is the overhang of the child's; both are None where they do not
    touch. ``touching``: the outline of all contacts.
    """

    angle: float | None = None
    stands_out: float | None = None
    at: Vector | None = None
    touching: tuple[Vector, ...] = ()


@dataclass(frozen=True)
class FlushRequest(Request[FlushMeasure], kind="flush", answer=FlushMeasure):
    """How a face of the child, at most ``within`` from the parent, lies against it. ``sideways``: not on top of it."""

    child: Names
    parent: Names
    within: float
    sideways: bool
    frame: int | None = None


class OpeningMeasure(Measure):
    """How a filler sits in an opening.

    ``unbounded``: the largest angle around the filler in which the host has no rim; 360 where there is no opening.
    ``gap``: the largest distance of the rim from the filler; None without a rim.
    """

    unbounded: float
    gap: float | None = None
    at: Vector | None = None


@dataclass(frozen=True)
class OpeningRequest(Request[OpeningMeasure], kind="opening", answer=OpeningMeasure):
    """How the filler sits in an opening of the host."""

    filler: Names
    host: Names
    frame: int | None = None


class EnclosureMeasure(Measure):
    """Shares of the content's samples ``inside`` the cavity and in the container's ``wall``; ``at`` is one outside."""

    inside: float
    wall: float
    at: Vector | None = None


@dataclass(frozen=True)
class EnclosureRequest(Request[EnclosureMeasure], kind="enclosure", answer=EnclosureMeasure):
    """How much of the content is in the container's cavity; up to ``noise`` deep in its wall still counts as inside."""

    content: Names
    container: Names
    noise: float
    frame: int | None = None


@dataclass(frozen=True)
class EmbeddingRequest(Request[DepthMeasure], kind="embedding", answer=DepthMeasure):
    """How far the part would have to be pulled to leave the host."""

    part: Names
    host: Names
    frame: int | None = None
