"""R7 and R8: what is fastened to something, and what fills an opening of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agents.plan.relations import Aperture, FixedAttachment
from agents.protocol.judging.contact_pairs import smallest_diagonal
from agents.protocol.judging.move_advice import across, told_move
from agents.protocol.judging.relation_judge import Miss, asked, judged, smallest, surfaces
from agents.protocol.judging.sample_frames import anchor, moments, moves, placed
from agents.protocol.measures.contact import Depth, Opening
from agents.protocol.measures.measure import Gap, Measures, Poses, Request, Unmeasured
from agents.protocol.rule import Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from agents.protocol.facts import Box, ObjectFacts
    from agents.protocol.findings import Finding
    from agents.protocol.judging.sample_frames import Array

# What carries an object, or a mesh, along with its target.
_CARRYING = frozenset({"CHILD_OF", "COPY_LOCATION", "COPY_TRANSFORMS", "ARMATURE", "PIVOT", "FOLLOW_PATH"})
_BINDING = frozenset({"ARMATURE", "SURFACE_DEFORM", "MESH_DEFORM", "LATTICE", "HOOK"})
_DEFORMING = _BINDING | {"CLOTH", "SOFT_BODY", "MESH_CACHE"}


# R7: fastening


def _names(subject: Subject, relation: FixedAttachment) -> tuple[tuple[str, ...], tuple[str, ...]]:
    part = surfaces(subject, relation.part)
    return part, surfaces(subject, relation.host, but=part)


def _bends(subject: Subject, *names: str) -> bool:
    """Whether meshes are deformed: then they may touch all the time, while their origins part."""
    return any(
        one.animated_shape_keys
        or any(modifier.on and modifier.type in _DEFORMING for modifier in one.modifiers)
        for one in (subject.structure.objects[name] for name in names)
    )


def _anchors(subject: Subject, relation: FixedAttachment) -> tuple[str, str] | None:
    part, host = anchor(subject, relation.part), anchor(subject, relation.host)
    return (part, host) if part and host else None


def _travel(subject: Subject, relation: FixedAttachment) -> list[Poses]:
    """Where the two are at the timeline's ends, and now; nothing where neither moves, or they bend."""
    names = (*_names(subject, relation)[0], *_names(subject, relation)[1])
    anchors = _anchors(subject, relation)
    still = not any(moves(subject, node) for node in relation.nodes)
    if anchors is None or still or _bends(subject, *names):
        return []
    facts = subject.facts
    return [Poses(anchors, frame) for frame in (None, facts.frame_start, facts.frame_end)]


def _ask_attachment(subject: Subject) -> Iterator[Request[Any]]:
    def gap(subject: Subject, relation: FixedAttachment, frame: int | None) -> Iterator[Request[Any]]:
        yield Gap(*_names(subject, relation), frame)
        yield from _travel(subject, relation)

    yield from asked(subject, FixedAttachment, ask=gap)


def _fastened(
    subject: Subject, measures: Measures, relation: FixedAttachment, frame: int | None
) -> Iterator[Miss]:
    part, host = _names(subject, relation)
    most = subject.tolerances.contact_gap(smallest_diagonal(subject, part, host))
    # What bends has no place of its own that could be compared: it must touch all the time.
    frames = moments(subject, *relation.nodes) if _bends(subject, *part, *host) else (frame,)
    found = max((measures[Gap(part, host, one)] for one in frames), key=lambda gap: gap.distance)
    if found.distance > most:
        yield Miss(
            f"{relation.part!r} is {found.distance * 1000:.1f} mm away from {relation.host!r}.",
            found.distance,
            most,
            "m",
            found.here,
            f"{told_move(relation.part, across(found))}, so that it touches {relation.host!r}.",
        )
    if not _is_linked(subject, relation):
        yield Miss(
            f"nothing makes {relation.part!r} move with {relation.host!r}: neither a parent nor a constraint "
            f"leads from the one to the other.",
            at=found.here,
        )
        return
    travel = _travel(subject, relation)
    if travel and (shift := _shift(subject, measures, part, travel)) > most:
        yield Miss(
            f"{relation.part!r} moves {shift * 1000:.1f} mm against {relation.host!r} between frames "
            f"{subject.facts.frame_start} and {subject.facts.frame_end}.",
            shift,
            most,
            "m",
            found.here,
            "Take away what moves it by itself (keys, physics, other constraints), or the link's influence.",
        )


def _is_linked(subject: Subject, relation: FixedAttachment) -> bool:
    """Whether all of the part follows the host, or both follow the same."""
    carriers: set[str] = set()
    for node in (*_starts(subject, relation.host), *surfaces(subject, relation.host)):
        carriers |= _followed(subject, node)
    thing = subject.structure.thing_of(relation.host)
    if thing is not None and "/" not in relation.host:
        carriers.update(one.name for one in (*thing.meshes, *thing.roots, *thing.others))
    return all(_followed(subject, name) & carriers for name in _starts(subject, relation.part))


def _starts(subject: Subject, node: str) -> tuple[str, ...]:
    """What must follow for all of a node to follow: its root, if its meshes follow that; else every mesh."""
    names = surfaces(subject, node)
    root = anchor(subject, node)
    if root is not None and all(root in _followed(subject, name) for name in names):
        # A mesh that is linked by itself needs no root that is.
        return (root,) if len(names) != 1 else names
    return names


