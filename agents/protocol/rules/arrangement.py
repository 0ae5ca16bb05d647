"""R16 and R17: regular arrangements."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from agents.plan.relations import Distributed, SymmetricAbout
from agents.protocol.judging.patterns import fit_grid, fit_ring, fit_row, mirrored
from agents.protocol.judging.relation_judge import Miss, asked, judged
from agents.protocol.judging.sample_frames import anchor, angle, placed
from agents.protocol.measures.measure import Boxes, Measures, Poses, Request, Unmeasured
from agents.protocol.rule import Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from agents.protocol.facts import Vector
    from agents.protocol.findings import Finding
    from agents.protocol.judging.patterns import Ring
    from agents.protocol.judging.sample_frames import Array

_SHOWN = 12  # gaps in a sentence


def _is_round(relation: Distributed) -> bool:
    return relation.pattern in {"circle", "arc"}


def _is_straight(relation: Distributed | SymmetricAbout) -> bool:
    return isinstance(relation, SymmetricAbout) or not _is_round(relation)


# Where members are: an object at its root, a part in the middle of its box; both are turned as their own axes are.


def _requests(subject: Subject, node: str, frame: int | None) -> Iterator[Request[Any]]:
    name = anchor(subject, node)
    if name is not None:
        yield Poses((name,), frame)
    if "/" in node:
        yield Boxes(subject.structure.find(node), frame)


def _ask(
    subject: Subject, relation: Distributed | SymmetricAbout, frame: int | None
) -> Iterator[Request[Any]]:
    for node in relation.nodes:
        yield from _requests(subject, node, frame)


def _place(subject: Subject, measures: Measures, node: str, frame: int | None) -> tuple[Array, Array]:
    """(place, axes) of a member. Raises Unmeasured."""
    found = [measures[request] for request in _requests(subject, node, frame)]
    if not found:
        raise Unmeasured(f"there is nothing called {node!r}")
    place, axes = placed(next(iter(found[0].matrices.values())))
    for boxes in found[1:]:
        low = np.min([box.low for box in boxes.boxes.values()], axis=0)
        place = (low + np.max([box.high for box in boxes.boxes.values()], axis=0)) / 2
    return place, axes


def _told(place: Array) -> str:
    return f"({', '.join(f'{value:.3f}' for value in place + 0.0)})"


def _places(subject: Subject, measures: Measures, nodes: Iterable[str], frame: int | None) -> Array:
    return np.array([_place(subject, measures, node, frame)[0] for node in nodes])


def _at(place: Array) -> Vector:
    return (float(place[0]), float(place[1]), float(place[2]))


# Circles and arcs


def _ask_rings(subject: Subject) -> Iterator[Request[Any]]:
    yield from asked(subject, Distributed, ask=_ask, only=_is_round, what="circle or arc")


def _judge_rings(subject: Subject, measures: Measures) -> Iterator[Finding]:
    return judged(R16, subject, measures, Distributed, misses=_not_round, only=_is_round)


def _not_round(
    subject: Subject, measures: Measures, relation: Distributed, frame: int | None
) -> Iterator[Miss]:
    tolerances, members = subject.tolerances, relation.members
    places = _places(subject, measures, members, frame)
    about = _centre(subject, measures, relation, frame)
    ring = fit_ring(places, about, closed=relation.pattern == "circle", arc=relation.arc)
    radius = relation.radius or float(ring.radii.mean())
    if radius < tolerances.place:
        yield Miss(
            f"the members of the {relation.pattern} stand on one spot.",
            radius,
            tolerances.place,
            "m",
            _at(places[0]),
        )
        return
    away = np.abs(ring.radii - radius)
    if (off := float(away.max())) > (most := tolerances.radius_share * radius):
        worst = int(away.argmax())
        yield Miss(
            f"{members[worst]!r} is {ring.radii[worst]:.3f} m from the centre of the {relation.pattern}; "
            f"its radius is {radius:.3f} m.",
            off,
            most,
            "m",
            _at(places[worst]),
            f"Move {members[worst]!r} {off:.3f} m {'towards' if ring.radii[worst] > radius else 'away from'} "
            f"the centre, {_told(ring.centre)}.",
            tuple(member for member, one in zip(members, away, strict=True) if one > most),
        )
    yield from _uneven(subject, relation, ring, places)
    height = np.abs(ring.heights)
    if (off := float(height.max())) > (most := tolerances.ring_plane_share * radius):
        worst = int(height.argmax())
        yield Miss(
            f"{members[worst]!r} is {off:.3f} m out of the plane of the {relation.pattern}.",
            off,
            most,
            "m",
            _at(places[worst]),
            objects=(members[worst],),
        )
    yield from _not_facing(subject, measures, relation, ring, frame)


def _centre(subject: Subject, measures: Measures, relation: Distributed, frame: int | None) -> Array | None:
    if isinstance(relation.about, str):
        return _place(subject, measures, relation.about, frame)[0]
    return np.array(relation.about, dtype=float) if relation.about is not None else None


def _uneven(subject: Subject, relation: Distributed, ring: Ring, places: Array) -> Iterator[Miss]:
    """Gaps between neighbours that are not as wide as they should be."""
    tolerances, members = subject.tolerances, relation.members
    if relation.pattern == "circle":
        even = 360 / len(members)
    else:
        even = relation.arc / len(ring.gaps) if relation.arc else float(ring.gaps.mean())
    most = max(tolerances.ring_angle, tolerances.ring_angle_share * even)
    away = np.abs(ring.gaps - even)
    if (off := float(away.max())) > most:
        worst = int(away.argmax())
        one, other = ring.order[worst], ring.order[(worst + 1) % len(members)]
        shown = ", ".join(f"{gap:.1f}°" for gap in ring.gaps[:_SHOWN]) + (
            " …" if len(ring.gaps) > _SHOWN else ""
        )
        yield Miss(
            f"from {members[one]!r} to {members[other]!r} it is {ring.gaps[worst]:.1f}° around the "
            f"{relation.pattern}, not {even:.1f}° (all: {shown}).",
            off,
            most,
            "°",
            _at(places[one]),
            f"Compute the places: the centre {_told(ring.centre)}, plus the radius in steps of {even:.1f}°.",
            objects=(members[one], members[other]),
        )


def _not_facing(
    subject: Subject, measures: Measures, relation: Distributed, ring: Ring, frame: int | None
) -> Iterator[Miss]:
    """Members whose front, seen along the ring's axis, is not turned as planned."""
    if relation.facing is None:
        return
    way = 1.0 if relation.facing == "inwards" else -1.0
    for member in relation.members:
        at, axes = _place(subject, measures, member, frame)
        flat = np.eye(3) - np.outer(ring.normal, ring.normal)
        off = angle(flat @ -axes[1], way * flat @ (ring.centre - at))
        if off > subject.tolerances.ring_facing:
            yield Miss(
                f"the front (−Y) of {member!r} is turned {off:.1f}° away from facing {relation.facing}.",
                off,
                subject.tolerances.ring_facing,
                "°",
                _at(at),
                "Turn the member about the circle's axis.",
                objects=(member,),
            )


