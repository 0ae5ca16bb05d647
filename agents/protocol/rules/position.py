"""R10 to R13: where objects are to each other, and how they are turned."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agents.plan.relations import Direction, Facing, NextTo, OnTopOf, ParallelTo, Upright
from agents.protocol.judging.contact_pairs import smallest_diagonal
from agents.protocol.judging.relation_judge import Miss, asked, judged, surfaces
from agents.protocol.judging.sample_frames import anchor, angle, pose, poses
from agents.protocol.measures.measure import Extents, Gap, Unmeasured
from agents.protocol.measures.position import Beside, Over
from agents.protocol.rule import Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from agents.protocol.facts import Vector
    from agents.protocol.findings import Finding
    from agents.protocol.judging.sample_frames import Array
    from agents.protocol.measures.measure import Measures, Names, Request

# Direction → (which axis of the frame, which way). Front is −Y, as in Blender's front view.
_SIDES = {
    "LeftOf": (0, -1.0),
    "RightOf": (0, 1.0),
    "InFrontOf": (1, -1.0),
    "Behind": (1, 1.0),
    "Above": (2, 1.0),
    "Below": (2, -1.0),
}
_UP = np.array([0.0, 0.0, 1.0])
_ASTRIDE = 1e-3  # metres in plan view below which there is no direction from one place to another


def _sides(subject: Subject, a: str, b: str) -> tuple[Names, Names]:
    """The surfaces of two nodes; of an object and a part of it, those that are left."""
    ours = surfaces(subject, a)
    return ours, surfaces(subject, b, but=ours)


# On top of


def _over(subject: Subject, relation: OnTopOf, frame: int | None) -> Over:
    return Over(*_sides(subject, relation.a, relation.b), frame)


def _ask_over(subject: Subject) -> Iterator[Request[Any]]:
    def ask(subject: Subject, relation: OnTopOf, frame: int | None) -> Iterator[Request[Any]]:
        yield _over(subject, relation, frame)

    yield from asked(subject, OnTopOf, ask=ask)


def _not_on_top(subject: Subject, measures: Measures, relation: OnTopOf, frame: int | None) -> Iterator[Miss]:
    request = _over(subject, relation, frame)
    found, least = measures[request], subject.tolerances.footprint
    if found.share < least:
        yield Miss(
            f"only {found.share:.0%} of {relation.a!r} is over {relation.b!r}, seen from above.",
            found.share,
            least,
            at=found.at,
            fix="Move the upper object over the lower one.",
        )
    most = subject.tolerances.contact_gap(smallest_diagonal(subject, request.a, request.b))
    if found.sunk is not None and found.sunk > most:
        yield Miss(
            f"{relation.a!r} begins {found.sunk * 1000:.1f} mm below the top of {relation.b!r}.",
            found.sunk,
            most,
            "m",
            found.at,
            "Move the upper object up by that.",
        )


def _judge_over(subject: Subject, measures: Measures) -> Iterator[Finding]:
    return judged(R10, subject, measures, OnTopOf, misses=_not_on_top)


# Next to


def _gap(subject: Subject, relation: NextTo, frame: int | None) -> Gap:
    return Gap(*_sides(subject, relation.a, relation.b), frame)


def _ask_gap(subject: Subject) -> Iterator[Request[Any]]:
    def ask(subject: Subject, relation: NextTo, frame: int | None) -> Iterator[Request[Any]]:
        yield _gap(subject, relation, frame)

    yield from asked(subject, NextTo, ask=ask)


def _not_next(subject: Subject, measures: Measures, relation: NextTo, frame: int | None) -> Iterator[Miss]:
    found = measures[_gap(subject, relation, frame)]
    tolerances = subject.tolerances
    least, most = (
        bound + way * max(tolerances.distance, tolerances.distance_share * bound)
        for bound, way in zip(relation.gap, (-1, 1), strict=True)
    )
    if not least <= found.distance <= most:
        near = found.distance < least
        change = relation.gap[0] - found.distance if near else found.distance - relation.gap[1]
        where = f"{relation.a!r} {change:.3f} m {'away from' if near else 'towards'} {relation.b!r}"
        yield Miss(
            f"{relation.a!r} and {relation.b!r} are {found.distance:.3f} m apart; "
            f"planned are {relation.gap[0]:g} to {relation.gap[1]:g} m.",
            found.distance,
            least if near else most,
            "m",
            found.here,
            f"Move {where}.",
        )


def _judge_gap(subject: Subject, measures: Measures) -> Iterator[Finding]:
    return judged(R11, subject, measures, NextTo, misses=_not_next)


# Directions


def _beside(subject: Subject, relation: Direction, frame: int | None) -> Beside:
    """Raises Unmeasured."""
    axis, way = _SIDES[relation.kind]
    of: str | None = None
    if axis != 2 and relation.frame == "reference":
        of = anchor(subject, relation.b)
    elif axis != 2 and relation.frame == "camera":
        of = subject.facts.camera
        if of is None:
            raise Unmeasured("the scene has no camera whose left and right could be meant")
        if frame is None and subject.structure.moves(of):
            frame = subject.facts.frame_start
    turned = tuple(name for node in relation.nodes if (name := anchor(subject, node)) is not None)
    a, b = _sides(subject, relation.a, relation.b)
    return Beside(a, b, axis, way, turned, subject.tolerances.cone, of, relation.frame == "camera", frame)


def _ask_beside(subject: Subject) -> Iterator[Request[Any]]:
    def ask(subject: Subject, relation: Direction, frame: int | None) -> Iterator[Request[Any]]:
        if relation.frame != "camera" or subject.facts.camera:
            yield _beside(subject, relation, frame)

    yield from asked(subject, Direction, ask=ask)


def _not_there(
    subject: Subject, measures: Measures, relation: Direction, frame: int | None
) -> Iterator[Miss]:
    request = _beside(subject, relation, frame)
    found = measures[request]
    most = subject.tolerances.contact_gap(smallest_diagonal(subject, request.a, request.b))
    a, b, cone = relation.a, relation.b, subject.tolerances.cone
    seen = {"world": "", "reference": f" as {b!r} is turned", "camera": " seen from the camera"}[
        relation.frame
    ]
    if found.angle > cone:
        sentence = f"{a!r} lies {found.angle:.0f}° away from the direction {relation.kind} {b!r}{seen}."
        fix = f"Move {a!r} to that side of {b!r} ({relation.kind}{seen})."
        yield Miss(sentence, found.angle, cone, "°", found.at, fix)
    elif found.gap < -most:
        yield Miss(
            f"{a!r} is not clear of {b!r}: they overlap by {-found.gap * 1000:.1f} mm ({relation.kind}{seen}).",
            -found.gap,
            most,
            "m",
            found.at,
        )


def _judge_beside(subject: Subject, measures: Measures) -> Iterator[Finding]:
    return judged(R12, subject, measures, Direction, misses=_not_there)


# Orientation


def _turning(
    subject: Subject, relation: Upright | Facing | ParallelTo, frame: int | None
) -> Iterator[Request[Any]]:
    for node in relation.nodes:
        if request := poses(subject, (node,), frame):
            yield request
    if isinstance(relation, Facing):
        yield _reach(subject, relation, frame)


def _reach(subject: Subject, relation: Facing, frame: int | None) -> Extents:
    return Extents(surfaces(subject, relation.b), frame=frame, of=anchor(subject, relation.b))


def _ask_turning(subject: Subject) -> Iterator[Request[Any]]:
    yield from asked(subject, Upright, Facing, ParallelTo, ask=_turning)


def _not_turned(
    subject: Subject, measures: Measures, relation: Upright | Facing | ParallelTo, frame: int | None
) -> Iterator[Miss]:
    tolerances = subject.tolerances
    place, axes = pose(subject, measures, relation.a, frame)
    fix = ""
    if isinstance(relation, Upright):
        off, most = angle(axes[2], _UP), tolerances.upright
        sentence = f"{relation.a!r} leans by {off:.1f}°."
    elif isinstance(relation, Facing):
        towards = _faced(subject, measures, relation, frame, place) - place
        if float(np.linalg.norm(towards[:2])) < _ASTRIDE:
            raise Unmeasured(f"{relation.a!r} is right above, below or inside {relation.b!r}")
        off, most = angle(-axes[1][:2], towards[:2]), tolerances.facing
        sentence = f"the front (−Y) of {relation.a!r} is turned {off:.1f}° away from {relation.b!r}."
        front = -axes[1]
        turn = math.degrees(
            math.atan2(front[0] * towards[1] - front[1] * towards[0], float(front[:2] @ towards[:2]))
        )
        fix = f"Turn the root of {relation.a!r} by {turn:+.1f}° about Z.".replace("-", "−")
    else:
        other = pose(subject, measures, relation.b, frame)[1]
        # A box turned by a right angle is as parallel as before: each axis has one that it runs along.
        off = max(min(min(angle(one, two), angle(one, -two)) for two in other) for one in axes)
        most = tolerances.parallel
        sentence = f"the axes of {relation.a!r} and {relation.b!r} differ by {off:.1f}°."
    if off > most:
        at: Vector = (float(place[0]), float(place[1]), float(place[2]))
        yield Miss(sentence, off, most, "°", at, fix)


def _faced(subject: Subject, measures: Measures, relation: Facing, frame: int | None, place: Array) -> Array:
    """Where on the middle line of ``b`` something at ``place`` looks: chairs along a table face it side by side."""
    axes = pose(subject, measures, relation.b, frame)[1]
    found = measures[_reach(subject, relation, frame)]
    low, high = np.array(found.low), np.array(found.high)
    middle, size = (low + high) / 2, high - low
    longer = int(size[1] > size[0])
    half = float(size[longer] - size[1 - longer]) / 2
    along = float(np.clip((axes @ place)[longer] - middle[longer], -half, half))
    return (middle + along * np.eye(3)[longer]) @ axes


def _judge_turning(subject: Subject, measures: Measures) -> Iterator[Finding]:
    return judged(R13, subject, measures, Upright, Facing, ParallelTo, misses=_not_turned)


R10 = Rule(
    "R10",
    "on top of",
    "hard",
    "OnTopOf(a, b): seen from above, at least a quarter of a's outline is over b; and where the two share a place, a "
    "begins no lower than b ends (less ε).",
    "A lamp beside its table is not on it, however near it is.",
    "Move the upper object up, or over the lower one.",
    _judge_over,
    _ask_over,
    needs_plan=True,
    tolerances=("contact", "contact_share", "contact_most", "footprint"),
)
R11 = Rule(
    "R11",
    "next to",
    "hard",
    "NextTo(a, b, gap): the distance of the surfaces is in the planned range.",
    "Things that belong together and stand apart, or touch where there should be room, read as a mistake.",
    "Move one of the two until the gap between their surfaces is in the range.",
    _judge_gap,
    _ask_gap,
    needs_plan=True,
    tolerances=("distance", "distance_share"),
)
R12 = Rule(
    "R12",
    "direction",
    "hard",
    "LeftOf, RightOf, InFrontOf, Behind, Above, Below: the middle of a lies in a cone of that direction, seen from the "
    "nearest place of b, and along an axis within the cone the two do not overlap. In the declared frame: the world's "
    "(front is −Y), b's own, or the camera's, brought level; heights are of no account. Above and Below are always the "
    "world's.",
    "Left and right are what a viewer checks first.",
    "Move a to that side of b, so far that the two do not overlap in this direction.",
    _judge_beside,
    _ask_beside,
    needs_plan=True,
    tolerances=("cone", "contact", "contact_share", "contact_most"),
)
R13 = Rule(
    "R13",
    "orientation",
    "hard",
    "Upright, ParallelTo and Facing hold for the objects' own axes: Z is up, −Y is the front. What is long is faced "
    "anywhere along its middle line.",
    "A chair with its back to the table, or a shelf that leans, is the wrong scene.",
    "Turn the object's root Empty.",
    _judge_turning,
    _ask_turning,
    needs_plan=True,
    tolerances=("upright", "parallel", "facing"),
)
RULES = (R10, R11, R12, R13)
