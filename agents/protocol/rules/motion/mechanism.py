"""R15: the declared mechanism moves the object; T1: the timeline is the planned one, and all of it is baked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.judging.mechanisms import (
    MIN_DENSE_KEYS,
    SOLVERS,
    active_solvers,
    animated_objects,
    has_rig,
    imitations,
    parent_chain,
    solver_of,
)
from agents.protocol.rule import NotApplicable, Rule, RuleContext

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.scene import PlannedObject
    from agents.protocol.facts import CacheFacts
    from agents.protocol.findings import Finding
    from agents.protocol.measures.requests import Measures
    from agents.protocol.structure import LogicalObject


def _planned(context: RuleContext, obj: LogicalObject) -> PlannedObject | None:
    return context.plan.object(obj.name) if context.plan else None


def _declared(context: RuleContext, obj: LogicalObject) -> tuple[str | None, str | None]:
    """(deformation_kind, motion_kind) of an object's tags, or of the plan where a tag is missing."""
    planned = _planned(context, obj)
    deformation, motion = planned.mechanism if planned else (None, None)
    return obj.collection.deformation_kind or deformation, obj.collection.motion_kind or motion


def _range(context: RuleContext, obj: LogicalObject) -> tuple[int, int]:
    """The frames that must be baked: those of the planned phases, or the whole timeline."""
    planned = context.plan.motion.phases if context.plan else ()
    phases = [phase for phase in planned if phase.actor == obj.name]
    if phases:
        return min(phase.start for phase in phases), max(phase.end for phase in phases)
    return context.facts.frame_start, context.facts.frame_end


def _wrong_mechanisms(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    structure = context.structure
    declared = [(obj, kinds) for obj in structure.logical_objects if any(kinds := _declared(context, obj))]
    if not declared:
        raise NotApplicable("no object declares how it is deformed or moved")
    for obj, (deformation, motion) in declared:
        yield from _wrong_tags(context, obj, (deformation, motion))
        name = obj.name
        if deformation in SOLVERS:
            yield from _wrong_solver(context, obj, deformation, must_be_baked=motion != "none")
        elif deformation == "rig" and not has_rig(obj):
            message = f"{name!r} is declared a rig, but no armature, lattice or shape key deforms it."
            yield R15.finding((name,), message)
        elif deformation == "none" and (solvers := active_solvers(structure, obj)):
            yield R15.finding(
                (name,),
                f"{name!r} declares no deformation, but is simulated ({', '.join(solvers)}).",
                fix="Declare the solver as its deformation_kind, or remove it.",
            )
        if motion == "keyframe" and not animated_objects(structure, obj):
            yield R15.finding((name,), f"{name!r} is declared to move by keyframes, but has none.")
        if motion == "none" and deformation not in SOLVERS and (moving := animated_objects(structure, obj)):
            yield R15.finding(
                (name, moving[0].name),
                f"{name!r} is declared to stand still, but {moving[0].name!r} is animated.",
            )
        if motion == "bake" and deformation not in SOLVERS and not active_solvers(structure, obj):
            yield R15.finding((name,), f"{name!r} is declared to be baked, but no solver moves it.")


def _wrong_tags(
    context: RuleContext, obj: LogicalObject, declared: tuple[str | None, str | None]
) -> Iterator[Finding]:
    """Tags that contradict the plan."""
    planned = _planned(context, obj)
    if planned is None:
        return
    names = ("deformation_kind", "motion_kind")
    for tag, value, wanted in zip(names, declared, planned.mechanism, strict=True):
        if value != wanted:
            yield R15.finding(
                (obj.name,),
                f"{obj.name!r} is tagged {tag}={value!r}, but its planned role {planned.role!r} needs {wanted!r}.",
                fix=f"Build the planned mechanism and tag the object {tag}={wanted!r}.",
            )


def _wrong_solver(
    context: RuleContext, obj: LogicalObject, kind: str, *, must_be_baked: bool
) -> Iterator[Finding]:
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
    if must_be_baked:
        start, end = _range(context, obj)
        if not solver.caches:
            yield R15.finding((obj.name,), f"{obj.name!r} has a {name}, but no cache to bake.")
        for cache in solver.caches:
            if problem := _bake_problem(cache, start, end):
                yield R15.finding(
                    (obj.name, *((cache.object,) if cache.object else ())),
                    f"The {_cache_name(cache)} of {obj.name!r} {problem}.",
                    fix="Bake it over the whole range (blender_bake).",
                )


def _bake_problem(cache: CacheFacts, start: int, end: int) -> str:
    if not cache.baked:
        return "is not baked"
    if cache.outdated:
        return "is baked, but outdated"
    if cache.frame_start > start or cache.frame_end < end:
        return f"is baked for frames {cache.frame_start}–{cache.frame_end}, not for {start}–{end}"
    if cache.missing:
        return f"is baked, but {cache.missing} of its frames are missing"
    return ""


def _cache_name(cache: CacheFacts) -> str:
    return f"{cache.kind.replace('_', '-')} cache"


def _wrong_timeline(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    plan, facts = context.planned, context.facts
    if not plan.motion.phases and plan.render.kind == "still":
        raise NotApplicable("the plan has no motion")
    for name, value, wanted in (
        ("frame rate", facts.fps, float(plan.fps)),
        ("first frame", facts.frame_start, plan.frame_start),
        ("last frame", facts.frame_end, plan.frame_end),
    ):
        if abs(value - wanted) > 1e-3:
            message = f"The scene's {name} is {value:g}; the plan says {wanted:g}."
            yield T1.finding((), message, measured=float(value), tolerance=0.0)
    for cache in (cache for cache in facts.caches if cache.on):
        if problem := _bake_problem(cache, plan.frame_start, plan.frame_end):
            owner = f" of {cache.object!r}" if cache.object else ""
            yield T1.finding(
                (cache.object,) if cache.object else (),
                f"The {_cache_name(cache)}{owner} {problem}.",
                fix="Bake it over the whole timeline (blender_bake).",
            )


R15 = Rule(
    "R15",
    "mechanism",
    "hard",
    "What deformation_kind and motion_kind declare really moves the object: its solver is on and baked, and no "
    "keyframes or shape keys imitate it.",
    "A motion that only looks simulated cannot be changed: move the ball, and the dominoes fall as before.",
    "Set up the declared solver, bake it, and remove what imitates it.",
    _wrong_mechanisms,
    tolerances=("dense_keys",),
)
T1 = Rule(
    "T1",
    "timeline",
    "hard",
    "Frame rate and frame range are the planned ones; every cache covers them, baked and up to date.",
    "An unbaked simulation plays differently on every machine, and not at all in a render farm.",
    "Set the scene's frame range and rate, and bake.",
    _wrong_timeline,
    needs_plan=True,
)
RULES = (R15, T1)
