"""R15: the declared mechanism is set up, with all that it works with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.judging.declared_kinds import declared_objects, wrong_tag
from agents.protocol.judging.mechanisms import (
    MIN_DENSE_KEYS,
    SOLVERS,
    active_solvers,
    has_rig,
    imitations,
    parent_chain,
    solver_of,
)
from agents.protocol.judging.partners import missing_partners, setup_problems
from agents.protocol.rule import NotApplicable, Rule, RuleContext
from agents.protocol.tolerances import CONTACT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding
    from agents.protocol.measures.requests import Measures
    from agents.protocol.structure import LogicalObject

_CENTRED_SHAPES = frozenset({"BOX", "SPHERE", "CAPSULE", "CYLINDER", "CONE"})


def _wrong_mechanisms(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    structure = context.structure
    problems = list(setup_problems(context))
    yield from (R15.finding((name,), message, fix=fix) for name, message, fix in problems)
    try:
        declared = declared_objects(context)
    except NotApplicable:
        if problems:
            return
        raise
    for obj, deformation, _ in declared:
        yield from wrong_tag(R15, context, obj, "deformation_kind", deformation)
        name = obj.name
        if deformation in SOLVERS:
            yield from _wrong_solver(context, obj, deformation)
        elif deformation == "rig" and not has_rig(structure, obj):
            message = f"{name!r} is declared a rig, but no armature, lattice or shape key deforms it"
            message += ", and no bone carries it."
            yield R15.finding((name,), message)
        elif deformation == "none" and (solvers := active_solvers(structure, obj)):
            yield R15.finding(
                (name,),
                f"{name!r} declares no deformation, but is simulated ({', '.join(solvers)}).",
                fix="Declare the solver as its deformation_kind, or remove it.",
            )


def _wrong_solver(context: RuleContext, obj: LogicalObject, kind: str) -> Iterator[Finding]:
    solver = solver_of(context.structure, obj, kind)
    name = SOLVERS[kind][2]
    if not solver.actors:
        message = f"{obj.name!r} is declared {kind}, but has no {name} that is on."
        yield R15.finding((obj.name,), message, measured=0.0)
        return
    frames = context.facts.frame_end - context.facts.frame_start + 1
    dense = max(MIN_DENSE_KEYS, context.tolerances.dense_keys * frames)
    parts = {
        item.name: item for actor in solver.actors for item in parent_chain(context.structure, obj, actor)
    }
    for item in parts.values():
        if imitated := imitations(kind, item, dense):
            yield R15.finding(
                (item.name, obj.name),
                f"{obj.name!r} is declared {kind}, but {item.name!r} is moved by {' and '.join(imitated)}.",
                fix="Remove that, and let the solver move it.",
            )
    if not all(cache.on for cache in solver.caches):
        yield R15.finding(
            (obj.name,),
            f"{obj.name!r} is declared {kind}, but its solver is switched off.",
            fix="Switch it on: the modifier in the viewport, or the rigid-body world.",
        )
    for partner, message, fix in missing_partners(context, obj, solver):
        yield R15.finding((obj.name, partner), message, fix=fix)
    yield from _bodies_off_their_meshes(context, obj)


def _bodies_off_their_meshes(context: RuleContext, obj: LogicalObject) -> Iterator[Finding]:
    """Findings for bodies with an origin outside the mesh, or with a shape centred on one that is not its middle."""
    tolerances = context.tolerances
    for item in obj.members:
        body = item.rigid_body
        if body is None or not body.enabled:
            continue
        size = item.box.diagonal if item.box else 0.0
        is_simulated = body.active and not body.kinematic
        if is_simulated and body.origin_outside > (most := tolerances.origin_share * size):
            yield R15.finding(
                (item.name, obj.name),
                f"The origin of {item.name!r}, its centre of mass, is {body.origin_outside:.3f} m outside its mesh.",
                fix="Move the origin to the middle of the mesh (its data one way, the object the other), and bake "
                "again.",
                measured=body.origin_outside,
                tolerance=most,
                unit="m",
            )
        elif body.shape in _CENTRED_SHAPES and body.off_centre > (most := tolerances.contact_gap(size)):
            yield R15.finding(
                (item.name, obj.name),
                f"The collision shape of {item.name!r}, a {body.shape.lower()}, is centred on its origin, "
                f"{body.off_centre * 1000:.1f} mm from the middle of its mesh.",
                fix="Move the origin to the middle of the mesh, or use the shape CONVEX_HULL or MESH.",
                measured=body.off_centre,
                tolerance=most,
                unit="m",
            )


R15 = Rule(
    "R15",
    "mechanism",
    "hard",
    "What deformation_kind declares is set up: solver on, partners and fields in it, bodies centred in meshes; "
    "no keys imitate it.",
    "A motion that only looks simulated cannot be changed: move the ball, and the dominoes fall as before.",
    "Set up the declared solver and its partners, and remove what imitates it.",
    _wrong_mechanisms,
    tolerances=("dense_keys", "origin_share", *CONTACT),
)
RULES = (R15,)
