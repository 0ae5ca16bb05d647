"""Rigid bodies: settings, the world and its cache, constraints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from bench.audit.predicates.predicate import Params, Verdict, judged
from bench.audit.predicates.shared_readings import admits, cache_seen, collides, is_filled, number

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.facts import Object, RigidBody, RigidConstraint
    from bench.audit.predicates.predicate import Stage, Unit
    from bench.audit.predicates.shared_readings import Least

# Blender keeps masses from falling below a gram: that is what a mass that was set to nothing reads.
_NO_MASS = 0.00101
# A mesh as shape has no inside: bodies that move fall into each other, and through it.
_SOLID = ("BOX", "SPHERE", "CAPSULE", "CYLINDER", "CONE", "CONVEX_HULL", "COMPOUND")

Shape = Literal["BOX", "SPHERE", "CAPSULE", "CYLINDER", "CONE", "CONVEX_HULL", "MESH", "COMPOUND"]
TieType = Literal[
    "FIXED", "POINT", "HINGE", "SLIDER", "PISTON", "GENERIC", "GENERIC_SPRING", "MOTOR",
]  # fmt: skip


class BodyType(Params):
    """``type``: ACTIVE or PASSIVE."""

    type: Literal["ACTIVE", "PASSIVE"] = "ACTIVE"


class Shapes(Params):
    """``shapes``: those that will do; of none, all for a passive body, all but MESH for an active one."""

    shapes: tuple[Shape, ...] = ()


class Mass(Params):
    """``min``, ``max``: kilograms."""

    min: float | None = Field(default=None, gt=0)
    max: float | None = Field(default=None, gt=0)


class Tie(Params):
    """``type``: one of Blender's, or several that will do (None: any).

    ``partners``: actors that one end must be of. ``min``: how many ties.
    """

    type: TieType | tuple[TieType, ...] | None = None
    partners: tuple[str, ...] = ()
    min: int = Field(default=1, ge=1)


def _bodies(unit: Unit) -> Iterator[tuple[Object, RigidBody]]:
    for one in unit.objects:
        if one.rigid_body is not None:
            yield one, one.rigid_body


def rigid_settings(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The actor is a rigid body: one of its objects has rigid-body settings and belongs to the collection of the
    scene's rigid-body world. Settings outside of a world simulate nothing.
    """
    del stage, params
    found = {one.name: body.in_world for one, body in _bodies(unit)}
    return judged(any(found.values()), in_world=dict(sorted(found.items())[:8]))


def rigid_type(unit: Unit, stage: Stage, params: BodyType) -> Verdict:
    """The actor takes the part in the simulation that it should: one of its objects is a rigid body of the type asked
    for. An ACTIVE one that is animated (kinematic) at the clip's start and never let go is moved by keys, and does
    not count; whether it is let go shows in an animated switch.
    """
    del stage
    found = {one.name: body.type for one, body in _bodies(unit)}
    fits = [
        one.name
        for one, body in _bodies(unit)
        if body.type == params.type and not (params.type == "ACTIVE" and body.kinematic and not _let_go(one))
    ]
    return judged(fits, types=dict(sorted(found.items())[:8]), fit=fits[:8])


def _let_go(one: Object) -> bool:
    return any(channel.path == "rigid_body.kinematic" and channel.varies for channel in one.channels)


def rigid_shape(unit: Unit, stage: Stage, params: Shapes) -> Verdict:
    """The actor collides as the thing that it is: one of its rigid bodies has a collision shape of those asked for.
    Where none are named, an active body must have a solid one (anything but MESH, whose faces have no inside for
    others to be pushed out of); a passive body may have any.
    """
    del stage
    found = {one.name: body.shape for one, body in _bodies(unit)}
    fits = any(
        body.shape in params.shapes if params.shapes else body.type == "PASSIVE" or body.shape in _SOLID
        for _, body in _bodies(unit)
    )
    return judged(fits, shapes=dict(sorted(found.items())[:8]))


