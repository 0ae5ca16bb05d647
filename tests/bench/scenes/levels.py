"""The difficulty level of a scene, derived from what its spec requires (paper, "Benchmark Details").

D1: one solver actor with default features. D2: more within the category: several solver actors, or advanced features
of a solver. D3: solvers of two or more categories. Static scenes: D1 is a room, D2 an outdoor place.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.audit.predicates.catalogue import PREDICATES

if TYPE_CHECKING:
    from bench.scenes.spec import Level, Spec

SOLVER_GROUPS = {
    "cloth": "cloth",
    "fluid": "fluid",
    "rigid": "rigid body",
    "particle": "particle",
    "soft": "soft body",
}
# Advanced features of a solver: with one of them, a single actor makes a scene D2.
INNER = frozenset({
    "cloth_self_collision", "cloth_pin_group", "fluid_dynamic_effector", "fluid_guiding", "rigid_constraint",
    "rigid_constraint_no_collision", "particle_from_deformed", "particle_force_fields", "soft_goal_group",
})  # fmt: skip
_SOLVED = ("cloth", "soft", "fluid_domain", "rigid_active", "particle_emitter", "particle_hair")
# From so many bodies on, an actor is a chain of events.
_CHAIN = 10
# Metres: something in an outdoor place is at least as long; nothing in a room is.
_PLACE = 15.0


def solver_groups(spec: Spec) -> frozenset[str]:
    """Groups of the solvers that the spec's actors need."""
    groups = {PREDICATES[check.predicate].group for actor in spec.actors for check in actor.must_have}
    return frozenset(groups & set(SOLVER_GROUPS.values()))


def level_of(spec: Spec) -> Level:
    """The level that follows from a spec's checks, whose predicates must be known."""
    if spec.category == "static":
        spans = [actor.hints.size[0] for actor in spec.actors if actor.hints.size]
        return "D2" if max(spans, default=0.0) >= _PLACE else "D1"
    if len(solver_groups(spec)) > 1:
        return "D3"
    return "D2" if _has_several(spec) or _has_advanced_feature(spec) else "D1"


def _has_several(spec: Spec) -> bool:
    """Several solver actors, flows or a long chain of bodies."""
    solved = [actor for actor in spec.actors if actor.role in _SOLVED]
    flows = sum(actor.count for actor in spec.actors if actor.role == "fluid_flow")
    counted = [
        int(check.params.get("min", 1))
        for actor in spec.actors
        for check in actor.must_have
        if check.predicate == "fluid_flow_count"
    ]
    return len(solved) > 1 or max((flows, *counted)) > 1 or any(actor.count >= _CHAIN for actor in solved)


def _has_advanced_feature(spec: Spec) -> bool:
    """Self-collision, pins, goals, constraints, fields, guides, effectors that move."""
    predicates = {check.predicate for actor in spec.actors for check in actor.must_have}
    return bool(predicates & INNER) or any(actor.role == "force" for actor in spec.actors)
