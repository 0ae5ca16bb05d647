"""What a simulation works with besides its actors: colliders, passive bodies, containers, force fields. Metres."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agents.plan.relations import Inside, StableAgainst, SupportedBy
from agents.protocol.judging.mechanisms import SOLVERS, solver_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.facts import ObjectFacts
    from agents.protocol.judging.mechanisms import Solver
    from agents.protocol.rule import RuleContext
    from agents.protocol.structure import LogicalObject

# (object, what is wrong with it, what to do)
_Problem = tuple[str, str, str]

_PASSIVE = "Make it a rigid body in the same world: passive if it stands still, kinematic if it is keyframed."
_COLLISION = "Give it a collision modifier, below the modifiers that shape it."
_EFFECTOR = "Make it an effector of the fluid (collision), with walls of two cells or more."
_COLLIDES = frozenset({"sim_cloth", "sim_soft", "sim_particle"})  # with what has a collision modifier
_NEED_STRENGTH = frozenset(
    {"FORCE", "WIND", "VORTEX", "TURBULENCE", "MAGNET", "HARMONIC", "CHARGE", "LENNARDJ"}
)


def setup_problems(context: RuleContext) -> Iterator[_Problem]:
    """What the plan has set up besides actors: force fields, colliders, joints, and the kind of each fluid."""
    if context.plan is None:
        return
    yield from _joint_problems(context)
    yield from _wrong_fluids(context)
    actors = [item for obj in context.structure.logical_objects for item in _actors(context, obj)]
    for planned in context.plan.objects:
        if planned.role == "force":
            yield from _force_problems(context, planned.name, actors)
        elif planned.role == "collider" and actors:
            obj = context.structure.by_name.get(planned.name)
            if obj is not None and not any(map(_takes_part, obj.members)):
                yield (
                    planned.name,
                    f"The planned collider {planned.name!r} takes part in no simulation.",
                    "Give it what its partners collide with: a collision modifier for cloth, soft bodies and "
                    "particles, a passive rigid body for rigid bodies, a fluid effector for fluids.",
                )


def _joint_problems(context: RuleContext) -> Iterator[_Problem]:
    """Planned joints that no rigid-body constraint makes, or that have no limits though limits are planned."""
    structure = context.structure
    for planned in context.planned.joints:
        sides = [
            {item.name for item in obj.members}
            if (obj := structure.by_name.get(name)) is not None
            else set[str]()
            for name in (planned.part, planned.host)
        ]
        made = [
            joint
            for joint in context.facts.joints
            if (joint.a in sides[0] and joint.b in sides[1]) or (joint.a in sides[1] and joint.b in sides[0])
        ]
        name = f"The planned {planned.kind} of {planned.part!r} and {planned.host!r}"
        if not made:
            yield (
                planned.part,
                f"{name} is missing.",
                "Add an Empty with a rigid-body constraint between a body of each, at the joint's place and turned so "
                "that its axis is the planned one.",
            )
        elif planned.limits is not None and not any(joint.limited for joint in made):
            yield planned.part, f"{name} has no limits.", "Switch on the constraint's limits, as planned."


def _wrong_fluids(context: RuleContext) -> Iterator[_Problem]:
    """Planned fluids whose domain is of the other kind: a gas for a liquid, or a liquid for smoke and fire."""
    for planned in context.planned.objects:
        obj = context.structure.by_name.get(planned.name)
        domains = [item for item in obj.meshes if item.is_fluid_domain] if obj is not None else []
        if planned.fluid_kind is None or not domains:
            continue
        is_gas = planned.fluid_kind != "liquid"
        if not any(item.is_gas == is_gas for item in domains):
            yield (
                planned.name,
                f"{planned.name!r} is planned as {planned.fluid_kind.replace('_', ' ')}, but its domain is of the kind "
                f"{'LIQUID' if is_gas else 'GAS'}.",
                f"Set the domain's type to {'GAS' if is_gas else 'LIQUID'}, and its flows' to match.",
            )


def _actors(context: RuleContext, obj: LogicalObject) -> list[ObjectFacts]:
    return [item for kind in SOLVERS for item in solver_of(context.structure, obj, kind).actors]


def _takes_part(item: ObjectFacts) -> bool:
    return item.has_modifier({"COLLISION", "FLUID_EFFECTOR"}) or _is_body(item)


def _is_body(item: ObjectFacts) -> bool:
    return item.rigid_body is not None and item.rigid_body.enabled


def _force_problems(context: RuleContext, name: str, actors: list[ObjectFacts]) -> Iterator[_Problem]:
    obj = context.structure.by_name.get(name)
    items = obj.members if obj is not None else tuple(filter(None, [context.structure.objects.get(name)]))
    field = next((item for item in items if item.force_field is not None), None)
    if field is None:
        yield (
            name,
            f"The planned force field {name!r} is missing.",
            "Add an object of that name with a force field, in a system of its own (physics).",
        )
        return
    if (
        field.force_strength == 0
        and field.force_field in _NEED_STRENGTH
        and not (field.keys or field.drivers)
    ):
        yield name, f"The force field {name!r} has no strength.", "Give it a strength."
    boxes = [actor.box for actor in actors if actor.box is not None]
    if field.force_reach is None or not boxes:
        return
    at = (field.matrix[3], field.matrix[7], field.matrix[11])
    nearest = min(
        math.hypot(
            *(
                max(low - place, 0.0, place - high)
                for place, low, high in zip(at, box.low, box.high, strict=True)
            )
        )
        for box in boxes
    )
    if nearest > field.force_reach:
        yield (
            name,
            f"The force field {name!r} ends {field.force_reach:.3g} m from its centre; the nearest simulated object is "
            f"{nearest:.3g} m away.",
            "Move it nearer, or raise its largest distance.",
        )


def missing_partners(context: RuleContext, obj: LogicalObject, solver: Solver) -> Iterator[_Problem]:
    """What an object rests on, leans on or is in, by the plan, but that takes no part in its simulation.

    A gas only begins on what its source stands on: a flue that stops the gas would choke it.
    """
    rises = any(actor.is_gas for actor in solver.actors)
    for relation in context.plan.relations if context.plan else ():
        if not isinstance(relation, (SupportedBy, StableAgainst, Inside)) or relation.nodes[0] != obj.name:
            continue
        if rises and not isinstance(relation, Inside):
            continue
        for node in relation.nodes[1:]:
            partner = context.structure.logical_object_of(node)
            if partner is None or partner.name == obj.name or _moves_otherwise(context, partner, solver):
                continue
            if fix := _missing(context, partner, solver):
                yield (
                    partner.name,
                    f"{partner.name!r} takes no part in the simulation of {obj.name!r}, which the plan has "
                    f"{'in' if isinstance(relation, Inside) else 'on or against'} it.",
                    fix,
                )


def _moves_otherwise(context: RuleContext, partner: LogicalObject, solver: Solver) -> bool:
    """Whether a partner is simulated itself, by another solver: how two solvers meet is for the scene to find."""
    kinds = {kind for kind in SOLVERS if solver_of(context.structure, partner, kind).actors}
    return bool(kinds - {solver.kind})


def _missing(context: RuleContext, partner: LogicalObject, solver: Solver) -> str:
    """What a partner needs to take part; "" if it does."""
    if solver.kind == "sim_rigid":
        takes_part, fix = any(map(_is_body, partner.members)), _PASSIVE
    elif solver.kind in _COLLIDES:
        takes_part, fix = any(item.has_modifier({"COLLISION"}) for item in partner.members), _COLLISION
    else:
        is_effector = any(item.has_modifier({"FLUID_EFFECTOR"}) for item in partner.members)
        # The domain's own sides may hold the liquid.
        takes_part, fix = is_effector or _is_domain_within(context, partner, solver), _EFFECTOR
    return "" if takes_part else fix


def _is_domain_within(context: RuleContext, partner: LogicalObject, solver: Solver) -> bool:
    """Whether the domains of a fluid are no larger than what holds the fluid, seen from above."""
    boxes = [context.structure.objects[name].box for name in partner.surfaces]
    domains = [item for item in solver.actors if item.is_fluid_domain]
    for domain in domains:
        cell = domain.fluid.cell if domain.fluid is not None else 0.0
        if domain.box is None or not any(
            box is not None
            and all(
                box.low[axis] - cell <= domain.box.low[axis]
                and domain.box.high[axis] <= box.high[axis] + cell
                for axis in (0, 1)
            )
            for box in boxes
        ):
            return False
    return bool(domains)
