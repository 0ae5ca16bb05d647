"""The 42 predicates, by name."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from bench.audit.predicates import anti_cheat, cloth, fluid, particle, rigid, shared_readings, soft, universal
from bench.audit.predicates.predicate import (
    AuditContext,
    Group,
    Predicate,
    PredicateParams,
    PredicateVerdict,
    Scope,
    Unit,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator


def _row(
    group: Group,
    judge: Callable[[Unit, AuditContext, Any], PredicateVerdict],
    params: type[PredicateParams] = PredicateParams,
    scope: Scope = "unit",
) -> Predicate:
    """A predicate with the name of its function."""
    return Predicate(judge.__name__, group, judge, params, scope)


def _rows() -> Iterator[Predicate]:
    row = partial(_row, "universal")
    yield row(universal.renderable)
    yield row(universal.solver_enabled)
    row = partial(_row, "cloth")
    yield row(cloth.cloth_modifier)
    yield row(cloth.cloth_cache_baked)
    yield row(cloth.cloth_self_collision)
    yield row(cloth.cloth_pin_group)
    yield row(cloth.cloth_collision_partners, shared_readings.Partners)
    row = partial(_row, "fluid")
    yield row(fluid.fluid_modifier)
    yield row(fluid.fluid_type, fluid.FluidType)
    yield row(fluid.fluid_domain_exists, fluid.DomainKind)
    yield row(fluid.fluid_flow_count, fluid.FlowCount, "scene")
    yield row(fluid.fluid_cache_baked)
    yield row(fluid.fluid_dynamic_effector)
    yield row(fluid.fluid_guiding)
    yield row(fluid.fluid_resolution, fluid.MinResolution)
    yield row(fluid.fluid_mesh)
    row = partial(_row, "rigid body")
    yield row(rigid.rigid_settings)
    yield row(rigid.rigid_type, rigid.BodyType)
    yield row(rigid.rigid_shape, rigid.CollisionShapes)
    yield row(rigid.rigid_world_populated, shared_readings.MinCount, "scene")
    yield row(rigid.rigid_cache_baked, scope="scene")
    yield row(rigid.rigid_constraint, rigid.ConstraintParams)
    yield row(rigid.rigid_constraint_no_collision, rigid.ConstraintParams)
    yield row(rigid.rigid_collision_modifier)
    yield row(rigid.rigid_positive_mass, rigid.MassRange)
    row = partial(_row, "particle")
    yield row(particle.particle_system)
    yield row(particle.particle_type, particle.SystemType)
    yield row(particle.particle_source, particle.ParticleSource)
    yield row(particle.particle_cache_baked)
    yield row(particle.particle_collision_partners, shared_readings.Partners)
    yield row(particle.particle_from_deformed, particle.Deformer)
    yield row(particle.particle_force_fields, particle.FieldCount)
    row = partial(_row, "soft body")
    yield row(soft.soft_modifier)
    yield row(soft.soft_cache_baked)
    yield row(soft.soft_collision_partners, shared_readings.Partners)
    yield row(soft.soft_goal_group)
    yield row(soft.soft_rigid_partners, shared_readings.Partners)
    row = partial(_row, "anti-cheat")
    yield row(anti_cheat.dense_transform_keys)
    yield row(anti_cheat.animated_shape_keys)
    yield row(anti_cheat.static_has_cache, scope="scene")
    yield row(anti_cheat.static_has_rigid_world, scope="scene")
    yield row(anti_cheat.static_has_solver, scope="scene")


def by_name(rows: Iterable[Predicate]) -> dict[str, Predicate]:
    """Name → row, in the table's order. Raises ValueError for a name that is there twice."""
    predicates: dict[str, Predicate] = {}
    for row in rows:
        if row.name in predicates:
            raise ValueError(f"two predicates are called {row.name}")
        predicates[row.name] = row
    return predicates


PREDICATES = by_name(_rows())
