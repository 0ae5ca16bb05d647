"""R7 and R8: what is fastened to a host, and what fills an opening of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agents.plan.graph import reachable
from agents.plan.relations import Aperture, FixedAttachment
from agents.protocol.judging.geometry.poses import anchor
from agents.protocol.judging.geometry.vectors import place_and_axes
from agents.protocol.judging.move_advice import describe_move, gap_vector, is_near
from agents.protocol.judging.planned_relations import Violation, relation_rule, surface_pair, surfaces
from agents.protocol.judging.sample_frames import moves, sample_frames
from agents.protocol.judging.sizes import contact_gap, smallest_dimension
from agents.protocol.measures.contact import DepthRequest, OpeningRequest
from agents.protocol.measures.geometry import GapRequest, PosesRequest
from agents.protocol.measures.requests import Unmeasured
from agents.protocol.tolerances import CONTACT, PENETRATION

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from agents.protocol.judging.geometry.vectors import Array
    from agents.protocol.measures.requests import Measures, Names, Request
    from agents.protocol.rule import RuleContext

# Constraints that carry an object along with their target, and modifiers that bind its mesh to theirs.
_CARRYING = frozenset({"CHILD_OF", "COPY_LOCATION", "COPY_TRANSFORMS", "ARMATURE", "PIVOT", "FOLLOW_PATH"})
_BINDING = frozenset({"ARMATURE", "SURFACE_DEFORM", "MESH_DEFORM", "LATTICE", "HOOK"})
_DEFORMING = _BINDING | {"CLOTH", "SOFT_BODY", "MESH_CACHE"}


# R7: fastening


def _deforms(context: RuleContext, names: Names) -> bool:
    """Whether meshes deform: then they may keep touching while their origins part."""
    items = (context.structure.objects[name] for name in names)
    return any(item.animated_shape_keys or item.has_modifier(_DEFORMING) for item in items)


def _pose_requests(context: RuleContext, relation: FixedAttachment) -> list[PosesRequest]:
    """Where part and host are now and at the timeline's ends; none if they do not move, or if they deform."""
    part, host = anchor(context, relation.part), anchor(context, relation.host)
    meshes = (*surfaces(context, relation.part), *surfaces(context, relation.host))
    still = not any(moves(context, node) for node in relation.nodes)
    if part is None or host is None or still or _deforms(context, meshes):
        return []
    frames = (None, context.facts.frame_start, context.facts.frame_end)
    return [PosesRequest((part, host), frame) for frame in frames]


def _attachment_requests(
    context: RuleContext, relation: FixedAttachment, frame: int | None
) -> Iterator[Request[Any]]:
    yield GapRequest(*surface_pair(context, *relation.nodes), frame)
    yield from _pose_requests(context, relation)


def _not_fastened(
    context: RuleContext, measures: Measures, relation: FixedAttachment, frame: int | None
) -> Iterator[Violation]:
    part, host = surface_pair(context, *relation.nodes)
    most = contact_gap(context, part, host)
    # Deforming meshes have no pose that could be compared: they must touch at all sampled frames.
    deforms = _deforms(context, (*part, *host))
    frames = sample_frames(context, *relation.nodes) if deforms else (frame,)
    gap = max((measures[GapRequest(part, host, sample)] for sample in frames), key=lambda gap: gap.distance)
    if gap.distance > most:
        yield Violation(
            f"{relation.part!r} is {gap.distance * 1000:.1f} mm away from {relation.host!r}.",
            gap.distance,
            most,
            "m",
            gap.here,
            f"{describe_move(relation.part, gap_vector(gap))}, so that it touches {relation.host!r}."
            if is_near(context, part, gap.distance)
            else None,
        )
    if _is_fluid(context, relation.part):
        return  # its source touches the host; what comes out of it goes where it will
    if not _is_linked(context, relation):
        yield Violation(
            f"{relation.part!r} does not move with {relation.host!r}: no parent or constraint links them.",
            at=gap.here,
        )
        return
    poses = _pose_requests(context, relation)
    if poses and (shift := _shift(context, measures, part, poses)) > most:
        yield Violation(
            f"{relation.part!r} moves {shift * 1000:.1f} mm relative to {relation.host!r} between frames "
            f"{context.facts.frame_start} and {context.facts.frame_end}.",
            shift,
            most,
            "m",
            gap.here,
            "Remove what moves it separately (keys, physics, other constraints), or set the link's influence to 1.",
        )


def _is_fluid(context: RuleContext, node: str) -> bool:
    obj = context.structure.logical_object_of(node)
    return obj is not None and any(item.is_fluid_domain for item in obj.members)


def _is_linked(context: RuleContext, relation: FixedAttachment) -> bool:
    """Whether all of the part follows the host, or both follow the same object."""
    carriers: set[str] = set()
    for name in (*_link_starts(context, relation.host), *surfaces(context, relation.host)):
        carriers |= _followed(context, name)
    obj = context.structure.logical_object_of(relation.host)
    if obj is not None and "/" not in relation.host:
        carriers.update(item.name for item in obj.members)
    return all(_followed(context, name) & carriers for name in _link_starts(context, relation.part))


def _link_starts(context: RuleContext, node: str) -> Names:
    """The objects that must follow for a whole node to follow: its root if its meshes follow that; else every mesh."""
    names = surfaces(context, node)
    root = anchor(context, node)
    if root is not None and all(root in _followed(context, name) for name in names):
        # A single mesh may be linked itself, without its root.
        return (root,) if len(names) != 1 else names
    return names


