"""What the numbers of a plan say against its own relations, phases and camera, before anything is built.

A doubt is no fault: boxes stand for shapes, and roots may be elsewhere than in the middle of the underside. Each is
worth a second look by whoever plans, since what contradicts the numbers cannot pass once it is built.
"""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from typing import TYPE_CHECKING

from agents.plan.boxes import box_of, boxes_of, distance, gaps, pairs
from agents.plan.camera_arithmetic import camera_axes, camera_doubts
from agents.plan.fall_arithmetic import fall_doubts
from agents.plan.faults import MOST_FAULTS, Fault
from agents.plan.part import owner_of
from agents.plan.relations import (
    SIDES,
    Aperture,
    Direction,
    Distributed,
    EmbeddedIn,
    Facing,
    FixedAttachment,
    Inside,
    NextTo,
    OnTopOf,
    StableAgainst,
    SupportedBy,
    Upright,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.boxes import PlannedBox
    from agents.plan.part import Vector
    from agents.plan.relations import Relation
    from agents.plan.scene import ScenePlan

DOUBTED = (
    "This is arithmetic on dimensions, positions (a root is in the middle of the underside) and frames. Mend what is "
    "wrong. Where a shape or a root makes it right all the same, leave it, say so in the object's description, and "
    "give the whole plan again."
)
_GAP, _GAP_SHARE = 0.01, 0.05  # the verifier's tolerances of NextTo
_FOOTPRINT = 0.25
_TILT = 8.0  # degrees; what Upright and a planned rotation may differ by
_TURNED_AWAY = 60.0  # degrees
_DEEP = 0.25  # share of the smaller object's smallest size that two boxes share
_SPACING = 0.03
_REACH = 0.05  # metres by which boxes may overlap in a direction
_REACH_SHARE = 0.1  # the same as a share of the smaller extent
_BESIDE_SHARE = 0.05  # of their extents in the other two directions, that boxes side by side have in common
_EXPLODES = frozenset({"rigid", "soft"})
_FORMLESS = frozenset({"fluid", "emitter", "force"})
_HOLLOW = _FORMLESS | {"container", "ground"}


def doubts_of(plan: ScenePlan) -> list[Fault]:
    """What cannot hold by the plan's own numbers, of much the first; [] if nothing speaks against it."""
    boxes = boxes_of(plan)
    doubts: list[Fault] = []
    for place, relation in enumerate(plan.relations):
        if relation.when != "end":  # positions are those of the first frame
            doubts += (Fault(f"relations[{place}]", why) for why in _against(relation, boxes, plan))
    overlaps = itertools.islice(_overlaps(plan, boxes), MOST_FAULTS)
    return [*doubts, *overlaps, *fall_doubts(plan, boxes), *camera_doubts(plan, boxes)]


def _against(relation: Relation, boxes: dict[str, PlannedBox], plan: ScenePlan) -> Iterator[str]:
    """What speaks against a relation."""
    match relation:
        case SupportedBy():
            yield from _unsupported(relation, boxes)
        case Distributed():
            yield from _uneven(relation, boxes)
        case Upright():
            if box := box_of(boxes, relation.a):
                yield from _tilted(box)
        case (
            StableAgainst()
            | FixedAttachment()
            | Aperture()
            | EmbeddedIn()
            | Inside()
            | OnTopOf()
            | NextTo()
            | Direction()
            | Facing()
        ):
            a, b = (box_of(boxes, node) for node in relation.nodes)
            if a is not None and b is not None and a is not b:
                yield from _against_pair(relation, a, b, plan)
        case _:
            return


def _against_pair(relation: Relation, a: PlannedBox, b: PlannedBox, plan: ScenePlan) -> Iterator[str]:
    match relation:
        case StableAgainst() | FixedAttachment() | Aperture() | EmbeddedIn():
            if (gap := distance(a, b)) > min(a.slack, b.slack):
                yield f"{relation.kind} needs contact, but by their sizes and positions {_apart(a, b, gap)}."
        case Inside():
            yield from _outside(relation, a, b)
        case OnTopOf():
            yield from _not_on_top(a, b)
        case NextTo():
            yield from _wrong_gap(relation, a, b)
        case Direction():
            yield from _wrong_side(relation, a, b, plan)
        case Facing():
            front, away = a.axis(1), [end - start for start, end in zip(a.centre, b.centre, strict=True)]
            length = math.hypot(*away)
            if length > 1e-6 and (
                (off := _angle(sum(-part * step for part, step in zip(front, away, strict=True)) / length))
                > _TURNED_AWAY
            ):
                yield f"{a.name!r} is turned {off:.0f}° away from {b.name!r}; its front is its −Y axis."
        case _:
            return


def _apart(a: PlannedBox, b: PlannedBox, gap: float) -> str:
    return f"{a.name!r} and {b.name!r} are {gap:.3g} m apart"


def _angle(cosine: float) -> float:
    return math.degrees(math.acos(max(-1.0, min(1.0, cosine))))


def _unsupported(relation: SupportedBy, boxes: dict[str, PlannedBox]) -> Iterator[str]:
    """A child must begin between the lowest and highest point of one of its parents, and over it."""
    child = box_of(boxes, relation.child)
    parents = [box_of(boxes, node) for node in relation.parents]
    reasons: list[str] = []
    for parent in parents:
        if child is None or parent is None or parent is child or child.is_ground:
            return  # unknown
        bottom, slack, beside = child.low[2], child.slack, max(gaps(child, parent)[:2])
        if bottom > parent.high[2] + slack:
            over = (
                f"{bottom - parent.high[2]:.3g} m above the top of {parent.name!r} ({parent.high[2]:.3g} m)"
            )
            reasons.append(f"{child.name!r} begins at z = {bottom:.3g} m, {over}")
        elif bottom < parent.low[2] - slack:
            reasons.append(
                f"{child.name!r} begins at z = {bottom:.3g} m, below {parent.name!r} ({parent.low[2]:.3g} m)"
            )
        elif beside > slack:
            reasons.append(f"{child.name!r} is {beside:.3g} m beside {parent.name!r}, seen from above")
        else:
            return
    if reasons:
        yield f"{reasons[0]}."


def _outside(relation: Inside, content: PlannedBox, container: PlannedBox) -> Iterator[str]:
    slack = content.slack
    for axis, word in enumerate(("X", "Y", "Z")):
        middle = content.centre[axis]
        if not container.low[axis] - slack <= middle <= container.high[axis] + slack:
            yield (
                f"the middle of {content.name!r} is at {word} = {middle:.3g} m, outside {container.name!r} "
                f"(from {container.low[axis]:.3g} to {container.high[axis]:.3g} m)."
            )
            return
    if not relation.partial and content.high[2] > container.high[2] + slack:
        yield (
            f"{content.name!r} reaches up to z = {content.high[2]:.3g} m, {container.name!r} only to "
            f"{container.high[2]:.3g} m; lower it, or say that it is partly inside."
        )


def _not_on_top(a: PlannedBox, b: PlannedBox) -> Iterator[str]:
    if a.low[2] < b.low[2] - a.slack and not a.is_ground:
        yield f"{a.name!r} begins at z = {a.low[2]:.3g} m, below {b.name!r} ({b.low[2]:.3g} m)."
    share = 1.0
    for axis in (0, 1):
        common = min(a.high[axis], b.high[axis]) - max(a.low[axis], b.low[axis])
        size = a.high[axis] - a.low[axis]
        share *= max(0.0, min(1.0, common / size)) if size > 0 else 1.0
    if share < _FOOTPRINT:
        yield (
            f"seen from above, only {share:.0%} of {a.name!r} is over {b.name!r}; OnTopOf needs at least "
            f"{_FOOTPRINT:.0%} of the upper object's footprint."
        )


def _wrong_gap(relation: NextTo, a: PlannedBox, b: PlannedBox) -> Iterator[str]:
    slack, gap = min(a.slack, b.slack), distance(a, b)
    least, most = relation.gap
    if gap > most + max(_GAP, _GAP_SHARE * most) + slack:
        yield f"by their sizes and positions {_apart(a, b, gap)}; the gap is to be at most {most:g} m."
        return
    along = [axis for axis, value in enumerate(gaps(a, b)) if value > 0]
    faces = len(along) == 1 and all(_common_share(a, b, axis) > 0.5 for axis in range(3) if axis != along[0])
    size = min(*a.planned.dimensions, *b.planned.dimensions)
    if faces and gap + 0.1 * size < least - max(_GAP, _GAP_SHARE * least) - slack:
        yield f"by their sizes and positions {_apart(a, b, gap)}; the gap is to be at least {least:g} m."


def _common_share(a: PlannedBox, b: PlannedBox, axis: int) -> float:
    """The share of the smaller box's extent along an axis that both have."""
    common = min(a.high[axis], b.high[axis]) - max(a.low[axis], b.low[axis])
    return common / max(1e-9, min(a.high[axis] - a.low[axis], b.high[axis] - b.low[axis]))


def _wrong_side(relation: Direction, a: PlannedBox, b: PlannedBox, plan: ScenePlan) -> Iterator[str]:
    number, sign = SIDES[relation.kind]
    axis: Vector | None = (float(number == 0), float(number == 1), float(number == 2))
    if number != 2 and relation.frame == "reference":
        axis = b.axis(number)
    elif number != 2 and relation.frame == "camera":
        axes = camera_axes(plan)
        axis = axes[number] if axes else None
    if axis is None:
        return
    along = sign * sum(
        part * (end - start) for part, start, end in zip(axis, b.centre, a.centre, strict=True)
    )
    if along < -a.slack:
        yield (
            f"by their positions the middle of {a.name!r} is {-along:.3g} m on the other side of {b.name!r} "
            f"(frame: {relation.frame})."
        )
        return
    if not {a.planned.role, b.planned.role}.isdisjoint(_FORMLESS):
        return
    main = max(range(3), key=lambda place: abs(axis[place]))
    if any(_common_share(a, b, other) < _BESIDE_SHARE for other in range(3) if other != main):
        return  # they are not side by side: a direction that leans a little may part them
    low, high = _extent(a, axis, sign)
    other_low, other_high = _extent(b, axis, sign)
    overlap = other_high - low
    if overlap > max(_REACH, _REACH_SHARE * min(high - low, other_high - other_low)):
        yield (
            f"by their positions and sizes {a.name!r} begins {overlap:.3g} m before {b.name!r} ends in the direction "
            f"{relation.kind} (frame: {relation.frame}); they are to stand clear of each other."
        )


def _extent(box: PlannedBox, axis: Vector, sign: float) -> tuple[float, float]:
    """Where a box begins and ends along ±``axis``, metres from the origin."""
    along = [sign * sum(part * at for part, at in zip(axis, corner, strict=True)) for corner in box.corners]
    return min(along), max(along)


def _tilted(box: PlannedBox) -> Iterator[str]:
    if (tilt := _angle(box.axis(2)[2])) > _TILT:
        yield f"{box.name!r} is to be upright, but its planned rotation tilts it by {tilt:.0f}°."


def _uneven(relation: Distributed, boxes: dict[str, PlannedBox]) -> Iterator[str]:
    """Members of a circle or arc are at the radius, members of a line at the spacing that is planned."""
    members = [box_of(boxes, node) for node in relation.members]
    known = [box for box in members if box is not None]
    if len(known) < len(members) or len({box.name for box in known}) < len(known):
        return
    if relation.pattern in {"circle", "arc"} and relation.radius is not None and relation.about is not None:
        at = relation.about
        if isinstance(at, str):
            centre = box_of(boxes, at)
            if centre is None:
                return
            at = centre.planned.position
        for box in known:
            radius = math.hypot(*(mine - other for mine, other in zip(box.planned.position, at, strict=True)))
            level = math.hypot(*(box.planned.position[axis] - at[axis] for axis in (0, 1)))
            most = max(box.slack, _SPACING * relation.radius)
            if min(abs(radius - relation.radius), abs(level - relation.radius)) > most:
                yield f"{box.name!r} is {level:.3g} m from the centre; the radius is to be {relation.radius:g} m."
                return
    if relation.pattern == "line" and isinstance(relation.spacing, float):
        for box, other in itertools.pairwise(known):
            step = math.dist(box.planned.position, other.planned.position)
            if abs(step - relation.spacing) > max(min(box.slack, other.slack), _SPACING * relation.spacing):
                yield (
                    f"{box.name!r} and {other.name!r} are {step:.3g} m apart; the spacing is to be "
                    f"{relation.spacing:g} m."
                )
                return


def _overlaps(plan: ScenePlan, boxes: dict[str, PlannedBox]) -> Iterator[Fault]:
    """Simulated bodies that share much of their boxes with something that no relation joins them with."""
    relations: defaultdict[str, set[int]] = defaultdict(set)
    for place, relation in enumerate(plan.relations):
        if not isinstance(relation, (Distributed, Direction)):
            for node in relation.nodes:
                relations[owner_of(node)].add(place)
    places = {planned.name: place for place, planned in enumerate(plan.objects)}
    for a, b in pairs(boxes):
        roles = {a.planned.role, b.planned.role}
        if not roles & _EXPLODES or roles & _HOLLOW or (depth := -max(gaps(a, b))) <= 0:
            continue
        if not relations[a.name].isdisjoint(relations[b.name]):
            continue
        if not (a.is_square and b.is_square):
            continue  # the world's box around a turned object is larger than it
        least = min(*a.planned.dimensions, *b.planned.dimensions)
        holds = any(
            all(
                low <= other and other_high <= high
                for low, high, other, other_high in zip(one.low, one.high, two.low, two.high, strict=True)
            )
            for one, two in ((a, b), (b, a))
        )
        if depth > max(_DEEP * least, min(a.slack, b.slack)) and not holds:
            yield Fault(
                f"objects[{places[a.name]}]",
                f"{a.name!r} and {b.name!r} overlap by {depth:.3g} m at the first frame; a solver throws them apart.",
            )
