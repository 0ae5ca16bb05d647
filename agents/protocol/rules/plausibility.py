"""T6: what falls falls as fast as gravity makes it, nothing goes through a collider, nothing jumps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from agents.plan.relations import EmbeddedIn
from agents.protocol.judging.contact_pairs import declared, smallest_diagonal
from agents.protocol.judging.phases import (
    acting,
    gravity_of,
    greatest_speed,
    meshes_of,
    motion_of,
    onset,
    path_of,
    phases_of,
    told,
)
from agents.protocol.judging.relation_judge import smallest
from agents.protocol.measures.measure import Measures, Request, Unmeasured
from agents.protocol.measures.motion import Passage, Touches
from agents.protocol.rule import Rule, Subject
from agents.protocol.vocabulary import GROUND

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.motion import Phase
    from agents.plan.scene import PlannedObject
    from agents.protocol.findings import Finding
    from agents.protocol.judging.phases import Motion
    from agents.protocol.judging.sample_frames import Array

_BLOW = 3.0  # times what gravity does in a frame: a change of speed against it that only a blow makes
_FEWEST = 3  # frames that a fall is fitted to
_HALVED = 8  # from so many on, both halves must be falls: what eases in and out is one on average only
_LOOSE = frozenset({"emitter", "fluid"})  # they have no surface of their own to be stopped by


def _requests(subject: Subject) -> Iterator[Request[Any]]:
    for _, phase in acting(subject):
        if request := path_of(subject, phase.actor):
            yield request
        if request := _touching(subject, phase):
            yield request
    for actor in dict.fromkeys(phase.actor for _, phase in acting(subject)):
        for collider in _colliders(subject, actor):
            if request := _passage(subject, actor, collider):
                yield request


def _judge(subject: Subject, measures: Measures) -> Iterator[Finding]:
    for place, phase in acting(subject):
        for check in (_fall, _jump):
            try:
                yield from check(subject, measures, place, phase)
            except Unmeasured as reason:
                yield T6.undecided((phase.actor,), reason)
    for actor in dict.fromkeys(phase.actor for _, phase in acting(subject)):
        yield from _tunnels(subject, measures, actor)


# Falls


def _touching(subject: Subject, phase: Phase) -> Touches | None:
    """The request for when something that falls touches anything at all."""
    own = meshes_of(subject, phase.actor)
    if phase.kind != "fall" or not own:
        return None
    others = tuple(
        one.name
        for one in subject.structure.meshes
        if one.type == "MESH"
        and one.surface
        and one.name not in own
        and (one.rendered or one.rigid_body or any(m.type == "COLLISION" for m in one.modifiers))
        and not any(m.type == "FLUID_DOMAIN" for m in one.modifiers)
    )
    if not others:
        return None
    within = subject.tolerances.contact_gap(smallest_diagonal(subject, own))
    return Touches(own, others, phase.start, phase.end, within)


def _fall(subject: Subject, measures: Measures, place: int, phase: Phase) -> Iterator[Finding]:
    if phase.kind != "fall":
        return
    motion = motion_of(subject, measures, phase.actor)
    if not motion.is_followed:
        return  # a stream falls drop by drop: its centre does not
    began = onset(subject, motion, phase)
    if began is None:
        raise Unmeasured(f"it does not move in {phase.name!r}")
    gravity = gravity_of(subject)
    request = _touching(subject, phase)
    touching = set(measures[request].frames) if request else set[int]()
    first, last = _flight(subject, motion, (max(began.frame, phase.start) + 1, phase.end), touching)
    if last - first + 1 < _FEWEST:
        raise Unmeasured(
            f"in {phase.name!r} it is in the air for {max(0, last - first + 1)} frames; {_FEWEST} would tell a fall"
        )
    found = min(
        (_acceleration(subject, motion, (first, last), origins=origins) for origins in (False, True)),
        key=lambda one: abs(one - gravity),
    )
    most = subject.tolerances.gravity_share * gravity
    # The air holds up what bends, as cloth.
    if found - gravity > most or (gravity - found > most and not motion.deforms):
        yield T6.finding(
            (phase.actor,),
            f"{told(place, phase)} falls with {found:.2f} m/s² from frame {first} to {last}; "
            f"gravity is {gravity:.2f} m/s².",
            fix="Have the rigid-body solver make the fall, without keyframes, at the scene's gravity; then bake.",
            frame=first,
            measured=found,
            tolerance=most,
            unit="m/s²",
        )


def _down(subject: Subject) -> Array:
    """The direction in which things fall."""
    gravity = np.array(subject.facts.gravity, dtype=float)
    length = float(np.linalg.norm(gravity))
    return gravity / length if length else np.array([0.0, 0.0, -1.0])


def _flight(subject: Subject, motion: Motion, frames: tuple[int, int], touching: set[int]) -> tuple[int, int]:
    """The longest run of frames in which an actor touches nothing, and is not hit either."""
    start, end = frames
    heights = -motion.places(start, end) @ _down(subject)
    blow = _BLOW * gravity_of(subject) / motion.fps**2
    best = (start, start - 1)
    begin: int | None = None
    for at, frame in enumerate(range(start, end + 1)):
        there = frame not in touching and not np.isnan(heights[at])
        hit = (
            begin is not None
            and at - 1 > begin - start
            and heights[at] - 2 * heights[at - 1] + heights[at - 2] > blow
        )
        if begin is None or not there or hit:
            begin = frame if there else None
        if begin is not None and frame - begin > best[1] - best[0]:
            best = (begin, frame)
    return best


def _acceleration(subject: Subject, motion: Motion, frames: tuple[int, int], *, origins: bool) -> float:
    """With which acceleration it falls, in m/s²: of the whole fall or one of its halves, what is farthest from g."""
    depths = motion.places(*frames, origins=origins) @ _down(subject)
    times = np.arange(len(depths)) / motion.fps
    half = len(depths) // 2
    parts = [slice(None)]
    if len(depths) >= _HALVED:
        parts += [slice(half), slice(half, None)]
    found = [float(2 * np.polyfit(times[part], depths[part], 2)[0]) for part in parts]
    return max(found, key=lambda one: abs(one - gravity_of(subject)))


# Jumps


def _jump(subject: Subject, measures: Measures, place: int, phase: Phase) -> Iterator[Finding]:
    motion = motion_of(subject, measures, phase.actor)
    speeds = [greatest_speed(subject, one) for one in _carrying(subject, phase)]
    if speeds[0] is None or not motion.is_followed or phase.start >= phase.end:
        return  # the plan says nothing about its speed
    speed = max(one for one in speeds if one is not None)
    steps = motion.steps(phase.start, phase.end)
    if np.isnan(steps).all():
        raise Unmeasured(f"there is nothing of it in {phase.name!r}")
    worst = int(np.nanargmax(steps))
    most = max(subject.tolerances.jump * speed / motion.fps, subject.tolerances.contact_gap(motion.path.size))
    if steps[worst] > most:
        yield T6.finding(
            (phase.actor,),
            f"{told(place, phase)} jumps by {steps[worst]:.3f} m in one frame; with the planned "
            f"{speed:.3g} m/s it goes {speed / motion.fps:.3f} m.",
            fix="Remove the jump: a keyframe that is out of place, a body that bursts out of another one, or a "
            "simulation with too few substeps.",
            frame=phase.start + 1 + worst,
            measured=float(steps[worst]),
            tolerance=most,
            unit="m",
        )


def _carrying(subject: Subject, phase: Phase) -> list[Phase]:
    """A phase, and the one right before it of the same actor, whose speed it carries on."""
    before = [
        one
        for one in phases_of(subject, phase.actor)
        if one is not phase and one.start <= phase.start and phase.start - 1 <= one.end <= phase.start
    ]
    return [phase, *before]


# Tunnels


def _colliders(subject: Subject, actor: str) -> list[str]:
    """What the actor must not go through: grounds and colliders, and what stands still and is to be touched by it."""
    objects = {one.name: one for one in subject.planned.objects}
    if actor in objects and objects[actor].role in _LOOSE:
        return []
    touched = set[str]()
    for contact in declared(subject):
        things = [subject.structure.thing_of(node) for node in (contact.a, contact.b)]
        names = {thing.name for thing in things if thing is not None}
        if actor in names:
            touched |= names
    sunk = {
        frozenset(node.partition("/")[0] for node in relation.nodes)
        for relation in subject.planned.relations
        if isinstance(relation, EmbeddedIn)
    }
    return [
        name
        for name, one in objects.items()
        if name != actor and frozenset((name, actor)) not in sunk and _stops(one, touched)
    ]


def _stops(one: PlannedObject, touched: set[str]) -> bool:
    return (
        one.role in {"ground", "collider"}
        or GROUND in one.systems
        or (one.role == "static" and one.name in touched)
    )


def _passage(subject: Subject, actor: str, collider: str) -> Passage | None:
    own, other = meshes_of(subject, actor), meshes_of(subject, collider)
    if not own or not other:
        return None
    phases = phases_of(subject, actor)
    tolerances = subject.tolerances
    most = max(tolerances.penetration, tolerances.tunnel_share * smallest(subject, own, other))
    return Passage(own, other, phases[0].start, max(phase.end for phase in phases), most)


def _tunnels(subject: Subject, measures: Measures, actor: str) -> Iterator[Finding]:
    for collider in _colliders(subject, actor):
        request = _passage(subject, actor, collider)
        try:
            if request is None:
                missing = collider if meshes_of(subject, actor) else actor
                raise Unmeasured(f"there is no mesh of {missing!r}")
            found = measures[request]
        except Unmeasured as reason:
            yield T6.undecided((actor, collider), reason)
            continue
        if found.depth > request.beyond:
            what = (
                "goes through {!r} within a frame: it gets {:.3f} m behind its surface."
                if found.through
                else "gets into {!r}, {:.3f} m deep."
            )
            yield T6.finding(
                (actor, collider),
                f"{actor!r} {what.format(collider, found.depth)}",
                fix="Give both a collision shape that fits, make the collider thicker, or simulate more substeps; "
                "then bake again.",
                frame=found.frame,
                measured=found.depth,
                tolerance=request.beyond,
                unit="m",
                at=found.at,
            )


T6 = Rule(
    "T6",
    "plausibility",
    "hard",
    "Falls are as fast as gravity makes them; nothing goes through a ground or collider; no step is larger than 1.5 "
    "times the greatest planned speed.",
    "Floating falls, things that sink through the floor and jumps are what an eye sees first in a faked motion.",
    "Simulate the motion instead of keyframing it, with colliders that fit and enough substeps, and bake.",
    _judge,
    _requests,
    needs_plan=True,
    tolerances=(
        "gravity_share",
        "tunnel_share",
        "penetration",
        "jump",
        "contact",
        "contact_share",
        "contact_most",
        "moving_share",
    ),
)
RULES = (T6,)
