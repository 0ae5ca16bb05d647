"""Predicates for actors of every kind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bench.audit.facts import GEOMETRY, SOLVERS
from bench.audit.predicates.predicate import PredicateVerdict, verdict_of
from bench.audit.predicates.shared_readings import blows
from bench.audit.roles import UNMARKED, modifiers_of_role, plays

if TYPE_CHECKING:
    from bench.audit.facts import Object
    from bench.audit.predicates.predicate import AuditContext, PredicateParams, Unit


def renderable(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The actor can be seen in a render: at least one of its objects is geometry or instances a collection, is not
    hidden in renders (by itself, its collections, its view layer or its ray visibility), and has something to show:
    faces, particles, or bounds with an extent. Whether the camera sees it is left to the judge.
    """
    del params
    visible = [obj for obj in unit.objects if obj.renders and _has_substance(obj, context)]
    return verdict_of(visible, shown=[obj.name for obj in visible][:8], objects=len(unit.objects))


def _has_substance(obj: Object, context: AuditContext) -> bool:
    if obj.instances is not None:
        return bool(
            next(
                (
                    collection.objects
                    for collection in context.scene.collections
                    if collection.name == obj.instances
                ),
                (),
            )
        )
    return obj.type in GEOMETRY and (
        obj.faces > 0 or obj.diagonal > 0 or bool(obj.of_type("PARTICLE_SYSTEM"))
    )


def solver_enabled(unit: Unit, context: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """The actor's solver is on in the viewport and in renders: every modifier of its role (for a role without
    modifiers, every solver modifier) is shown in both, since a solver that is off in one of them gives a different
    film. A rigid body and its world must be enabled. A force field must have a strength that is not zero or is
    animated. An actor without a solver fails, unless its role needs none: then this does not apply.
    """
    del params
    seen: dict[str, Any] = {}
    states: list[bool] = []
    for obj in unit.objects:
        role_modifiers = modifiers_of_role(obj, unit.role)
        for modifier in role_modifiers or (obj.of_type(*SOLVERS) if unit.role in UNMARKED else ()):
            seen[f"{obj.name}: {modifier.name}"] = {
                "viewport": modifier.show_viewport,
                "render": modifier.show_render,
            }
            states.append(modifier.on)
        if unit.role.startswith("rigid_") and plays(obj, unit.role) and obj.rigid_body is not None:
            world = context.scene.rigid_world
            on = obj.rigid_body.enabled and world is not None and world.enabled
            seen[f"{obj.name}: rigid body"] = {"enabled": on}
            states.append(on)
    if unit.role == "force":
        states += [blows(obj) for obj in unit.objects if obj.force is not None]
    if not states and unit.role in UNMARKED:
        return PredicateVerdict("not_applicable", {"role": unit.role})
    return verdict_of(states and all(states), solvers=dict(sorted(seen.items())[:8]))
