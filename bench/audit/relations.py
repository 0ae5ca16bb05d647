"""What each relation type means, and whether it holds: measurements at a moment in, a verdict out.

A definition is the docstring of its unit: what is measured, the threshold, and why. Units are pure functions of one
moment; a relation holds when its unit does at every moment that the spec names.
"""

from __future__ import annotations

import inspect
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from bench.audit.relation_measures import Measured, Want
    from bench.scenes.spec import RelationType

# Of a slope, what lies vertically beneath is further than what is nearest: twice as far at 60 degrees.
_SLOPE = 2.0
_MOST = 0.5
_NEARLY_ALL = 0.9
_MOSTLY_OVER = 0.75
_BESIDE = 0.25


@dataclass(frozen=True, slots=True)
class Stands:
    """Whether a relation holds at a moment, and the values that this was read off."""

    holds: bool
    seen: dict[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True, slots=True)
class Kind:
    """A row of the table. ``judge`` gets a moment's measurements, the tolerance, and whether both are bodies.

    What is no body (a source of fluid or of particles, a force) may be in anything.
    """

    judge: Callable[[Measured, float, bool], Stands]
    wants: tuple[Want, ...] = ()

    @property
    def definition(self) -> str:
        """What it measures, its threshold and why: one paragraph."""
        return " ".join((inspect.getdoc(self.judge) or "").split())