def _followed(subject: Subject, name: str) -> set[str]:
    """An object, and all that it follows: parents, and targets of constraints, over any number of steps."""
    found: set[str] = set()
    waiting = [name]
    while waiting:
        one = subject.structure.objects.get(waiting.pop())
        if one is None or one.name in found:
            continue
        found.add(one.name)
        waiting += _leads_to(one)
    return found


def _leads_to(one: ObjectFacts) -> Iterator[str]:
    if one.parent:
        yield one.parent
    for constraint in one.constraints:
        if constraint.on and constraint.target and constraint.type in _CARRYING:
            yield constraint.target
    for modifier in one.modifiers:
        if modifier.on and modifier.target and modifier.type in _BINDING:
            yield modifier.target


def _shift(subject: Subject, measures: Measures, part: tuple[str, ...], travel: list[Poses]) -> float:
    """The longest way of a corner of the part's box, seen from the host, from the first frame to the last."""
    corners = _corners(subject, part)
    seen: list[Array] = []
    name, host = travel[0].names
    now = _matrix(measures, travel[0], name)
    if abs(np.linalg.det(now[:3, :3])) < 1e-12:
        raise Unmeasured(f"{name!r} is scaled to nothing")
    local = np.linalg.solve(now, corners.T)
    for request in travel[1:]:
        place, axes = placed(measures[request].matrices[host])
        there = (_matrix(measures, request, name) @ local)[:3].T
        seen.append((there - place) @ axes.T)
    return float(np.linalg.norm(seen[1] - seen[0], axis=1).max())


def _matrix(measures: Measures, request: Poses, name: str) -> Array:
    return np.array(measures[request].matrices[name], dtype=float).reshape(4, 4)


def _corners(subject: Subject, names: tuple[str, ...]) -> Array:
    boxes: list[Box] = [box for name in names if (box := subject.structure.objects[name].box) is not None]
    low = np.min([box.low for box in boxes], axis=0)
    high = np.max([box.high for box in boxes], axis=0)
    return np.array([(*np.where([k & 1, k & 2, k & 4], high, low), 1.0) for k in range(8)], dtype=float)


def _judge_attachment(subject: Subject, measures: Measures) -> Iterator[Finding]:
    return judged(R7, subject, measures, FixedAttachment, misses=_fastened)


# R8: openings


def _opening(subject: Subject, relation: Aperture, frame: int | None) -> Opening:
    filler = surfaces(subject, relation.filler)
    return Opening(filler, surfaces(subject, relation.host, but=filler), frame)


def _ask_opening(subject: Subject, relation: Aperture, frame: int | None) -> Iterator[Request[Any]]:
    found = _opening(subject, relation, frame)
    yield found
    yield Depth(found.filler, found.host, frame)


def _ask_openings(subject: Subject) -> Iterator[Request[Any]]:
    yield from asked(subject, Aperture, ask=_ask_opening)


def _fills(subject: Subject, measures: Measures, relation: Aperture, frame: int | None) -> Iterator[Miss]:
    request, tolerances = _opening(subject, relation, frame), subject.tolerances
    filler, host = relation.filler, relation.host
    found = measures[request]
    if found.gap is None or found.unbounded > tolerances.rim_opening:
        yield Miss(
            f"{filler!r} is in no opening of {host!r}: over {found.unbounded:.0f}° around it there is no rim.",
            found.unbounded,
            tolerances.rim_opening,
            "°",
            found.at,
            "Cut an opening into the host there, and put the filler into it.",
        )
        return
    depth = measures[Depth(request.filler, request.host, frame)]
    if depth.depth > (most := tolerances.noise(smallest(subject, request.filler, request.host))):
        yield Miss(
            f"{filler!r} is {depth.depth * 1000:.1f} mm deep in {host!r} around its opening.",
            depth.depth,
            most,
            "m",
            depth.at,
            "Cut the opening (a Boolean modifier on the host) as large as the filler, or make the filler smaller.",
        )
    elif found.gap > tolerances.rim_gap:
        yield Miss(
            f"between {filler!r} and the rim of its opening in {host!r} there is a gap of {found.gap * 1000:.1f} mm.",
            found.gap,
            tolerances.rim_gap,
            "m",
            found.at,
        )


def _judge_openings(subject: Subject, measures: Measures) -> Iterator[Finding]:
    return judged(R8, subject, measures, Aperture, misses=_fills)


R7 = Rule(
    "R7",
    "fixed attachment",
    "hard",
    "FixedAttachment(part, host): the surfaces are at most ε apart; parents or constraints lead from the part to the "
    "host (or from both to the same object); and seen from the host, the part is at the last frame where it was first.",
    "A handle that only stands beside its door stays behind when the door moves.",
    "Give the part's root a Child Of constraint to the host's root, or make both meshes of one object (L3).",
    _judge_attachment,
    _ask_attachment,
    needs_plan=True,
    tolerances=("contact", "contact_share", "contact_most"),
)
R8 = Rule(
    "R8",
    "aperture",
    "hard",
    "Aperture(filler, host): an opening of the host surrounds the filler, its rim is nowhere far from it, and the two "
    "are not in each other. An opening may be without a rim on one side, as a door's is at the floor.",
    "A window before an uncut wall shows the wall; in a hole that is too large it shows the sky around it.",
    "Move the filler into the middle of the opening, or make the opening as large as the filler.",
    _judge_openings,
    _ask_openings,
    needs_plan=True,
    tolerances=("rim_gap", "rim_opening", "penetration", "penetration_share"),
)
RULES = (R7, R8)