# Lines, grids, mirrors


def _ask_rows(subject: Subject) -> Iterator[Request[Any]]:
    yield from asked(
        subject, Distributed, SymmetricAbout, ask=_ask, only=_is_straight, what="line, grid or mirror"
    )


def _judge_rows(subject: Subject, measures: Measures) -> Iterator[Finding]:
    return judged(R17, subject, measures, Distributed, SymmetricAbout, misses=_irregular, only=_is_straight)


def _irregular(
    subject: Subject, measures: Measures, relation: Distributed | SymmetricAbout, frame: int | None
) -> Iterator[Miss]:
    places = _places(subject, measures, relation.members, frame)
    if isinstance(relation, SymmetricAbout):
        return _not_mirrored(subject, relation, places)
    if relation.pattern == "line" or 1 in {relation.rows, relation.columns}:
        return _not_in_line(subject, relation, places)
    return _not_in_grid(subject, relation, places)


def _not_in_line(subject: Subject, relation: Distributed, places: Array) -> Iterator[Miss]:
    row, members, share = fit_row(places), relation.members, subject.tolerances.line_share
    if row.length < subject.tolerances.place:
        yield Miss(
            "the members of the line stand on one spot.",
            row.length,
            subject.tolerances.place,
            "m",
            _at(places[0]),
        )
        return
    if (off := float(row.beside.max())) > (most := share * row.length):
        worst = int(row.beside.argmax())
        sentence = f"{members[worst]!r} stands {off:.3f} m beside the line."
        yield Miss(sentence, off, most, "m", _at(places[worst]), objects=(members[worst],))
    planned = relation.spacing if isinstance(relation.spacing, float) else None
    even = planned or float(row.gaps.mean())
    away = np.abs(row.gaps - even)
    if (off := float(away.max())) > (most := share * even):
        worst = int(away.argmax())
        one, other = (members[row.order[place]] for place in (worst, worst + 1))
        shown = ", ".join(f"{gap:.3f}" for gap in row.gaps[:_SHOWN]) + (
            " …" if len(row.gaps) > _SHOWN else ""
        )
        yield Miss(
            f"from {one!r} to {other!r} it is {row.gaps[worst]:.3f} m along the line, not {even:.3f} m (all: {shown}).",
            off,
            most,
            "m",
            _at(places[row.order[worst]]),
            objects=(one, other),
        )