def supported_by(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` rests on ``b``: their surfaces are at most the tolerance apart, something of ``b`` lies beneath something
    of ``a`` at a free height of at most twice the tolerance (on a slope what is beneath is further off than what is
    nearest), and neither is deeper in the other than the tolerance. What hovers, stands beside or has sunk in is not
    supported; a cloth may hang down around what it lies on."""
    near = _at_most(now.gap, tolerance) and _at_most(now.clearance, _SLOPE * tolerance)
    deep = bodies and not _at_most(now.depth, tolerance)
    return Stands(near and not deep, {"gap": now.gap, "clearance": now.clearance, "depth": now.depth})


def on_top_of(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` stands on the top of ``b``: it is supported by it, no part of it reaches below the height at which it
    touches by more than the tolerance, and at least 90 % of what vertical lines meet of ``a`` lies over ``b``. Stricter
    than being supported: nothing may hang down."""
    rests = supported_by(now, tolerance, bodies)
    low, contact, over = now.a_low[2], now.contact, now.over
    whole = contact is not None and low >= contact - tolerance and over is not None and over >= _NEARLY_ALL
    return Stands(rests.holds and whole, {**rests.seen, "low": low, "contact": contact, "over": over})


def inside(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` is in ``b``: at least half of the points spread over ``a`` lie within the bounds of ``b`` (grown by the
    tolerance) and are enclosed: of 14 directions around such a point, at least 8 meet ``b``. An open bowl, box or shelf
    encloses what is below its rim; half suffices, since things stick out of what holds them."""
    del tolerance, bodies
    return Stands(_at_least(now.inside, _MOST), {"inside": now.inside})


def in_contact(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` touches ``b``: their surfaces are at most the tolerance apart, and most of neither is within the other's
    solid. A post in the ground, a chimney through a roof and a ship in water touch; a thing that has been swallowed
    does not."""
    return Stands(
        _at_most(now.gap, tolerance) and not (bodies and _swallowed(now)),
        {"gap": now.gap, "depth": now.depth, "a_in_b": now.a_in_b, "b_in_a": now.b_in_a},
    )


def against(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` stands or leans against ``b``: their surfaces are at most the tolerance apart, neither is deeper in the
    other than the tolerance, and they are beside each other: their heights overlap by at least a quarter of the lower
    one's. What merely stands on the other does not lean on it."""
    shared = min(now.a_high[2], now.b_high[2]) - max(now.a_low[2], now.b_low[2])
    least = min(now.a_high[2] - now.a_low[2], now.b_high[2] - now.b_low[2])
    beside = shared >= _BESIDE * least - tolerance
    deep = bodies and not _at_most(now.depth, tolerance)
    seen = {"gap": now.gap, "depth": now.depth, "shared_height": round(shared, 5)}
    return Stands(_at_most(now.gap, tolerance) and beside and not deep, seen)


def attached_to(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` hangs on, or is fixed to, ``b``: their surfaces are at most the tolerance apart at each moment asked for.
    How deep one is in the other does not matter: what is fixed is often let in, screwed in or threaded through."""
    del bodies
    return Stands(_at_most(now.gap, tolerance), {"gap": now.gap})


def next_to(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` is near ``b``: their surfaces are at most the tolerance apart, on whatever side, and most of neither is
    within the other's solid. The spec says with its tolerance how near is near for these things."""
    return Stands(
        _at_most(now.gap, tolerance) and not (bodies and _swallowed(now)),
        {"gap": now.gap, "a_in_b": now.a_in_b, "b_in_a": now.b_in_a},
    )


def above(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` is over ``b``, at whatever height, touching or not: of what vertical lines through both meet of ``a``, at
    least three quarters have ``b`` under them and not over them (up to the tolerance counts as level; what has ``b`` on
    both sides counts half). Where no vertical line meets both, ``a`` is above if its lowest point is higher than the
    middle of ``b`` and both are no further apart in plan than ``a`` is wide there, or the tolerance: a spout on the
    wall over a basin."""
    del bodies
    if now.lines and now.over is not None:
        return Stands(
            now.over >= _MOSTLY_OVER, {"over": now.over, "lines": now.lines, "clearance": now.clearance}
        )
    middle = (now.b_low[2] + now.b_high[2]) / 2
    apart = _plan_gap(now)
    width = max(now.a_high[0] - now.a_low[0], now.a_high[1] - now.a_low[1], tolerance)
    higher = now.a_low[2] >= middle - tolerance
    seen = {"low": now.a_low[2], "middle_of_b": round(middle, 5), "plan_gap": round(apart, 5)}
    return Stands(higher and apart <= width, seen)


def below(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` is under ``b``: ``b`` is above ``a``, as Above says."""
    return above(now, tolerance, bodies)


def left_of(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` is to the left of ``b`` for who looks through the scene's camera at that moment (along +Y where there is
    none): along the camera's horizontal, the middle of ``a`` is on the left of that of ``b``, and they overlap by no
    more than half of the narrower one, or the tolerance."""
    del bodies
    return _beside(now.right, tolerance, towards=-1)


def right_of(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` is to the right of ``b`` for who looks through the scene's camera: as LeftOf, on the other side."""
    del bodies
    return _beside(now.right, tolerance, towards=1)


def in_front_of(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` is in front of ``b`` for who looks through the scene's camera at that moment (along +Y where there is
    none): along the ground towards the camera, the middle of ``a`` is nearer than that of ``b``, and they overlap by no
    more than half of the less deep one, or the tolerance. Which side is a thing's own front, no mesh tells."""
    del bodies
    return _beside(now.near, tolerance, towards=1)


def behind(now: Measured, tolerance: float, bodies: bool) -> Stands:
    """``a`` is behind ``b`` for who looks through the scene's camera: as InFrontOf, on the other side."""
    del bodies
    return _beside(now.near, tolerance, towards=-1)


KINDS: Mapping[RelationType, Kind] = {
    "SupportedBy": Kind(supported_by, ("columns",)),
    "OnTopOf": Kind(on_top_of, ("columns",)),
    "Inside": Kind(inside, ("inside",)),
    "InContact": Kind(in_contact, ("depth",)),
    "Against": Kind(against, ("depth",)),
    "AttachedTo": Kind(attached_to),
    "NextTo": Kind(next_to, ("depth",)),
    "Above": Kind(above, ("columns",)),
    "Below": Kind(below, ("columns",)),
    "LeftOf": Kind(left_of, ("view",)),
    "RightOf": Kind(right_of, ("view",)),
    "InFrontOf": Kind(in_front_of, ("view",)),
    "Behind": Kind(behind, ("view",)),
}


def _at_most(value: float | None, most: float) -> bool:
    return value is not None and value <= most


def _at_least(value: float | None, least: float) -> bool:
    return value is not None and value >= least


def _swallowed(now: Measured) -> bool:
    return now.a_in_b > _MOST or now.b_in_a > _MOST


def _plan_gap(now: Measured) -> float:
    """How far apart the bounds are in plan."""
    apart = [max(now.a_low[i] - now.b_high[i], now.b_low[i] - now.a_high[i], 0.0) for i in (0, 1)]
    return (apart[0] ** 2 + apart[1] ** 2) ** 0.5


def _beside(reaches: tuple[float, float, float, float] | None, tolerance: float, towards: int) -> Stands:
    if reaches is None:
        return Stands(False)
    a_low, a_high, b_low, b_high = reaches
    offset = towards * ((a_low + a_high) - (b_low + b_high)) / 2
    overlap = min(a_high, b_high) - max(a_low, b_low)
    allowed = max(tolerance, _MOST * min(a_high - a_low, b_high - b_low))
    seen = {"offset": round(offset, 5), "overlap": round(overlap, 5), "allowed": round(allowed, 5)}
    return Stands(offset > 0 and overlap <= allowed, seen)
