"""T6: falls follow gravity, nothing passes through a collider, nothing jumps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from agents.plan.relations import EmbeddedIn
from agents.protocol.judging.declared_contacts import allowed_crossings, declared_contacts
from agents.protocol.judging.measured_motion import measured_motion, mesh_names, path_request
from agents.protocol.judging.phases import (
    find_onset,
    gravity_of,
    greatest_speed,
    phase_label,
    phases_of,
    planned_phases,
)
from agents.protocol.judging.sizes import contact_gap, smallest_dimension
from agents.protocol.judging.solver_advice import into_collider
from agents.protocol.measures.motion import ContactFramesRequest, PassageMeasure, PassageRequest
from agents.protocol.measures.requests import Measures, Request, Unmeasured
from agents.protocol.rule import Rule, RuleContext
from agents.protocol.tolerances import CONTACT
from agents.protocol.vocabulary import GROUND

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.motion import MotionPhase
    from agents.plan.scene import PlannedObject
    from agents.protocol.findings import Finding
    from agents.protocol.judging.geometry.vectors import Array
    from agents.protocol.judging.measured_motion import MeasuredMotion

_IMPACT = (
    3.0  # times gravity's change of speed in a frame: a change against gravity that only an impact makes
)
_MIN_FRAMES = 3  # that a fall is fitted to
_HALVES_FROM = 8  # frames from which both halves must be falls: eased keyframes are one only on average
_FREE_FALL = (
    "Let it fall freely, touching nothing, for that many frames of the phase: from higher up, or with what it lands on "
    "or is hit by farther away."
)
_MIN_SINKING = 4  # frames that a cloth has to fall before it is judged
_SINKING = 0.35  # share of a free fall below which a cloth that nothing holds sinks as if in syrup
_WITHOUT_SURFACE = frozenset({"emitter", "fluid"})  # roles that colliders stop by other means


def _requests(context: RuleContext) -> Iterator[Request[Any]]:
    for _, phase in planned_phases(context):
        if request := path_request(context, phase.actor):
            yield request
        if request := _touching(context, phase):
            yield request
    for actor in dict.fromkeys(phase.actor for _, phase in planned_phases(context)):
        for collider in _colliders(context, actor):
            if request := _passage(context, actor, collider):
                yield request


def _judge(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    for place, phase in planned_phases(context):
        for check in (_fall, _sink, _jump):
            try:
                yield from check(context, measures, place, phase)
            except Unmeasured as reason:
                fix = _FREE_FALL if phase.kind == "fall" else T6.fix
                yield T6.undecided((phase.actor,), reason, fix=fix)
    for actor in dict.fromkeys(phase.actor for _, phase in planned_phases(context)):
        yield from _tunnels(context, measures, actor)


# Falls


def _touching(context: RuleContext, phase: MotionPhase) -> ContactFramesRequest | None:
    """The request for when a falling actor touches anything."""
    own = mesh_names(context, phase.actor)
    sinks = _may_sink(context, phase)
    if (phase.kind != "fall" and not sinks) or not own:
        return None
    others = tuple(
        mesh.name
        for mesh in context.structure.meshes
        if mesh.type == "MESH"
        and mesh.surface
        and mesh.name not in own
        and (mesh.rendered or mesh.rigid_body or any(m.type == "COLLISION" for m in mesh.modifiers))
        and not mesh.is_fluid_domain
    )
    if not others:
        return None
    end = phase.end if phase.kind == "fall" else min(phase.end, _sinking_end(context, phase))
    return ContactFramesRequest(own, others, phase.start, end, contact_gap(context, own))


def _fall(context: RuleContext, measures: Measures, place: int, phase: MotionPhase) -> Iterator[Finding]:
    if phase.kind != "fall":
        return
    motion = measured_motion(context, measures, phase.actor)
    if not motion.has_fixed_points:
        return  # the drops of a stream fall, but its centre does not
    onset = find_onset(context, motion, phase)
    if onset is None:
        raise Unmeasured(f"it does not move in {phase.name!r}")
    gravity = gravity_of(context)
    request = _touching(context, phase)
    touching = set(measures[request].frames) if request else set[int]()
    first, last = _flight(context, motion, (max(onset.frame, phase.start) + 1, phase.end), touching)
    if last - first + 1 < _MIN_FRAMES:
        raise Unmeasured(
            f"from frame {phase.start} to {phase.end} ({phase.name!r}) it is in the air, untouched, for "
            f"{max(0, last - first + 1)} frames; a fall needs {_MIN_FRAMES}"
        )
    acceleration = min(
        (_acceleration(context, motion, (first, last), origins=origins) for origins in (False, True)),
        key=lambda value: abs(value - gravity),
    )
    most = context.tolerances.gravity_share * gravity
    # Air slows down what deforms, such as cloth.
    if acceleration - gravity > most or (gravity - acceleration > most and not motion.deforms):
        yield T6.finding(
            (phase.actor,),
            f"{phase_label(place, phase)} accelerates by {acceleration:.2f} m/s² from frame {first} to {last}; "
            f"gravity is {gravity:.2f} m/s².",
            fix="Let the rigid-body solver make the fall, without keyframes, at the scene's gravity; then bake.",
            frame=first,
            measured=acceleration,
            tolerance=most,
            unit="m/s²",
        )


def _may_sink(context: RuleContext, phase: MotionPhase) -> bool:
    """Whether a phase lets a cloth fall that nothing holds: no pins, no force field."""
    planned = context.planned.object(phase.actor)
    obj = context.structure.by_name.get(phase.actor)
    if phase.kind not in {"fall", "deform"} or planned is None or planned.role != "cloth" or obj is None:
        return False
    pinned = any(modifier.pinned for mesh in obj.meshes for modifier in mesh.modifiers)
    return not pinned and not any(item.force_field for item in context.facts.objects)


def _sinking_end(context: RuleContext, phase: MotionPhase) -> int:
    """The last frame of the half second in which air has not slowed down a cloth yet."""
    return phase.start + max(_MIN_SINKING, round(context.facts.fps / 2))


def _sink(context: RuleContext, measures: Measures, place: int, phase: MotionPhase) -> Iterator[Finding]:
    """A cloth that nothing holds or touches begins to fall nearly as fast as a stone, whatever air does later."""
    request = _touching(context, phase)
    if not _may_sink(context, phase) or request is None:
        return
    motion = measured_motion(context, measures, phase.actor)
    last_frame = min(phase.end, _sinking_end(context, phase), motion.end)
    touching = set(measures[request].frames)
    if phase.start in touching or not motion.deforms:
        return
    first, last = _flight(context, motion, (phase.start, last_frame), touching)
    if first != phase.start or last - first < _MIN_SINKING:
        return
    fallen = float(np.diff(motion.places(first, last) @ _down(context)).sum())
    seconds = (last - first) / motion.fps
    gravity = gravity_of(context)
    share = fallen / (gravity * seconds**2 / 2)
    if share < _SINKING:
        yield T6.finding(
            (phase.actor,),
            f"{phase_label(place, phase)} sinks {fallen:.3f} m in the first {seconds:.2g} s, {share:.0%} of a free "
            "fall, with nothing that holds it.",
            fix="Give the cloth a mass of a gram a vertex or so, lower its air viscosity, raise its quality; then bake "
            "again.",
            frame=last,
            measured=share,
            tolerance=_SINKING,
        )


def _down(context: RuleContext) -> Array:
    """The direction of a fall."""
    gravity = np.array(context.facts.gravity, dtype=float)
    length = float(np.linalg.norm(gravity))
    return gravity / length if length else np.array([0.0, 0.0, -1.0])


def _flight(
    context: RuleContext, motion: MeasuredMotion, frames: tuple[int, int], touching: set[int]
) -> tuple[int, int]:
    """The longest run of frames in which an actor touches nothing and is not hit."""
    start, end = frames
    heights = -motion.places(start, end) @ _down(context)
    impact = _IMPACT * gravity_of(context) / motion.fps**2
    best = (start, start - 1)
    begin: int | None = None
    for at, frame in enumerate(range(start, end + 1)):
        there = frame not in touching and not np.isnan(heights[at])
        hit = (
            begin is not None
            and at - 1 > begin - start
            and heights[at] - 2 * heights[at - 1] + heights[at - 2] > impact
        )
        if begin is None or not there or hit:
            begin = frame if there else None
        if begin is not None and frame - begin > best[1] - best[0]:
            best = (begin, frame)
    return best


def _acceleration(
    context: RuleContext, motion: MeasuredMotion, frames: tuple[int, int], *, origins: bool
) -> float:
    """The acceleration of a fall in m/s²: of the whole, or of one of its halves, whichever is farthest from gravity."""
    depths = motion.places(*frames, origins=origins) @ _down(context)
    times = np.arange(len(depths)) / motion.fps
    half = len(depths) // 2
    parts = [slice(None)]
    if len(depths) >= _HALVES_FROM:
        parts += [slice(half), slice(half, None)]
    accelerations = [float(2 * np.polyfit(times[part], depths[part], 2)[0]) for part in parts]
    return max(accelerations, key=lambda value: abs(value - gravity_of(context)))


# Jumps


def _jump(context: RuleContext, measures: Measures, place: int, phase: MotionPhase) -> Iterator[Finding]:
    motion = measured_motion(context, measures, phase.actor)
    speeds = [greatest_speed(context, other) for other in _with_previous(context, phase)]
    if speeds[0] is None or not motion.has_fixed_points or phase.start >= phase.end:
        return  # the plan says nothing about its speed
    speed = max(speed for speed in speeds if speed is not None)
    steps = motion.step_lengths(phase.start, phase.end)
    if np.isnan(steps).all():
        raise Unmeasured(f"it does not exist in {phase.name!r}")
    worst = int(np.nanargmax(steps))
    most = max(context.tolerances.jump * speed / motion.fps, context.tolerances.contact_gap(motion.path.size))
    if steps[worst] > most:
        yield T6.finding(
            (phase.actor,),
            f"{phase_label(place, phase)} jumps by {steps[worst]:.3f} m in one frame; the planned "
            f"{speed:.3g} m/s allow {speed / motion.fps:.3f} m.",
            fix="Remove the jump: a misplaced keyframe, a body that bursts out of another one, or a simulation with "
            "too few substeps.",
            frame=phase.start + 1 + worst,
            measured=float(steps[worst]),
            tolerance=most,
            unit="m",
        )


def _with_previous(context: RuleContext, phase: MotionPhase) -> list[MotionPhase]:
    """A phase, and the phase of the same actor right before it, whose speed continues."""
    before = [
        other
        for other in phases_of(context, phase.actor)
        if other is not phase and other.start <= phase.start and phase.start - 1 <= other.end <= phase.start
    ]
    return [phase, *before]


# Tunnels


def _colliders(context: RuleContext, actor: str) -> list[str]:
    """What an actor must not pass through: grounds, colliders, and static objects that it is declared to touch."""
    objects = {planned.name: planned for planned in context.planned.objects}
    if actor in objects and objects[actor].role in _WITHOUT_SURFACE:
        return []
    touched = set[str]()
    for contact in declared_contacts(context):
        logical_objects = [context.structure.logical_object_of(node) for node in (contact.a, contact.b)]
        names = {thing.name for thing in logical_objects if thing is not None}
        if actor in names:
            touched |= names
    embedded = {
        frozenset(node.partition("/")[0] for node in relation.nodes)
        for relation in context.planned.relations
        if isinstance(relation, EmbeddedIn)
    }
    return [
        name
        for name, planned in objects.items()
        if name != actor and frozenset((name, actor)) not in embedded and _stops(planned, touched)
    ]


def _stops(planned: PlannedObject, touched: set[str]) -> bool:
    return (
        planned.role in {"ground", "collider"}
        or GROUND in planned.systems
        or (planned.role == "static" and planned.name in touched)
    )


def _passage(context: RuleContext, actor: str, collider: str) -> PassageRequest | None:
    own, other = mesh_names(context, actor), mesh_names(context, collider)
    if not own or not other:
        return None
    phases = phases_of(context, actor)
    tolerances = context.tolerances
    most = max(tolerances.penetration, tolerances.tunnel_share * smallest_dimension(context, own, other))
    allowed = allowed_crossings(context)
    is_declared = any(frozenset((one, two)) in allowed for one in own for two in other)
    return PassageRequest(own, other, phases[0].start, max(phase.end for phase in phases), most, is_declared)


def _tunnels(context: RuleContext, measures: Measures, actor: str) -> Iterator[Finding]:
    for collider in _colliders(context, actor):
        request = _passage(context, actor, collider)
        try:
            if request is None:
                missing = collider if mesh_names(context, actor) else actor
                raise Unmeasured(f"{missing!r} has no mesh")
            passage = measures[request]
        except Unmeasured as reason:
            yield T6.undecided((actor, collider), reason)
            continue
        if passage.depth > request.beyond:
            depth = f"{passage.depth:.3f} m"
            what, into = _with_meshes(request, passage, actor, collider)
            how = (
                f"passes through {into} within a frame and ends {depth} behind its surface."
                if passage.through
                else f"gets {depth} deep into {into}."
            )
            yield T6.finding(
                (actor, collider),
                f"{what} {how}",
                fix=into_collider(context, actor)
                or "Give both a fitting collision shape, make the collider thicker, or simulate more substeps; then "
                "bake again.",
                frame=passage.frame,
                measured=passage.depth,
                tolerance=request.beyond,
                unit="m",
                at=passage.at,
            )


def _with_meshes(
    request: PassageRequest, passage: PassageMeasure, actor: str, collider: str
) -> tuple[str, str]:
    """Actor and collider in words; of one that has several meshes, with that which it happens to."""
    meshes = passage.pair or (None, None)
    actor_words, collider_words = (
        f"{name!r} ({mesh!r})" if mesh is not None and len(members) > 1 else repr(name)
        for name, mesh, members in zip((actor, collider), meshes, (request.a, request.b), strict=True)
    )
    return actor_words, collider_words


T6 = Rule(
    "T6",
    "plausibility",
    "hard",
    "Falls have the acceleration of gravity; nothing passes through a ground or collider; no step is larger than 1.5 "
    "times the top planned speed.",
    "Floating falls, objects that sink through the floor, and jumps are what viewers notice first in a faked motion.",
    "Simulate the motion instead of keyframing it, with colliders that fit and enough substeps, and bake.",
    _judge,
    _requests,
    needs_plan=True,
    tolerances=(
        "gravity_share",
        "tunnel_share",
        "penetration",
        "jump",
        *CONTACT,
        "moving_share",
    ),
)
RULES = (T6,)