def _not_in_grid(subject: Subject, relation: Distributed, places: Array) -> Iterator[Miss]:
    grid, members, share = fit_grid(places), relation.members, subject.tolerances.spacing_share
    if grid is None:
        yield Miss("the members of the grid stand on one line.", at=_at(places[0]))
        return
    wanted = (relation.rows, relation.columns) if relation.rows and relation.columns else None
    if not grid.full or (wanted and sorted(wanted) != sorted(grid.shape)):
        planned = f"; planned are {wanted[0]} × {wanted[1]}" if wanted else ""
        crossings = grid.shape[0] * grid.shape[1]
        yield Miss(
            f"the {len(members)} members lie on a grid of {grid.shape[0]} × {grid.shape[1]} places{planned}.",
            float(len(members)),
            float(crossings),
        )
        return
    if (off := float(grid.off.max())) > (most := share * min(grid.spacing)):
        worst = int(grid.off.argmax())
        sentence = f"{members[worst]!r} stands {off:.3f} m from where the others leave its place in the grid."
        yield Miss(sentence, off, most, "m", _at(places[worst]), objects=(members[worst],))
    if relation.spacing is None:
        return
    steps = relation.spacing if isinstance(relation.spacing, tuple) else (relation.spacing, relation.spacing)
    for found, step in zip(sorted(grid.spacing), sorted(steps), strict=True):
        if abs(found - step) > (most := share * step):
            yield Miss(
                f"the grid's spacing is {found:.3f} m, not {step:g} m.", found, most, "m", _at(places[0])
            )


def _not_mirrored(subject: Subject, relation: SymmetricAbout, places: Array) -> Iterator[Miss]:
    off, worst = mirrored(
        places, np.array(relation.point, dtype=float), np.array(relation.normal, dtype=float)
    )
    most = subject.tolerances.mirror_share * float(np.linalg.norm(np.ptp(places, axis=0)))
    if off > most:
        member = relation.members[worst]
        sentence = f"in the mirror, {member!r} is {off:.3f} m from any partner that is left to it."
        yield Miss(sentence, off, most, "m", _at(places[worst]), objects=(member,))


R16 = Rule(
    "R16",
    "circle, arc",
    "hard",
    "Members of a circle or arc are equally far from the centre, evenly spread and in one plane; if so planned, they "
    "face inwards or outwards.",
    "A ring of chairs that is no ring is the commonest way in which a layout fails.",
    "Compute the places: centre + radius · (cos, sin)(k · 360° / n), and turn each member as planned.",
    _judge_rings,
    _ask_rings,
    needs_plan=True,
    tolerances=("radius_share", "ring_angle", "ring_angle_share", "ring_plane_share", "ring_facing"),
)
R17 = Rule(
    "R17",
    "line, grid, mirror",
    "hard",
    "Members of a line are on it, evenly spaced; of a grid, on its crossings, one on each; mirrored members have "
    "partners.",
    "Uneven rows look careless, and dominoes that are unevenly spaced stop falling.",
    "Compute the places from the first one and the spacing; mirror places in the plane.",
    _judge_rows,
    _ask_rows,
    needs_plan=True,
    tolerances=("line_share", "spacing_share", "mirror_share"),
)
RULES = (R16, R17)
