"""The 42 predicates, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bench.audit.predicates import anti_cheat, cloth, fluid, particle, rigid, shared_readings, soft, universal
from bench.audit.predicates.predicate import Group, Params, Predicate, Scope, Stage, Unit, Verdict

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator


class _Rows:
    """One group's rows."""

    def __init__(self, group: Group) -> None:
        self._group: Group = group

    def __call__(
        self,
        judge: Callable[[Unit, Stage, Any], Verdict],
        params: type[Params] = Params,
        scope: Scope = "unit",
    ) -> Predicate:
        """A row, called as its function is."""
        return Predicate(judge.__name__, self._group, judge, params, scope)


def _rows() -> Iterator[Predicate]:
    row = _Rows("universal")
    yield row(universal.renderable)
    yield row(universal.solver_enabled)
    row = _Rows("cloth")
    yield row(cloth.cloth_modifier)
    yield row(cloth.cloth_cache_baked)
    yield row(cloth.cloth_self_collision)
    yield row(cloth.cloth_pin_group)
    yield row(cloth.cloth_collision_partners, shared_readings.Partners)
    row = _Rows("fluid")
    yield row(fluid.fluid_modifier)
    yield row(fluid.fluid_type, fluid.FluidType)
    yield row(fluid.fluid_domain_exists, fluid.DomainKind)
    yield row(fluid.fluid_flow_count, fluid.Flows, "scene")
    yield row(fluid.fluid_cache_baked)
    yield row(fluid.fluid_dynamic_effector)
    yield row(fluid.fluid_guiding)
    yield row(fluid.fluid_resolution, fluid.Resolution)
    yield row(fluid.fluid_mesh)
    row = _Rows("rigid body")
    yield row(rigid.rigid_settings)
    yield row(rigid.rigid_type, rigid.BodyType)
    yield row(rigid.rigid_shape, rigid.Shapes)
    yield row(rigid.rigid_world_populated, shared_readings.Least, "scene")
    yield row(rigid.rigid_cache_baked, scope="scene")
    yield row(rigid.rigid_constraint, rigid.Tie)
    yield row(rigid.rigid_constraint_no_collision, rigid.Tie)
    yield row(rigid.rigid_collision_modifier)
    yield row(rigid.rigid_positive_mass, rigid.Mass)
    row = _Rows("particle")
    yield row(particle.particle_system)
    yield row(particle.particle_type, particle.SystemType)
    yield row(particle.particle_source, particle.Source)
    yield row(particle.particle_cache_baked)
    yield row(particle.particle_collision_partners, shared_readings.Partners)
    yield row(particle.particle_from_deformed, particle.Deformer)
    yield row(particle.particle_force_fields, particle.Fields)
    row = _Rows("soft body")
    yield row(soft.soft_modifier)
    yield row(soft.soft_cache_baked)
    yield row(soft.soft_collision_partners, shared_readings.Partners)
    yield row(soft.soft_goal_group)
    yield row(soft.soft_rigid_partners, shared_readings.Partners)
    row = _Rows("anti-cheat")
    yield row(anti_cheat.dense_transform_keys)
    yield row(anti_cheat.animated_shape_keys)
    yield row(anti_cheat.static_has_cache, scope="scene")
    yield row(anti_cheat.static_has_rigid_world, scope="scene")
    yield row(anti_cheat.static_has_solver, scope="scene")


def by_name(rows: Iterable[Predicate]) -> dict[str, Predicate]:
    """Name → row, in the table's order. Raises ValueError for a name that is there twice."""
    found: dict[str, Predicate] = {}
    for row in rows:
        if row.name in found:
            raise ValueError(f"two predicates are called {row.name}")
        found[row.name] = row
    return found


PREDICATES = by_name(_rows())
