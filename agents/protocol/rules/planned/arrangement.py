"""R16 and R17: regular arrangements."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from agents.plan.relations import Distributed, SymmetricAbout
from agents.protocol.judging.geometry.patterns import fit_circle, fit_grid, fit_line, mirror_error
from agents.protocol.judging.geometry.poses import pose, pose_request
from agents.protocol.judging.geometry.vectors import angle_between, as_vector
from agents.protocol.judging.planned_relations import Violation, relation_rule
from agents.protocol.measures.geometry import BoxesRequest
from agents.protocol.measures.requests import Unmeasured

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.judging.geometry.patterns import CircleFit
    from agents.protocol.judging.geometry.vectors import Array
    from agents.protocol.measures.requests import Measures, Request
    from agents.protocol.rule import RuleContext

_MAX_GAPS = 12  # in a sentence


def _is_round(relation: Distributed) -> bool:
    return relation.pattern in {"circle", "arc"}


def _is_straight(relation: Distributed | SymmetricAbout) -> bool:
    return isinstance(relation, SymmetricAbout) or not _is_round(relation)


# Members: an object's place is its root's, a part's the middle of its box; both are oriented by their own axes.


def _requests(
    context: RuleContext, relation: Distributed | SymmetricAbout, frame: int | None
) -> Iterator[Request[Any]]:
    for node in relation.nodes:
        if request := pose_request(context, node, frame):
            yield request
        if "/" in node:
            yield BoxesRequest(context.structure.surfaces_of(node), frame)


def _pose(context: RuleContext, measures: Measures, node: str, frame: int | None) -> tuple[Array, Array]:
    """(place, axes) of a member. Raises Unmeasured."""
    if pose_request(context, node, frame) is None:
        raise Unmeasured(f"no object is named {node!r}")
    place, axes = pose(context, measures, node, frame)
    if "/" in node:
        boxes = measures[BoxesRequest(context.structure.surfaces_of(node), frame)].boxes.values()
        low = np.min([box.low for box in boxes], axis=0)
        place = (low + np.max([box.high for box in boxes], axis=0)) / 2
    return place, axes


def _coordinates(place: Array) -> str:
    return f"({', '.join(f'{value:.3f}' for value in place + 0.0)})"


def _list_gaps(gaps: Array, decimals: int, unit: str = "") -> str:
    more = " …" if len(gaps) > _MAX_GAPS else ""
    return ", ".join(f"{gap:.{decimals}f}{unit}" for gap in gaps[:_MAX_GAPS]) + more


def _places(
    context: RuleContext, measures: Measures, relation: Distributed | SymmetricAbout, frame: int | None
) -> Array:
    return np.array([_pose(context, measures, member, frame)[0] for member in relation.members])


# Circles and arcs


def _not_round(
    context: RuleContext, measures: Measures, relation: Distributed, frame: int | None
) -> Iterator[Violation]:
    tolerances, members, pattern = context.tolerances, relation.members, relation.pattern
    places = _places(context, measures, relation, frame)
    about = _centre(context, measures, relation, frame)
    fit = fit_circle(places, about, closed=pattern == "circle", arc=relation.arc)
    radius = relation.radius or float(fit.radii.mean())
    if radius < tolerances.place:
        sentence = f"the members of the {pattern} are all at one point."
        yield Violation(sentence, radius, tolerances.place, "m", as_vector(places[0]))
        return
    deviations = np.abs(fit.radii - radius)
    if (off := float(deviations.max())) > (most := tolerances.radius_share * radius):
        worst = int(deviations.argmax())
        yield Violation(
            f"{members[worst]!r} is {fit.radii[worst]:.3f} m from the centre of the {pattern}; "
            f"its radius is {radius:.3f} m.",
            off,
            most,
            "m",
            as_vector(places[worst]),
            f"Move {members[worst]!r} {off:.3f} m {'towards' if fit.radii[worst] > radius else 'away from'} "
            f"the centre, {_coordinates(fit.centre)}.",
            tuple(member for member, deviation in zip(members, deviations, strict=True) if deviation > most),
        )
    yield from _uneven_gaps(context, relation, fit, places)
    heights = np.abs(fit.heights)
    if (off := float(heights.max())) > (most := tolerances.ring_plane_share * radius):
        worst = int(heights.argmax())
        sentence = f"{members[worst]!r} is {off:.3f} m out of the plane of the {pattern}."
        yield Violation(sentence, off, most, "m", as_vector(places[worst]), objects=(members[worst],))
    yield from _not_facing(context, measures, relation, fit, frame)


def _centre(
    context: RuleContext, measures: Measures, relation: Distributed, frame: int | None
) -> Array | None:
    if isinstance(relation.about, str):
        return _pose(context, measures, relation.about, frame)[0]
    return np.array(relation.about, dtype=float) if relation.about is not None else None


def _uneven_gaps(
    context: RuleContext, relation: Distributed, fit: CircleFit, places: Array
) -> Iterator[Violation]:
    """Gaps between neighbours on a circle or arc that are not as wide as they should be."""
    tolerances, members = context.tolerances, relation.members
    if relation.pattern == "circle":
        even = 360 / len(members)
    else:
        even = relation.arc / len(fit.gaps) if relation.arc else float(fit.gaps.mean())
    most = max(tolerances.ring_angle, tolerances.ring_angle_share * even)
    deviations = np.abs(fit.gaps - even)
    if (off := float(deviations.max())) > most:
        worst = int(deviations.argmax())
        first, second = fit.order[worst], fit.order[(worst + 1) % len(members)]
        yield Violation(
            f"{members[first]!r} and {members[second]!r} are {fit.gaps[worst]:.1f}° apart on the "
            f"{relation.pattern}, not {even:.1f}° (all gaps: {_list_gaps(fit.gaps, 1, '°')}).",
            off,
            most,
            "°",
            as_vector(places[first]),
            f"Compute the places: the centre {_coordinates(fit.centre)}, plus the radius in steps of {even:.1f}°.",
            objects=(members[first], members[second]),
        )


def _not_facing(
    context: RuleContext, measures: Measures, relation: Distributed, fit: CircleFit, frame: int | None
) -> Iterator[Violation]:
    """Members whose front, seen along the circle's axis, does not point as planned."""
    if relation.facing is None:
        return
    sign = 1.0 if relation.facing == "inwards" else -1.0
    most = context.tolerances.ring_facing
    for member in relation.members:
        place, axes = _pose(context, measures, member, frame)
        flat = np.eye(3) - np.outer(fit.normal, fit.normal)
        off = angle_between(flat @ -axes[1], sign * flat @ (fit.centre - place))
        if off > most:
            sentence = f"the front (−Y) of {member!r} points {off:.1f}° away from facing {relation.facing}."
            fix = "Turn the member about the circle's axis."
            yield Violation(sentence, off, most, "°", as_vector(place), fix, (member,))


