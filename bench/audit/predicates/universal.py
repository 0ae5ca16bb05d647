"""Predicates for actors of every kind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bench.audit.facts import GEOMETRY, SOLVERS
from bench.audit.predicates.predicate import Verdict, judged
from bench.audit.predicates.shared_readings import blows
from bench.audit.roles import UNMARKED, modifiers_of_role, plays

if TYPE_CHECKING:
    from bench.audit.facts import Object
    from bench.audit.predicates.predicate import Params, Stage, Unit


def renderable(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The actor can be seen in a render: at least one of its objects is geometry or instances a collection, is not
    hidden in renders (by itself, its collections, its view layer or its ray visibility), and has something to show:
    faces, particles, or bounds with an extent. Whether the camera sees it is left to the judge.
    """
    del params
    shown = [one for one in unit.objects if one.renders and _has_substance(one, stage)]
    return judged(shown, shown=[one.name for one in shown][:8], objects=len(unit.objects))


def _has_substance(one: Object, stage: Stage) -> bool:
    if one.instances is not None:
        return bool(
            next((each.objects for each in stage.scene.collections if each.name == one.instances), ())
        )
    return one.type in GEOMETRY and (
        one.faces > 0 or one.diagonal > 0 or bool(one.of_type("PARTICLE_SYSTEM"))
    )


def solver_enabled(unit: Unit, stage: Stage, params: Params) -> Verdict:
    """The actor's solver is on in the viewport and in renders: every modifier of its role (for a role without
    modifiers, every solver modifier) is shown in both, since a solver that is off in one of them gives a different
    film. A rigid body and its world must be enabled. A force field must have a strength that is not zero or is
    animated. An actor without a solver fails, unless its role needs none: then this does not apply.
    """
    del params
    seen: dict[str, Any] = {}
    states: list[bool] = []
    for one in unit.objects:
        own = modifiers_of_role(one, unit.role)
        for modifier in own or (one.of_type(*SOLVERS) if unit.role in UNMARKED else ()):
            seen[f"{one.name}: {modifier.name}"] = {
                "viewport": modifier.show_viewport,
                "render": modifier.show_render,
            }
            states.append(modifier.on)
        if unit.role.startswith("rigid_") and plays(one, unit.role) and one.rigid_body is not None:
            world = stage.scene.rigid_world
            on = one.rigid_body.enabled and world is not None and world.enabled
            seen[f"{one.name}: rigid body"] = {"enabled": on}
            states.append(on)
    if unit.role == "force":
        states += [blows(one) for one in unit.objects if one.force is not None]
    if not states and unit.role in UNMARKED:
        return Verdict("not_applicable", {"role": unit.role})
    return judged(states and all(states), solvers=dict(sorted(seen.items())[:8]))
