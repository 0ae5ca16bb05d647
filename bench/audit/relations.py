"""The relation types: for each, a pure function from the measurements at one frame to a verdict.

The docstring of a function is the relation's definition: what is measured, the threshold, and why. A relation holds if
its function says so at every time that the spec names.
"""

from __future__ import annotations

import inspect
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from bench.audit.relation_measures import PairMeasurement, Quantity
    from bench.scenes.spec import RelationType

# On a slope, the surface vertically below is further away than the nearest one: twice as far at 60 degrees.
_SLOPE = 2.0
_HALF = 0.5
_NEARLY_ALL = 0.9
_MOSTLY_OVER = 0.75
_BESIDE = 0.25


@dataclass(frozen=True, slots=True)
class RelationVerdict:
    """Whether a relation holds at a frame, and the values that decided it."""

    holds: bool
    seen: dict[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True, slots=True)
class RelationRule:
    """An entry of the table. ``judge`` gets the measurements at a frame, the tolerance, and whether both are bodies.

    Fluids, forces and sources of fluid or particles are not bodies: they may overlap anything.
    """

    judge: Callable[[PairMeasurement, float, bool], RelationVerdict]
    wants: tuple[Quantity, ...] = ()

    @property
    def definition(self) -> str:
        """What is measured, the threshold and why: one paragraph."""
        return " ".join((inspect.getdoc(self.judge) or "").split())


