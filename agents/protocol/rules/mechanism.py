"""R15: the declared mechanism is what moves the object, and T1: the timeline is the planned one, all of it baked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.judging.mechanisms import (
    FEWEST_DENSE,
    SOLVERS,
    at_work,
    chain,
    has_rig,
    imitations,
    keyed,
    solver_of,
)
from agents.protocol.rule import Idle, Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.facts import CacheFacts
    from agents.protocol.findings import Finding
    from agents.protocol.measures.measure import Measures
    from agents.protocol.structure import Thing


def _declared(subject: Subject, thing: Thing) -> tuple[str | None, str | None]:
    """(deformation, motion) as tagged, and where there is no tag, as planned."""
    planned = subject.plan.object(thing.name) if subject.plan else None
    deformation, motion = planned.mechanism if planned else (None, None)
    return thing.collection.deformation_kind or deformation, thing.collection.motion_kind or motion


def _range(subject: Subject, thing: Thing) -> tuple[int, int]:
    """The frames that must be baked: of the planned phases, or the whole timeline."""
    phases = (
        [phase for phase in subject.plan.motion.phases if phase.actor == thing.name] if subject.plan else []
    )
    if phases:
        return min(phase.start for phase in phases), max(phase.end for phase in phases)
    return subject.facts.frame_start, subject.facts.frame_end


def _mechanisms(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    declared = [
        (thing, kinds) for thing in subject.structure.things if any(kinds := _declared(subject, thing))
    ]
    if not declared:
        raise Idle("no object declares how it is deformed or moved")
    for thing, (deformation, motion) in declared:
        yield from _disagreement(subject, thing, deformation, motion)
        if deformation in SOLVERS:
            yield from _solver(subject, thing, deformation, must_be_baked=motion != "none")
        elif deformation == "rig" and not has_rig(thing):
            yield R15.finding(
                (thing.name,),
                f"{thing.name!r} is declared a rig, but no armature, lattice or shape key bends it.",
            )
        elif deformation == "none" and (solvers := at_work(subject.structure, thing)):
            yield R15.finding(
                (thing.name,),
                f"{thing.name!r} declares no deformation, but is simulated ({', '.join(solvers)}).",
                fix="Declare the solver as its deformation_kind, or remove it.",
            )
        if motion == "keyframe" and not keyed(subject.structure, thing):
            yield R15.finding((thing.name,), f"{thing.name!r} is to move by keyframes, but has none.")
        if motion == "none" and deformation not in SOLVERS and (moving := keyed(subject.structure, thing)):
            yield R15.finding(
                (thing.name, moving[0].name),
                f"{thing.name!r} is to stand still, but {moving[0].name!r} is animated.",
            )
        if motion == "bake" and deformation not in SOLVERS and not at_work(subject.structure, thing):
            yield R15.finding(
                (thing.name,), f"{thing.name!r} is to be baked, but no solver is at work in it."
            )


def _disagreement(
    subject: Subject, thing: Thing, deformation: str | None, motion: str | None
) -> Iterator[Finding]:
    """Tags that say something else than the plan."""
    planned = subject.plan.object(thing.name) if subject.plan else None
    if planned is None:
        return
    for what, tagged, meant in zip(
        ("deformation_kind", "motion_kind"), (deformation, motion), planned.mechanism, strict=True
    ):
        if tagged != meant:
            yield R15.finding(
                (thing.name,),
                f"{thing.name!r} is tagged {what}={tagged!r}; its planned role {planned.role!r} is {meant!r}.",
                fix=f"Build the planned mechanism and tag the object {what}={meant!r}.",
            )


def _solver(subject: Subject, thing: Thing, kind: str, *, must_be_baked: bool) -> Iterator[Finding]:
    found = solver_of(subject.structure, thing, kind)
    name = SOLVERS[kind][2]
    if not found.actors:
        yield R15.finding(
            (thing.name,), f"{thing.name!r} is declared {kind}, but has no {name} that is on.", measured=0.0
        )
        return
    frames = subject.facts.frame_end - subject.facts.frame_start + 1
    most = max(FEWEST_DENSE, subject.tolerances.dense_keys * frames)
    parts = {part.name: part for one in found.actors for part in chain(subject.structure, thing, one)}
    for one in parts.values():
        if imitated := imitations(kind, one, most):
            yield R15.finding(
                (one.name, thing.name),
                f"{thing.name!r} is declared {kind}, but {one.name!r} is moved by {' and '.join(imitated)}.",
                fix="Remove that, and let the solver move it.",
            )
    if not all(cache.on for cache in found.caches):
        yield R15.finding(
            (thing.name,),
            f"{thing.name!r} is declared {kind}, but its solver is switched off.",
            fix="Switch it on: the modifier in the viewport, or the rigid-body world.",
        )
    if must_be_baked:
        start, end = _range(subject, thing)
        if not found.caches:
            yield R15.finding(
                (thing.name,), f"{thing.name!r} has a {name}, but no cache that could be baked."
            )
        for cache in found.caches:
            if reason := _not_baked(cache, start, end):
                yield R15.finding(
                    (thing.name, *((cache.object,) if cache.object else ())),
                    f"The {_called(cache)} of {thing.name!r} {reason}.",
                    fix="Bake it over the whole range (blender_bake).",
                )


def _not_baked(cache: CacheFacts, start: int, end: int) -> str:
    if not cache.baked:
        return "is not baked"
    if cache.outdated:
        return "is baked, but outdated"
    # The first frame of a simulation is its rest: a cache may begin there.
    if cache.frame_start > start or cache.frame_end < end:
        return f"is baked for frames {cache.frame_start}–{cache.frame_end}, not for {start}–{end}"
    if cache.missing:
        return f"is baked, but {cache.missing} of its frames are missing"
    return ""


def _called(cache: CacheFacts) -> str:
    return f"{cache.kind.replace('_', '-')} cache"


def _timeline(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    plan, facts = subject.planned, subject.facts
    if not plan.motion.phases and plan.render.kind == "still":
        raise Idle("the plan has no motion")
    for what, is_, planned in (
        ("frame rate", facts.fps, float(plan.fps)),
        ("first frame", facts.frame_start, plan.frame_start),
        ("last frame", facts.frame_end, plan.frame_end),
    ):
        if abs(is_ - planned) > 1e-3:
            yield T1.finding(
                (),
                f"The scene's {what} is {is_:g}; planned is {planned:g}.",
                measured=float(is_),
                tolerance=0.0,
            )
    for cache in (one for one in facts.caches if one.on):
        if reason := _not_baked(cache, plan.frame_start, plan.frame_end):
            owner = f" of {cache.object!r}" if cache.object else ""
            yield T1.finding(
                (cache.object,) if cache.object else (),
                f"The {_called(cache)}{owner} {reason}.",
                fix="Bake it over the whole timeline (blender_bake).",
            )


R15 = Rule(
    "R15",
    "mechanism",
    "hard",
    "What deformation_kind and motion_kind declare is what moves the object: its solver is on and baked, and no "
    "keyframes or shape keys imitate it.",
    "A motion that only looks simulated cannot be changed: move the ball, and the dominoes fall as before.",
    "Set up the declared solver, bake it, and remove what imitates it.",
    _mechanisms,
    tolerances=("dense_keys",),
)
T1 = Rule(
    "T1",
    "timeline",
    "hard",
    "Frame rate and frame range are the planned ones; every cache covers them, baked and up to date.",
    "What is not baked plays differently on every machine, and not at all in a render farm.",
    "Set the scene's frame range and rate, and bake.",
    _timeline,
    needs_plan=True,
)
RULES = (R15, T1)
