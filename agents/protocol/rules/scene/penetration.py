"""V2: no undeclared penetration (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agents.protocol.judging.declared_contacts import allowed_crossings
from agents.protocol.judging.move_advice import describe_closing_move
from agents.protocol.judging.sizes import contact_gap
from agents.protocol.measures.geometry import Crossing, CrossingsRequest
from agents.protocol.measures.requests import Measures, Unmeasured
from agents.protocol.rule import NotApplicable, Rule, RuleContext
from agents.protocol.tolerances import CONTACT, PENETRATION

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from agents.protocol.findings import Finding
    from agents.protocol.measures.requests import Names

_DECLARE = "or, if they should touch or fit into each other, declare it (contact_with, the plan)"
_DECLARE_PARTS = "or, if its parts are made to reach into each other, name it in its own contact_with"
# What has been moved away at the first frame comes back by its motion.
_BY_MOTION = (
    "Their motion brings them together: change its settings (margins, steps a frame, applied scales) or paths"
)
_NAMED = 6
_MAX_MOVE = 2.0  # times the depth; where a move along an axis is longer, another way out is shorter


def _requests(context: RuleContext) -> Iterator[CrossingsRequest]:
    facts = context.facts
    rendered = [mesh.name for mesh in context.structure.meshes if mesh.surface and mesh.rendered]
    if len(rendered) < 2:
        raise NotApplicable("renders show fewer than two meshes")
    names, noise = tuple(sorted(rendered)), context.tolerances.penetration
    but = tuple(sorted((min(pair), max(pair)) for pair in allowed_crossings(context)))
    yield CrossingsRequest(names, but=but, noise=noise)
    moving = tuple(name for name in names if context.structure.can_move(name))
    for frame in dict.fromkeys((facts.frame_start, facts.frame_end)):
        if moving and frame != facts.frame and (context.judges_end or frame == facts.frame_start):
            yield CrossingsRequest(names, frame, moving, but, noise)


def _judge(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    objects = context.structure.objects
    allowed = allowed_crossings(context)
    reported: set[frozenset[str]] = set()
    within: dict[str, list[Finding]] = {}
    for request in _requests(context):
        try:
            pairs = measures[request].pairs
        except Unmeasured as reason:
            yield V2.undecided((), reason, frame=request.frame)
            continue
        for pair in pairs:
            key = frozenset((pair.a, pair.b))
            if key in allowed or key in reported or any(objects[name].is_fluid_domain for name in key):
                continue
            if (finding := _finding(context, pair, request.frame)) is not None:
                reported.add(key)
                owner = _common_object(context, pair) if finding.outcome == "broken" else ""
                if owner:
                    within.setdefault(owner, []).append(finding)
                else:
                    yield finding
    for owner, findings in within.items():
        yield _of_parts(owner, findings)


def _common_object(context: RuleContext, pair: Crossing) -> str:
    """The object that both meshes are parts of, "" for none."""
    first, second = (context.structure.logical_object_of(name) for name in (pair.a, pair.b))
    return first.name if first is not None and second is not None and first.name == second.name else ""


def _of_parts(owner: str, findings: Sequence[Finding]) -> Finding:
    """One finding for the parts of an object that reach into each other: mostly they are made so."""
    worst = max(findings, key=lambda finding: finding.measured or 0.0)
    told = "; ".join(finding.message.rstrip(".") for finding in findings[:_NAMED])
    more = f"; and {len(findings) - _NAMED} pairs more" if len(findings) > _NAMED else ""
    return V2.finding(
        tuple(dict.fromkeys(name for finding in findings for name in finding.objects)),
        f"Parts of {owner!r} reach into each other: {told}{more}.",
        fix=f"Move them apart; {_DECLARE_PARTS}: blender_group(object={owner!r}, contact_with=[…, {owner!r}]).",
        measured=worst.measured,
        tolerance=worst.tolerance,
        unit="m",
        at=worst.at,
        frame=worst.frame,
    )


def _finding(context: RuleContext, pair: Crossing, frame: int | None) -> Finding | None:
    """The finding for two meshes that cross; None where the depth is noise."""
    names = tuple(dict.fromkeys((pair.a, pair.b)))
    if pair.depth is None:
        return V2.undecided(names, pair.undecided, frame=frame)
    objects = context.structure.objects
    sizes = [size for name in names for size in objects[name].dimensions or ()]
    most = context.tolerances.noise(min(sizes, default=0.0))
    if _are_kept_apart(context, names, frame):
        most = max(most, contact_gap(context, names))
    if pair.depth <= most:
        return None
    when = f" at frame {frame}" if frame is not None else ""
    fix = V2.fix
    if frame is not None and frame > context.facts.frame_start:
        fix = f"{_BY_MOTION}; {_DECLARE}."
    elif frame is None and pair.way is not None and math.hypot(*pair.way) <= _MAX_MOVE * pair.depth:
        first, second = _movable(context, pair.a, pair.b), _movable(context, pair.b, pair.a)
        if move := describe_closing_move(context, first, second, pair.way):
            fix = f"{move}; {_DECLARE}."
    return V2.finding(
        names,
        f"{pair.a!r} and {pair.b!r} penetrate each other by {pair.depth * 1000:.1f} mm{when}.",
        fix=fix,
        measured=pair.depth,
        tolerance=most,
        unit="m",
        at=pair.at,
        frame=frame,
    )


def _are_kept_apart(context: RuleContext, names: Names, frame: int | None) -> bool:
    """Whether the rigid-body solver has moved one of two bodies: what it lays on another sinks in by its own error."""
    at = context.facts.frame if frame is None else frame
    items = [context.structure.objects[name] for name in names]
    bodies = [item.rigid_body for item in items if item.rigid_body is not None and item.rigid_body.enabled]
    is_moved = any(body.active and not body.kinematic for body in bodies)
    return is_moved and len(bodies) == len(items) and at > context.facts.frame_start


def _movable(context: RuleContext, name: str, other: str) -> tuple[str, Names]:
    """What to move for a mesh: its whole object, unless the other mesh is part of that too."""
    obj, others = context.structure.logical_object_of(name), context.structure.logical_object_of(other)
    if obj is None or (others is not None and others.name == obj.name):
        return name, (name,)
    return obj.name, obj.surfaces


V2 = Rule(
    "V2",
    "penetration",
    "hard",
    "Two meshes that penetrate each other deeper than numerical noise are declared to touch.",
    "Meshes that penetrate each other flicker, explode in a simulation, and cannot be taken apart. Those that move are "
    "compared at the first frame, at the last one, and at the one that is checked. What the rigid-body solver has laid "
    "on another body may sink in by ε.",
    f"Move them apart; {_DECLARE}.",
    _judge,
    _requests,
    tolerances=(*PENETRATION, *CONTACT),
)
RULES = (V2,)
