"""Rigid bodies: settings, the world and its cache, constraints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from bench.audit.predicates.predicate import PredicateParams, PredicateVerdict, verdict_of
from bench.audit.predicates.shared_readings import admits, cache_seen, collides, is_filled, number

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.facts import Object, RigidBody, RigidConstraint
    from bench.audit.predicates.predicate import AuditContext, Unit
    from bench.audit.predicates.shared_readings import MinCount

# Blender keeps masses from falling below a gram: that is what a mass that was set to nothing reads.
_NO_MASS = 0.00101
# A MESH shape has no inside: moving bodies sink into it and fall through.
_SOLID_SHAPES = ("BOX", "SPHERE", "CAPSULE", "CYLINDER", "CONE", "CONVEX_HULL", "COMPOUND")

Shape = Literal["BOX", "SPHERE", "CAPSULE", "CYLINDER", "CONE", "CONVEX_HULL", "MESH", "COMPOUND"]
ConstraintType = Literal[
    "FIXED", "POINT", "HINGE", "SLIDER", "PISTON", "GENERIC", "GENERIC_SPRING", "MOTOR",
]  # fmt: skip


class BodyType(PredicateParams):
    """``type``: ACTIVE or PASSIVE."""

    type: Literal["ACTIVE", "PASSIVE"] = "ACTIVE"


class CollisionShapes(PredicateParams):
    """``shapes``: the accepted ones; an empty list: any for a passive body, any but MESH for an active one."""

    shapes: tuple[Shape, ...] = ()


class MassRange(PredicateParams):
    """``min``, ``max``: kilograms."""

    min: float | None = Field(default=None, gt=0)
    max: float | None = Field(default=None, gt=0)


class ConstraintParams(PredicateParams):
    """``type``: one of Blender's, or a list of accepted ones (None: any).

    ``partners``: actors of which one must be at the other end. ``min``: how many constraints at least.
    """

    type: ConstraintType | tuple[ConstraintType, ...] | None = None
    partners: tuple[str, ...] = ()
    min: int = Field(default=1, ge=1)


def _bodies(unit: Unit) -> Iterator[tuple[Object, RigidBody]]:
    for obj in unit.objects:
        if obj.rigid_body is not None:
            yield obj, obj.rigid_body


def rigid_settings(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The actor is a rigid body: one of its objects has rigid-body settings and is in the collection of the scene's
    rigid-body world. Outside that world, the settings have no effect.
    """
    del context, params
    in_world = {obj.name: body.in_world for obj, body in _bodies(unit)}
    return verdict_of(any(in_world.values()), in_world=dict(sorted(in_world.items())[:8]))


def rigid_type(unit: Unit, context: AuditContext, params: BodyType) -> PredicateVerdict:
    """The actor has the right part in the simulation: one of its objects is a rigid body of the required type. An
    ACTIVE body that is animated (kinematic) at the start and never released is moved by keys and does not count; a
    release is an animated Animated setting.
    """
    del context
    types = {obj.name: body.type for obj, body in _bodies(unit)}
    fits = [
        obj.name
        for obj, body in _bodies(unit)
        if body.type == params.type and not (params.type == "ACTIVE" and body.kinematic and not _let_go(obj))
    ]
    return verdict_of(fits, types=dict(sorted(types.items())[:8]), fit=fits[:8])


def _let_go(obj: Object) -> bool:
    return any(channel.path == "rigid_body.kinematic" and channel.varies for channel in obj.channels)


def rigid_shape(unit: Unit, context: AuditContext, params: CollisionShapes) -> PredicateVerdict:
    """The actor collides with the right shape: one of its rigid bodies has an accepted collision shape. If none is
    given, an active body needs a solid one (any but MESH, which has no inside to push other bodies out of); a passive
    body may have any.
    """
    del context
    shapes = {obj.name: body.shape for obj, body in _bodies(unit)}
    fits = any(
        body.shape in params.shapes
        if params.shapes
        else body.type == "PASSIVE" or body.shape in _SOLID_SHAPES
        for _, body in _bodies(unit)
    )
    return verdict_of(fits, shapes=dict(sorted(shapes.items())[:8]))


