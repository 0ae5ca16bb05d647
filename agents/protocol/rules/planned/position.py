"""R10 to R13: where objects are relative to each other, and how they are oriented."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agents.plan.relations import SIDES, Direction, Facing, NextTo, OnTopOf, ParallelTo, Upright
from agents.protocol.judging.geometry.poses import anchor, pose, pose_request
from agents.protocol.judging.geometry.vectors import angle_between, as_vector, rotated
from agents.protocol.judging.measured_motion import mesh_names
from agents.protocol.judging.planned_relations import Violation, relation_rule, surface_pair, surfaces
from agents.protocol.judging.sizes import contact_gap
from agents.protocol.measures.geometry import ExtentsRequest, GapRequest
from agents.protocol.measures.motion import MotionPathRequest
from agents.protocol.measures.position import DirectionRequest, FootprintRequest
from agents.protocol.measures.requests import Unmeasured
from agents.protocol.tolerances import CONTACT

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from agents.protocol.judging.geometry.vectors import Array
    from agents.protocol.measures.requests import Measures, Request
    from agents.protocol.rule import RuleContext

_STAY_UP = (
    "It has toppled, or was turned: give it a wider base, more of its mass below (a soft body: by a vertex group), or "
    "a slower start; then bake again."
)
_UP = np.array([0.0, 0.0, 1.0])
_SAME_PLACE = 1e-3  # metres in plan view below which there is no direction from one place to another


# On top of


def _footprint(context: RuleContext, relation: OnTopOf, frame: int | None) -> FootprintRequest:
    return FootprintRequest(*surface_pair(context, *relation.nodes), frame)


def _footprint_requests(
    context: RuleContext, relation: OnTopOf, frame: int | None
) -> Iterator[FootprintRequest]:
    yield _footprint(context, relation, frame)


def _not_on_top(
    context: RuleContext, measures: Measures, relation: OnTopOf, frame: int | None
) -> Iterator[Violation]:
    request = _footprint(context, relation, frame)
    footprint, least = measures[request], context.tolerances.footprint
    if footprint.share < least:
        yield Violation(
            f"only {footprint.share:.0%} of {relation.a!r} is over {relation.b!r}, seen from above.",
            footprint.share,
            least,
            at=footprint.at,
            fix="Move the upper object over the lower one.",
        )
    most = contact_gap(context, request.a, request.b)
    if footprint.sunk is not None and footprint.sunk > most:
        yield Violation(
            f"{relation.a!r} begins {footprint.sunk * 1000:.1f} mm below the top of {relation.b!r}.",
            footprint.sunk,
            most,
            "m",
            footprint.at,
            "Move the upper object up by that distance.",
        )


# Next to


def _gap(context: RuleContext, relation: NextTo, frame: int | None) -> GapRequest:
    return GapRequest(*surface_pair(context, *relation.nodes), frame)


def _gap_requests(context: RuleContext, relation: NextTo, frame: int | None) -> Iterator[GapRequest]:
    yield _gap(context, relation, frame)


def _not_next_to(
    context: RuleContext, measures: Measures, relation: NextTo, frame: int | None
) -> Iterator[Violation]:
    gap = measures[_gap(context, relation, frame)]
    tolerances = context.tolerances
    least, most = (
        bound + sign * max(tolerances.distance, tolerances.distance_share * bound)
        for bound, sign in zip(relation.gap, (-1, 1), strict=True)
    )
    if not least <= gap.distance <= most:
        too_near = gap.distance < least
        change = relation.gap[0] - gap.distance if too_near else gap.distance - relation.gap[1]
        yield Violation(
            f"{relation.a!r} and {relation.b!r} are {gap.distance:.3f} m apart; "
            f"the plan says {relation.gap[0]:g} to {relation.gap[1]:g} m.",
            gap.distance,
            least if too_near else most,
            "m",
            gap.here,
            f"Move {relation.a!r} {change:.3f} m {'away from' if too_near else 'towards'} {relation.b!r}.",
        )


# Directions


def _direction(context: RuleContext, relation: Direction, frame: int | None) -> DirectionRequest:
    """Raises Unmeasured."""
    axis, sign = SIDES[relation.kind]
    of: str | None = None
    if axis != 2 and relation.frame == "reference":
        of = anchor(context, relation.b)
    elif axis != 2 and relation.frame == "camera":
        of = context.facts.camera
        if of is None:
            raise Unmeasured("the scene has no camera to judge left and right by")
        if frame is None and context.structure.can_move(of):
            frame = context.facts.frame_start
    turned = tuple(name for node in relation.nodes if (name := anchor(context, node)) is not None)
    a, b = surface_pair(context, *relation.nodes)
    level = relation.frame == "camera"
    return DirectionRequest(a, b, axis, sign, turned, context.tolerances.cone, of, level, frame)


def _direction_requests(
    context: RuleContext, relation: Direction, frame: int | None
) -> Iterator[DirectionRequest]:
    if relation.frame != "camera" or context.facts.camera:
        yield _direction(context, relation, frame)


def _wrong_side(
    context: RuleContext, measures: Measures, relation: Direction, frame: int | None
) -> Iterator[Violation]:
    request = _direction(context, relation, frame)
    side = measures[request]
    most = contact_gap(context, request.a, request.b)
    a, b, cone = relation.a, relation.b, context.tolerances.cone
    seen = {"world": "", "reference": f" as {b!r} is turned", "camera": " seen from the camera"}[
        relation.frame
    ]
    if side.angle > cone:
        sentence = f"{a!r} lies {side.angle:.0f}° away from the direction {relation.kind} {b!r}{seen}."
        fix = f"Move {a!r} to that side of {b!r} ({relation.kind}{seen})."
        yield Violation(sentence, side.angle, cone, "°", side.at, fix)
    elif side.gap < -most:
        yield Violation(
            f"{a!r} overlaps {b!r} by {-side.gap * 1000:.1f} mm in the direction {relation.kind}{seen}.",
            -side.gap,
            most,
            "m",
            side.at,
        )


# Orientation


def _orientation_requests(
    context: RuleContext, relation: Upright | Facing | ParallelTo, frame: int | None
) -> Iterator[Request[Any]]:
    for node in relation.nodes:
        if request := pose_request(context, node, frame):
            yield request
    if isinstance(relation, Facing):
        yield _faced_extents(context, relation, frame)
    if isinstance(relation, Upright) and (way := _way_there(context, relation, frame)):
        yield way
        if request := pose_request(context, relation.a, way.start):
            yield request


def _way_there(context: RuleContext, relation: Upright, frame: int | None) -> MotionPathRequest | None:
    """How the meshes of what moves come to where they are at last: a solver turns them, and not their root."""
    first, names = context.facts.frame_start, mesh_names(context, relation.a)
    if relation.when == "start_or_end" or frame is None or frame <= first or not names:
        return None
    return MotionPathRequest(names, first, frame)


def _leaning(
    context: RuleContext, measures: Measures, relation: Upright, frame: int | None
) -> tuple[float, float, Array]:
    """(its lean in degrees, the most that it may, its place)."""
    tolerances = context.tolerances
    request = _way_there(context, relation, frame)
    path = measures[request] if request is not None else None
    turns = path.rotations[1:] if path is not None else ()
    if path is None or None in turns:
        place, axes = pose(context, measures, relation.a, frame)
        return angle_between(axes[2], _UP), tolerances.upright, place
    assert request is not None
    up = pose(context, measures, relation.a, request.start)[1][2]
    for turn in turns:
        up = rotated(up, np.array(turn))
    place = np.array(path.centres[-1] or (0.0, 0.0, 0.0))
    return angle_between(up, _UP), tolerances.toppled if path.deforms else tolerances.upright, place


def _faced_extents(context: RuleContext, relation: Facing, frame: int | None) -> ExtentsRequest:
    return ExtentsRequest(surfaces(context, relation.b), frame=frame, of=anchor(context, relation.b))


def _misoriented(
    context: RuleContext, measures: Measures, relation: Upright | Facing | ParallelTo, frame: int | None
) -> Iterator[Violation]:
    tolerances = context.tolerances
    fix = ""
    if isinstance(relation, Upright):
        off, most, place = _leaning(context, measures, relation, frame)
        sentence = f"{relation.a!r} leans by {off:.1f}°."
        if _way_there(context, relation, frame):
            fix = _STAY_UP
        if off > most:
            yield Violation(sentence, off, most, "°", as_vector(place), fix)
        return
    place, axes = pose(context, measures, relation.a, frame)
    if isinstance(relation, Facing):
        towards = _faced_point(context, measures, relation, frame, place) - place
        if float(np.linalg.norm(towards[:2])) < _SAME_PLACE:
            raise Unmeasured(f"{relation.a!r} is right above, below or inside {relation.b!r}")
        off, most = angle_between(-axes[1][:2], towards[:2]), tolerances.facing
        sentence = f"the front (−Y) of {relation.a!r} points {off:.1f}° away from {relation.b!r}."
        front = -axes[1]
        turn = math.degrees(
            math.atan2(front[0] * towards[1] - front[1] * towards[0], float(front[:2] @ towards[:2]))
        )
        fix = f"Turn the root of {relation.a!r} by {turn:+.1f}° about Z.".replace("-", "−")
    else:
        other = pose(context, measures, relation.b, frame)[1]
        # A box turned by a right angle is still parallel: each of its axes has one of the other's to run along.
        off = max(min(min(angle_between(a, b), angle_between(a, -b)) for b in other) for a in axes)
        most = tolerances.parallel
        sentence = f"the axes of {relation.a!r} and {relation.b!r} differ by {off:.1f}°."
    if off > most:
        yield Violation(sentence, off, most, "°", as_vector(place), fix)


def _faced_point(
    context: RuleContext, measures: Measures, relation: Facing, frame: int | None, place: Array
) -> Array:
    """The point on the middle line of ``b`` that an object at ``place`` faces: chairs along a table stand in a row."""
    axes = pose(context, measures, relation.b, frame)[1]
    extents = measures[_faced_extents(context, relation, frame)]
    low, high = np.array(extents.low), np.array(extents.high)
    middle, size = (low + high) / 2, high - low
    longer = int(size[1] > size[0])
    half = float(size[longer] - size[1 - longer]) / 2
    along = float(np.clip((axes @ place)[longer] - middle[longer], -half, half))
    return (middle + along * np.eye(3)[longer]) @ axes


R10 = relation_rule(
    "R10",
    "on top of",
    "OnTopOf(a, b): seen from above, at least a quarter of a's outline is over b; where the outlines overlap, a begins "
    "no lower than b ends (less ε).",
    "A lamp beside its table is not on it, however near it is.",
    "Move the upper object up, or over the lower one.",
    OnTopOf,
    requests=_footprint_requests,
    violations=_not_on_top,
    tolerances=(*CONTACT, "footprint"),
)
R11 = relation_rule(
    "R11",
    "next to",
    "NextTo(a, b, gap): the distance between the surfaces is in the planned range.",
    "Objects that belong together but stand apart, or touch where there should be room, look like a mistake.",
    "Move one of the two until the gap between their surfaces is in the range.",
    NextTo,
    requests=_gap_requests,
    violations=_not_next_to,
    tolerances=("distance", "distance_share"),
)
R12 = relation_rule(
    "R12",
    "direction",
    "LeftOf, RightOf, InFrontOf, Behind, Above, Below: the middle of a lies in a cone of that direction, seen from the "
    "nearest point of b, and the two do not overlap along an axis within the cone. The frame is the world's (front is "
    "−Y), b's own, or the camera's made horizontal, without regard to height. Above and Below are always the world's.",
    "Left and right are what a viewer checks first.",
    "Move a to that side of b, so far that the two do not overlap in this direction.",
    Direction,
    requests=_direction_requests,
    violations=_wrong_side,
    tolerances=("cone", *CONTACT),
)
R13 = relation_rule(
    "R13",
    "orientation",
    "Upright, ParallelTo and Facing hold for the objects' own axes: Z is up, −Y is the front. A long object may be "
    "faced anywhere along its middle line. Of what moves, Upright that is to hold at the end is judged by how its "
    "meshes have turned.",
    "A chair with its back to the table, or a shelf that leans, is not the planned scene.",
    "Turn the object's root Empty.",
    Upright,
    Facing,
    ParallelTo,
    requests=_orientation_requests,
    violations=_misoriented,
    tolerances=("upright", "toppled", "parallel", "facing"),
)
RULES = (R10, R11, R12, R13)