# Lines, grids, mirrors


def _irregular(
    context: RuleContext, measures: Measures, relation: Distributed | SymmetricAbout, frame: int | None
) -> Iterator[Violation]:
    places = _places(context, measures, relation, frame)
    if isinstance(relation, SymmetricAbout):
        return _not_mirrored(context, relation, places)
    if relation.pattern == "line" or 1 in {relation.rows, relation.columns}:
        return _not_in_line(context, relation, places)
    return _not_in_grid(context, relation, places)


def _not_in_line(context: RuleContext, relation: Distributed, places: Array) -> Iterator[Violation]:
    line, members, share = fit_line(places), relation.members, context.tolerances.line_share
    least = context.tolerances.place
    if line.length < least:
        sentence = "the members of the line are all at one point."
        yield Violation(sentence, line.length, least, "m", as_vector(places[0]))
        return
    if (off := float(line.beside.max())) > (most := share * line.length):
        worst = int(line.beside.argmax())
        sentence = f"{members[worst]!r} is {off:.3f} m beside the line."
        yield Violation(sentence, off, most, "m", as_vector(places[worst]), objects=(members[worst],))
    planned = relation.spacing if isinstance(relation.spacing, float) else None
    even = planned or float(line.gaps.mean())
    deviations = np.abs(line.gaps - even)
    if (off := float(deviations.max())) > (most := share * even):
        worst = int(deviations.argmax())
        first, second = (members[line.order[place]] for place in (worst, worst + 1))
        yield Violation(
            f"{first!r} and {second!r} are {line.gaps[worst]:.3f} m apart along the line, not {even:.3f} m "
            f"(all gaps: {_list_gaps(line.gaps, 3)}).",
            off,
            most,
            "m",
            as_vector(places[line.order[worst]]),
            objects=(first, second),
        )