def supported_by(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` rests on ``b``: their surfaces are at most the tolerance apart, part of ``b`` is vertically below part of
    ``a`` with a gap of at most twice the tolerance (on a slope the surface below is further away than the nearest
    one), and neither penetrates the other by more than the tolerance. Objects that hover, stand beside or have sunk in
    are not supported; a cloth may hang down around its support."""
    near = _at_most(now.gap, tolerance) and _at_most(now.clearance, _SLOPE * tolerance)
    deep = bodies and not _at_most(now.depth, tolerance)
    return RelationVerdict(
        near and not deep, {"gap": now.gap, "clearance": now.clearance, "depth": now.depth}
    )


def on_top_of(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` stands on top of ``b``: it is supported by ``b``, no part of it is lower than the height of contact by more
    than the tolerance, and at least 90 % of what vertical lines hit of ``a`` is over ``b``. This is stricter than
    SupportedBy: nothing may hang down."""
    rests = supported_by(now, tolerance, bodies)
    low, contact, over = now.a_low[2], now.contact, now.over
    whole = contact is not None and low >= contact - tolerance and over is not None and over >= _NEARLY_ALL
    return RelationVerdict(
        rests.holds and whole, {**rests.seen, "low": low, "contact": contact, "over": over}
    )


def inside(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` is in ``b``: at least half of the points spread over ``a`` lie within the bounds of ``b`` (grown by the
    tolerance) and are enclosed: of 14 rays around such a point, at least 8 hit ``b``. An open bowl, box or shelf
    encloses what is below its rim. Half is enough, since contents often stick out of their container."""
    del tolerance, bodies
    return RelationVerdict(_at_least(now.inside, _HALF), {"inside": now.inside})


def in_contact(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` touches ``b``: their surfaces are at most the tolerance apart, and at most half of either is inside the
    other's solid. A post in the ground, a chimney through a roof and a ship in water touch; an object that is
    swallowed does not."""
    return RelationVerdict(
        _at_most(now.gap, tolerance) and not (bodies and _swallowed(now)),
        {"gap": now.gap, "depth": now.depth, "a_in_b": now.a_in_b, "b_in_a": now.b_in_a},
    )


def against(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` stands or leans against ``b``: their surfaces are at most the tolerance apart, neither penetrates the other
    by more than the tolerance, and they are side by side: their vertical extents overlap by at least a quarter of the
    shorter one. An object that only stands on the other does not lean on it."""
    shared = min(now.a_high[2], now.b_high[2]) - max(now.a_low[2], now.b_low[2])
    least = min(now.a_high[2] - now.a_low[2], now.b_high[2] - now.b_low[2])
    beside = shared >= _BESIDE * least - tolerance
    deep = bodies and not _at_most(now.depth, tolerance)
    seen = {"gap": now.gap, "depth": now.depth, "shared_height": round(shared, 5)}
    return RelationVerdict(_at_most(now.gap, tolerance) and beside and not deep, seen)


def attached_to(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` hangs on, or is fixed to, ``b``: their surfaces are at most the tolerance apart at each of the relation's
    times. How deep one is in the other does not matter: fixed parts are often embedded, screwed in or threaded
    through."""
    del bodies
    return RelationVerdict(_at_most(now.gap, tolerance), {"gap": now.gap})


def next_to(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` is near ``b``: their surfaces are at most the tolerance apart, on any side, and at most half of either is
    inside the other's solid. The spec's tolerance says what is near for these two."""
    return RelationVerdict(
        _at_most(now.gap, tolerance) and not (bodies and _swallowed(now)),
        {"gap": now.gap, "a_in_b": now.a_in_b, "b_in_a": now.b_in_a},
    )


def above(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` is over ``b``, at any height, touching or not: of what vertical lines through both hit of ``a``, at least
    three quarters have ``b`` below and not above (differences up to the tolerance count as level; parts with ``b`` on
    both sides count half). If no vertical line hits both, ``a`` is above if its lowest point is higher than the middle
    of ``b`` and they are no further apart in plan than ``a`` is wide there, or than the tolerance: a spout on the wall
    over a basin."""
    del bodies
    if now.lines and now.over is not None:
        return RelationVerdict(
            now.over >= _MOSTLY_OVER, {"over": now.over, "lines": now.lines, "clearance": now.clearance}
        )
    middle = (now.b_low[2] + now.b_high[2]) / 2
    apart = _plan_gap(now)
    width = max(now.a_high[0] - now.a_low[0], now.a_high[1] - now.a_low[1], tolerance)
    higher = now.a_low[2] >= middle - tolerance
    seen = {"low": now.a_low[2], "middle_of_b": round(middle, 5), "plan_gap": round(apart, 5)}
    return RelationVerdict(higher and apart <= width, seen)


def below(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` is under ``b``: ``b`` is above ``a``, as for Above."""
    return above(now, tolerance, bodies)


def left_of(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` is to the left of ``b`` as seen by the scene's camera at that time (without a camera, looking along +Y):
    along the camera's horizontal, the middle of ``a`` is left of the middle of ``b``, and they overlap by at most half
    of the narrower one, or the tolerance."""
    del bodies
    return _beside(now.right, tolerance, towards=-1)


def right_of(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` is to the right of ``b`` as seen by the scene's camera: as LeftOf, on the other side."""
    del bodies
    return _beside(now.right, tolerance, towards=1)


def in_front_of(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` is in front of ``b`` as seen by the scene's camera at that time (without a camera, looking along +Y): along
    the ground towards the camera, the middle of ``a`` is nearer than the middle of ``b``, and they overlap by at most
    half of the less deep one, or the tolerance. A mesh does not say which side is its own front."""
    del bodies
    return _beside(now.near, tolerance, towards=1)


def behind(now: PairMeasurement, tolerance: float, bodies: bool) -> RelationVerdict:
    """``a`` is behind ``b`` as seen by the scene's camera: as InFrontOf, on the other side."""
    del bodies
    return _beside(now.near, tolerance, towards=-1)


RELATIONS: Mapping[RelationType, RelationRule] = {
    "SupportedBy": RelationRule(supported_by, ("columns",)),
    "OnTopOf": RelationRule(on_top_of, ("columns",)),
    "Inside": RelationRule(inside, ("inside",)),
    "InContact": RelationRule(in_contact, ("depth",)),
    "Against": RelationRule(against, ("depth",)),
    "AttachedTo": RelationRule(attached_to),
    "NextTo": RelationRule(next_to, ("depth",)),
    "Above": RelationRule(above, ("columns",)),
    "Below": RelationRule(below, ("columns",)),
    "LeftOf": RelationRule(left_of, ("view",)),
    "RightOf": RelationRule(right_of, ("view",)),
    "InFrontOf": RelationRule(in_front_of, ("view",)),
    "Behind": RelationRule(behind, ("view",)),
}


def _at_most(value: float | None, most: float) -> bool:
    return value is not None and value <= most


def _at_least(value: float | None, least: float) -> bool:
    return value is not None and value >= least


def _swallowed(now: PairMeasurement) -> bool:
    return now.a_in_b > _HALF or now.b_in_a > _HALF


def _plan_gap(now: PairMeasurement) -> float:
    """How far apart the bounds are in plan."""
    apart = [max(now.a_low[i] - now.b_high[i], now.b_low[i] - now.a_high[i], 0.0) for i in (0, 1)]
    return (apart[0] ** 2 + apart[1] ** 2) ** 0.5


def _beside(
    reaches: tuple[float, float, float, float] | None, tolerance: float, towards: int
) -> RelationVerdict:
    if reaches is None:
        return RelationVerdict(False)
    a_low, a_high, b_low, b_high = reaches
    offset = towards * ((a_low + a_high) - (b_low + b_high)) / 2
    overlap = min(a_high, b_high) - max(a_low, b_low)
    allowed = max(tolerance, _HALF * min(a_high - a_low, b_high - b_low))
    seen = {"offset": round(offset, 5), "overlap": round(overlap, 5), "allowed": round(allowed, 5)}
    return RelationVerdict(offset > 0 and overlap <= allowed, seen)
