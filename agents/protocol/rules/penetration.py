"""V2: nothing goes through anything undeclared (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agents.protocol.judging.contact_pairs import may_cross
from agents.protocol.judging.move_advice import told_join
from agents.protocol.measures.measure import Crossing, Crossings, Measures, Unmeasured
from agents.protocol.rule import Idle, Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding
    from agents.protocol.measures.measure import Names

_DECLARE = "or, if they are meant to touch or be fitted into each other, say so (contact_with, the plan)"
_FAR = 2.0  # times the depth: where a move along an axis is longer, another way out is shorter


def _requests(subject: Subject) -> Iterator[Crossings]:
    facts = subject.facts
    shown = [mesh.name for mesh in subject.structure.meshes if mesh.surface and mesh.rendered]
    if len(shown) < 2:
        raise Idle("there are fewer than two meshes that renders show")
    names, noise = tuple(sorted(shown)), subject.tolerances.penetration
    but = tuple(sorted((min(pair), max(pair)) for pair in may_cross(subject)))
    yield Crossings(names, but=but, noise=noise)
    moving = tuple(name for name in names if subject.structure.moves(name))
    for frame in dict.fromkeys((facts.frame_start, facts.frame_end)):
        if moving and frame != facts.frame:
            yield Crossings(names, frame, moving, but, noise)


def _judge(subject: Subject, measures: Measures) -> Iterator[Finding]:
    declared = may_cross(subject)
    told: set[frozenset[str]] = set()
    for request in _requests(subject):
        try:
            pairs = measures[request].pairs
        except Unmeasured as reason:
            yield V2.undecided((), reason, frame=request.frame)
            continue
        for pair in pairs:
            key = frozenset((pair.a, pair.b))
            if key in declared or key in told or _kept_apart(subject, pair.a, pair.b):
                continue
            if (found := _amiss(subject, pair, request.frame)) is not None:
                told.add(key)
                yield found


def _amiss(subject: Subject, pair: Crossing, frame: int | None) -> Finding | None:
    """What is to be said of two meshes that cross and are not said to touch; None where it is noise."""
    names = tuple(dict.fromkeys((pair.a, pair.b)))
    if pair.depth is None:
        return V2.undecided(names, pair.undecided, frame=frame)
    objects = subject.structure.objects
    sizes = [size for name in names for size in objects[name].dimensions or ()]
    most = subject.tolerances.noise(min(sizes, default=0.0))
    if pair.depth <= most:
        return None
    when = f" at frame {frame}" if frame is not None else ""
    fix = V2.fix
    if frame is None and pair.way is not None and math.hypot(*pair.way) <= _FAR * pair.depth:
        move = told_join(subject, _moved(subject, pair.a, pair.b), _moved(subject, pair.b, pair.a), pair.way)
        fix = f"{move}; {_DECLARE}."
    return V2.finding(
        names,
        f"{pair.a!r} and {pair.b!r} are {pair.depth * 1000:.1f} mm deep in each other{when}.",
        fix=fix,
        measured=pair.depth,
        tolerance=most,
        unit="m",
        at=pair.at,
        frame=frame,
    )


def _moved(subject: Subject, name: str, other: str) -> tuple[str, Names]:
    """What is to be moved for a mesh: all of its object, unless the other one is a part of that, too."""
    thing, others = subject.structure.thing_of(name), subject.structure.thing_of(other)
    if thing is None or (others is not None and others.name == thing.name):
        return name, (name,)
    return thing.name, thing.surfaces


def _kept_apart(subject: Subject, a: str, b: str) -> bool:
    """Whether one of the two is no body of its own: a fluid's domain encloses what it is about."""
    objects = subject.structure.objects
    return any(modifier.type == "FLUID_DOMAIN" for name in (a, b) for modifier in objects[name].modifiers)


V2 = Rule(
    "V2",
    "penetration",
    "hard",
    "Two meshes that share space deeper than numerical noise are declared to touch.",
    "A mesh that is punched through another flickers, explodes when it is simulated, and cannot be taken apart.",
    f"Move them apart; {_DECLARE}.",
    _judge,
    _requests,
    tolerances=("penetration", "penetration_share"),
)
RULES = (V2,)