def rigid_world_populated(unit: Unit, stage: Stage, params: Least) -> Verdict:
    """There is a rigid-body world, it is enabled, and its collection holds at least ``min`` objects of the scene with
    rigid-body settings. A world without bodies simulates nothing.
    """
    del unit
    world = stage.scene.rigid_world
    bodies = [
        one.name for one in stage.scene.objects if one.rigid_body is not None and one.rigid_body.in_world
    ]
    enabled = world is not None and world.enabled
    return judged(enabled and len(bodies) >= params.min, enabled=enabled, bodies=len(bodies), min=params.min)


def rigid_cache_baked(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The motion of the rigid-body world is kept: its point cache is marked as baked, its range covers 95 % of the
    scene's frames and of the least length of the clip, and it holds 95 % of the frames of its own range. That Blender
    calls it outdated says nothing: it does so of every such world when its file is opened.
    """
    del unit, params
    world = stage.scene.rigid_world
    if world is None:
        return judged(False, world=False)
    return judged(is_filled(world.cache, stage), **cache_seen(world.cache, stage))


def rigid_constraint(unit: Unit, stage: Stage, params: Tie) -> Verdict:
    """The actor is tied to another body: at least ``min`` rigid-body constraints that are enabled, in the world and
    of the type asked for stand on it or name it, and both their ends are rigid bodies of the world; one end is a
    partner's where partners are named. A constraint with an end missing ties nothing.
    """
    ties = _ties(unit, stage, params)
    return judged(len(ties) >= params.min, ties=[_tie_seen(*tie) for tie in ties][:8], min=params.min)


def rigid_constraint_no_collision(unit: Unit, stage: Stage, params: Tie) -> Verdict:
    """What ties the actor keeps the two bodies from colliding with each other: all constraints that count for
    rigid_constraint have their collisions disabled, and there is one. Bodies that overlap at a joint would else be
    thrown apart.
    """
    ties = _ties(unit, stage, params)
    disabled = [tie.disable_collisions for _, tie in ties]
    return judged(ties and all(disabled), ties=[_tie_seen(*tie) for tie in ties][:8])


def _ties(unit: Unit, stage: Stage, params: Tie) -> list[tuple[str, RigidConstraint]]:
    bodies = {
        one.name for one in stage.scene.objects if one.rigid_body is not None and one.rigid_body.in_world
    }
    found: list[tuple[str, RigidConstraint]] = []
    for one in stage.scene.objects:
        tie = one.rigid_constraint
        if tie is None or not (tie.enabled and tie.in_world) or not admits(params.type, tie.type):
            continue
        ends = {tie.first, tie.second}
        if len(ends) == 2 and ends <= bodies and (one.name in unit.names or ends & unit.names):
            found.append((one.name, tie))
    if not params.partners:
        return found
    theirs = {one.name for name in params.partners for one in stage.named(name)}
    return [
        (name, tie)
        for name, tie in found
        if ({tie.first, tie.second} - unit.names) & theirs
        or (name in unit.names and {tie.first, tie.second} & theirs)
    ]


def _tie_seen(name: str, tie: RigidConstraint) -> dict[str, object]:
    return {
        "name": name,
        "type": tie.type,
        "ends": [tie.first, tie.second],
        "disable_collisions": tie.disable_collisions,
    }


def rigid_collision_modifier(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The rigid body can be felt by cloth, soft bodies and particles: one of its objects that is a rigid body also
    carries a COLLISION modifier that is on. Deforming solvers know nothing of the rigid-body world.
    """
    del stage, params
    found = {one.name: collides(one) for one, _ in _bodies(unit)}
    return judged(any(found.values()), collision=dict(sorted(found.items())[:8]))


def rigid_positive_mass(unit: Unit, stage: Stage, params: Mass) -> Verdict:
    """The rigid body weighs something: one has a mass above a gram, within ``min`` and ``max`` where they are given.
    A gram is the least that Blender keeps, and what a mass of zero turns into.
    """
    del stage
    found = {one.name: number(body.mass) for one, body in _bodies(unit)}
    fits = any(
        body.mass > _NO_MASS
        and (params.min is None or body.mass >= params.min)
        and (params.max is None or body.mass <= params.max)
        for _, body in _bodies(unit)
    )
    return judged(fits, mass=dict(sorted(found.items())[:8]))