def _followed(context: RuleContext, name: str) -> set[str]:
    """An object and all that it follows: parents and targets of constraints and modifiers, over any number of steps."""
    objects = context.structure.objects

    def targets(name: str) -> Iterator[str]:
        item = objects[name]
        links = [link.target for link in item.constraints if link.on and link.type in _CARRYING]
        links += [link.target for link in item.modifiers if link.on and link.type in _BINDING]
        return (target for target in (item.parent, *links) if target in objects)

    return set(reachable([name], targets))


def _shift(context: RuleContext, measures: Measures, part: Names, poses: list[PosesRequest]) -> float:
    """The largest move of a corner of the part's box relative to the host, from the first frame to the last."""
    now, *ends = poses
    name, host = now.names
    matrix = _matrix(measures, now, name)
    if abs(np.linalg.det(matrix[:3, :3])) < 1e-12:
        raise Unmeasured(f"{name!r} has scale 0")
    local = np.linalg.solve(matrix, _corners(context, part).T)
    relative: list[Array] = []
    for request in ends:
        place, axes = place_and_axes(measures[request].matrices[host])
        corners = (_matrix(measures, request, name) @ local)[:3].T
        relative.append((corners - place) @ axes.T)
    return float(np.linalg.norm(relative[1] - relative[0], axis=1).max())


def _matrix(measures: Measures, request: PosesRequest, name: str) -> Array:
    return np.array(measures[request].matrices[name], dtype=float).reshape(4, 4)


def _corners(context: RuleContext, names: Names) -> Array:
    boxes = [box for name in names if (box := context.structure.objects[name].box) is not None]
    low = np.min([box.low for box in boxes], axis=0)
    high = np.max([box.high for box in boxes], axis=0)
    return np.array([(*np.where([k & 1, k & 2, k & 4], high, low), 1.0) for k in range(8)], dtype=float)


# R8: openings


def _opening(context: RuleContext, relation: Aperture, frame: int | None) -> OpeningRequest:
    """The leaves of a door fill one opening together: to each, the other is a part of the rim."""
    filler, host = surface_pair(context, *relation.nodes)
    others = (
        name
        for other in (context.plan.relations if context.plan else ())
        if isinstance(other, Aperture) and other.host == relation.host
        for name in context.structure.surfaces_of(other.filler)
    )
    rim = dict.fromkeys((*host, *(name for name in others if name not in filler)))
    return OpeningRequest(filler, tuple(rim), frame)


def _opening_requests(context: RuleContext, relation: Aperture, frame: int | None) -> Iterator[Request[Any]]:
    yield _opening(context, relation, frame)
    yield DepthRequest(*surface_pair(context, *relation.nodes), frame)


def _not_filling(
    context: RuleContext, measures: Measures, relation: Aperture, frame: int | None
) -> Iterator[Violation]:
    request, tolerances = _opening(context, relation, frame), context.tolerances
    filler, host = relation.filler, relation.host
    opening = measures[request]
    if opening.gap is None or opening.unbounded > tolerances.rim_opening:
        yield Violation(
            f"{filler!r} is not in an opening of {host!r}: over {opening.unbounded:.0f}° around it there is no rim.",
            opening.unbounded,
            tolerances.rim_opening,
            "°",
            opening.at,
            "Cut an opening into the host there, and put the filler into it.",
        )
        return
    around = surface_pair(context, *relation.nodes)
    depth = measures[DepthRequest(*around, frame)]
    if depth.depth > (most := tolerances.noise(smallest_dimension(context, *around))):
        yield Violation(
            f"{filler!r} is {depth.depth * 1000:.1f} mm deep in {host!r} around its opening.",
            depth.depth,
            most,
            "m",
            depth.at,
            "Cut the opening (a Boolean modifier on the host) as large as the filler, or make the filler smaller.",
        )
    elif opening.gap > tolerances.rim_gap:
        yield Violation(
            f"{filler!r} has a gap of {opening.gap * 1000:.1f} mm to the rim of its opening in {host!r}.",
            opening.gap,
            tolerances.rim_gap,
            "m",
            opening.at,
        )


R7 = relation_rule(
    "R7",
    "fixed attachment",
    "FixedAttachment(part, host): the surfaces are at most ε apart; parents or constraints lead from the part to the "
    "host (or from both to the same object); the part keeps its place relative to the host from the first frame to the "
    "last.",
    "A handle that is only placed at its door stays behind when the door moves.",
    "Give the part's root a Child Of constraint to the host's root, or make both meshes of one object (L3).",
    FixedAttachment,
    requests=_attachment_requests,
    violations=_not_fastened,
    tolerances=CONTACT,
)
R8 = relation_rule(
    "R8",
    "aperture",
    "Aperture(filler, host): an opening of the host surrounds the filler, its rim is close to the filler all around, "
    "and the two do not penetrate each other. An opening may lack a rim on one side, as a door's does at the floor.",
    "A window in front of an uncut wall shows the wall; in a hole that is too large it shows the sky around it.",
    "Move the filler into the middle of the opening, or make the opening as large as the filler.",
    Aperture,
    requests=_opening_requests,
    violations=_not_filling,
    tolerances=("rim_gap", "rim_opening", *PENETRATION),
)
RULES = (R7, R8)
