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
# A MESH shape has no inside: moving bodies sink into it and fall through.
_SOLID = ("BOX", "SPHERE", "CAPSULE", "CYLINDER", "CONE", "CONVEX_HULL", "COMPOUND")

Shape = Literal["BOX", "SPHERE", "CAPSULE", "CYLINDER", "CONE", "CONVEX_HULL", "MESH", "COMPOUND"]
TieType = Literal[
    "FIXED", "POINT", "HINGE", "SLIDER", "PISTON", "GENERIC", "GENERIC_SPRING", "MOTOR",
]  # fmt: skip


class BodyType(Params):
    """``type``: ACTIVE or PASSIVE."""

    type: Literal["ACTIVE", "PASSIVE"] = "ACTIVE"


class Shapes(Params):
    """``shapes``: the accepted ones; an empty list: any for a passive body, any but MESH for an active one."""

    shapes: tuple[Shape, ...] = ()


class Mass(Params):
    """``min``, ``max``: kilograms."""

    min: float | None = Field(default=None, gt=0)
    max: float | None = Field(default=None, gt=0)


class Tie(Params):
    """``type``: one of Blender's, or a list of accepted ones (None: any).

    ``partners``: actors of which one must be at the other end. ``min``: how many constraints at least.
    """

    type: TieType | tuple[TieType, ...] | None = None
    partners: tuple[str, ...] = ()
    min: int = Field(default=1, ge=1)


def _bodies(unit: Unit) -> Iterator[tuple[Object, RigidBody]]:
    for one in unit.objects:
        if one.rigid_body is not None:
            yield one, one.rigid_body


def rigid_settings(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The actor is a rigid body: one of its objects has rigid-body settings and is in the collection of the scene's
    rigid-body world. Outside that world, the settings have no effect.
    """
    del stage, params
    found = {one.name: body.in_world for one, body in _bodies(unit)}
    return judged(any(found.values()), in_world=dict(sorted(found.items())[:8]))


def rigid_type(unit: Unit, stage: Stage, params: BodyType) -> Verdict:
    """The actor has the right part in the simulation: one of its objects is a rigid body of the required type. An
    ACTIVE body that is animated (kinematic) at the start and never released is moved by keys and does not count; a
    release is an animated Animated setting.
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
    """The actor collides with the right shape: one of its rigid bodies has an accepted collision shape. If none is
    given, an active body needs a solid one (any but MESH, which has no inside to push other bodies out of); a passive
    body may have any.
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
    """The rigid-body world's motion is baked: its point cache is marked as baked, its range covers 95 % of the scene's
    frames and of the clip's minimum length, and it holds 95 % of the frames of its own range. The outdated mark is
    ignored: Blender sets it on every rigid-body world when it opens a file.
    """
    del unit, params
    world = stage.scene.rigid_world
    if world is None:
        return judged(False, world=False)
    return judged(is_filled(world.cache, stage), **cache_seen(world.cache, stage))


def rigid_constraint(unit: Unit, stage: Stage, params: Tie) -> Verdict:
    """The actor is connected to another body: at least ``min`` rigid-body constraints are on the actor or name it, are
    enabled, in the world and of a required type, and have rigid bodies of the world at both ends, one of them a
    partner's if partners are given. A constraint with a missing end connects nothing.
    """
    ties = _ties(unit, stage, params)
    return judged(len(ties) >= params.min, ties=[_tie_seen(*tie) for tie in ties][:8], min=params.min)


def rigid_constraint_no_collision(unit: Unit, stage: Stage, params: Tie) -> Verdict:
    """The actor's constraints keep the connected bodies from colliding with each other: there is at least one
    constraint that counts for rigid_constraint, and all of them have collisions disabled. Otherwise, bodies that
    overlap at a joint are thrown apart.
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
    """Cloth, soft bodies and particles collide with the rigid body: one of the actor's rigid bodies also has a
    COLLISION modifier that is on. These solvers ignore the rigid-body world.
    """
    del stage, params
    found = {one.name: collides(one) for one, _ in _bodies(unit)}
    return judged(any(found.values()), collision=dict(sorted(found.items())[:8]))


def rigid_positive_mass(unit: Unit, stage: Stage, params: Mass) -> Verdict:
    """The rigid body has a mass: one has a mass above a gram, and within ``min`` and ``max`` if they are given. A gram
    is the least mass that Blender stores, and what it turns zero into.
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