def rigid_world_populated(unit: Unit, context: AuditContext, params: MinCount) -> PredicateVerdict:
    """There is a rigid-body world, it is enabled, and its collection holds at least ``min`` objects of the scene with
    rigid-body settings. A world without bodies simulates nothing.
    """
    del unit
    world = context.scene.rigid_world
    bodies = [
        obj.name for obj in context.scene.objects if obj.rigid_body is not None and obj.rigid_body.in_world
    ]
    enabled = world is not None and world.enabled
    return verdict_of(
        enabled and len(bodies) >= params.min, enabled=enabled, bodies=len(bodies), min=params.min
    )


def rigid_cache_baked(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The rigid-body world's motion is baked: its point cache is marked as baked, its range covers 95 % of the scene's
    frames and of the clip's minimum length, and it holds 95 % of the frames of its own range. The outdated mark is
    ignored: Blender sets it on every rigid-body world when it opens a file.
    """
    del unit, params
    world = context.scene.rigid_world
    if world is None:
        return verdict_of(False, world=False)
    return verdict_of(is_filled(world.cache, context), **cache_seen(world.cache, context))


def rigid_constraint(unit: Unit, context: AuditContext, params: ConstraintParams) -> PredicateVerdict:
    """The actor is connected to another body: at least ``min`` rigid-body constraints are on the actor or name it, are
    enabled, in the world and of a required type, and have rigid bodies of the world at both ends, one of them a
    partner's if partners are given. A constraint with a missing end connects nothing.
    """
    constraints = _constraints(unit, context, params)
    return verdict_of(
        len(constraints) >= params.min,
        ties=[_constraint_seen(*constraint) for constraint in constraints][:8],
        min=params.min,
    )


def rigid_constraint_no_collision(
    unit: Unit, context: AuditContext, params: ConstraintParams
) -> PredicateVerdict:
    """The actor's constraints keep the connected bodies from colliding with each other: there is at least one
    constraint that counts for rigid_constraint, and all of them have collisions disabled. Otherwise, bodies that
    overlap at a joint are thrown apart.
    """
    constraints = _constraints(unit, context, params)
    disabled = [constraint.disable_collisions for _, constraint in constraints]
    return verdict_of(
        constraints and all(disabled), ties=[_constraint_seen(*constraint) for constraint in constraints][:8]
    )


def _constraints(
    unit: Unit, context: AuditContext, params: ConstraintParams
) -> list[tuple[str, RigidConstraint]]:
    bodies = {
        obj.name for obj in context.scene.objects if obj.rigid_body is not None and obj.rigid_body.in_world
    }
    constraints: list[tuple[str, RigidConstraint]] = []
    for obj in context.scene.objects:
        constraint = obj.rigid_constraint
        if (
            constraint is None
            or not (constraint.enabled and constraint.in_world)
            or not admits(params.type, constraint.type)
        ):
            continue
        ends = {constraint.first, constraint.second}
        if len(ends) == 2 and ends <= bodies and (obj.name in unit.names or ends & unit.names):
            constraints.append((obj.name, constraint))
    if not params.partners:
        return constraints
    partner_objects = {obj.name for name in params.partners for obj in context.named(name)}
    return [
        (name, constraint)
        for name, constraint in constraints
        if ({constraint.first, constraint.second} - unit.names) & partner_objects
        or (name in unit.names and {constraint.first, constraint.second} & partner_objects)
    ]


def _constraint_seen(name: str, constraint: RigidConstraint) -> dict[str, object]:
    return {
        "name": name,
        "type": constraint.type,
        "ends": [constraint.first, constraint.second],
        "disable_collisions": constraint.disable_collisions,
    }


def rigid_collision_modifier(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """Cloth, soft bodies and particles collide with the rigid body: one of the actor's rigid bodies also has a
    COLLISION modifier that is on. These solvers ignore the rigid-body world.
    """
    del context, params
    collision = {obj.name: collides(obj) for obj, _ in _bodies(unit)}
    return verdict_of(any(collision.values()), collision=dict(sorted(collision.items())[:8]))


def rigid_positive_mass(unit: Unit, context: AuditContext, params: MassRange) -> PredicateVerdict:
    """The rigid body has a mass: one has a mass above a gram, and within ``min`` and ``max`` if they are given. A gram
    is the least mass that Blender stores, and what it turns zero into.
    """
    del context
    masses = {obj.name: number(body.mass) for obj, body in _bodies(unit)}
    fits = any(
        body.mass > _NO_MASS
        and (params.min is None or body.mass >= params.min)
        and (params.max is None or body.mass <= params.max)
        for _, body in _bodies(unit)
    )
    return verdict_of(fits, mass=dict(sorted(masses.items())[:8]))