def _not_in_grid(context: RuleContext, relation: Distributed, places: Array) -> Iterator[Violation]:
    grid, members, share = fit_grid(places), relation.members, context.tolerances.spacing_share
    if grid is None:
        yield Violation("the members of the grid are all on one line.", at=as_vector(places[0]))
        return
    wanted = (relation.rows, relation.columns) if relation.rows and relation.columns else None
    if not grid.full or (wanted and sorted(wanted) != sorted(grid.shape)):
        rows, columns = grid.shape
        planned = f"; the plan says {wanted[0]} × {wanted[1]}" if wanted else ""
        sentence = f"the {len(members)} members lie on a grid of {rows} × {columns} points{planned}."
        yield Violation(sentence, float(len(members)), float(rows * columns))
        return
    if (off := float(grid.off.max())) > (most := share * min(grid.spacing)):
        worst = int(grid.off.argmax())
        sentence = f"{members[worst]!r} is {off:.3f} m from its grid point."
        yield Violation(sentence, off, most, "m", as_vector(places[worst]), objects=(members[worst],))
    if relation.spacing is None:
        return
    steps = relation.spacing if isinstance(relation.spacing, tuple) else (relation.spacing, relation.spacing)
    for measured, step in zip(sorted(grid.spacing), sorted(steps), strict=True):
        if abs(measured - step) > (most := share * step):
            sentence = f"the grid's spacing is {measured:.3f} m, not {step:g} m."
            yield Violation(sentence, measured, most, "m", as_vector(places[0]))


def _not_mirrored(context: RuleContext, relation: SymmetricAbout, places: Array) -> Iterator[Violation]:
    off, worst = mirror_error(
        places, np.array(relation.point, dtype=float), np.array(relation.normal, dtype=float)
    )
    most = context.tolerances.mirror_share * float(np.linalg.norm(np.ptp(places, axis=0)))
    if off > most:
        member = relation.members[worst]
        sentence = f"{member!r} is {off:.3f} m from the mirror image of its partner."
        yield Violation(sentence, off, most, "m", as_vector(places[worst]), objects=(member,))


R16 = relation_rule(
    "R16",
    "circle, arc",
    "The members of a circle or arc are equally far from the centre, evenly spaced and in one plane; if planned, they "
    "face inwards or outwards.",
    "Uneven circles of chairs are the most common way in which a layout fails.",
    "Compute the places: centre + radius · (cos, sin)(k · 360° / n), and turn each member as planned.",
    Distributed,
    requests=_requests,
    violations=_not_round,
    only=_is_round,
    what="circle or arc",
    tolerances=("radius_share", "ring_angle", "ring_angle_share", "ring_plane_share", "ring_facing"),
)
R17 = relation_rule(
    "R17",
    "line, grid, mirror",
    "The members of a line are on it and evenly spaced; those of a grid are on its points, one on each; mirrored "
    "members have partners.",
    "Uneven rows look careless, and dominoes that are unevenly spaced stop falling.",
    "Compute the places from the first one and the spacing; mirror places in the plane.",
    Distributed,
    SymmetricAbout,
    requests=_requests,
    violations=_irregular,
    only=_is_straight,
    what="line, grid or mirror",
    tolerances=("line_share", "spacing_share", "mirror_share"),
)
RULES = (R16, R17)
