"""R19: what is declared to move does, by keyframes or a bake; T1: the timeline is the planned one, all of it baked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.judging.declared_kinds import declared_objects, wrong_tag
from agents.protocol.judging.mechanisms import SOLVERS, active_solvers, animated_objects, solver_of
from agents.protocol.rule import NotApplicable, Rule, RuleContext

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.facts import CacheFacts
    from agents.protocol.findings import Finding
    from agents.protocol.measures.requests import Measures
    from agents.protocol.structure import LogicalObject


_PARTICLES = "particles"  # a kind of cache
_NAMED = 5  # of what changed since a bake
_BAKE = "Bake it over the whole range (blender_bake)."


def _range(context: RuleContext, obj: LogicalObject) -> tuple[int, int]:
    """The frames that must be baked: those of the planned phases, or the whole timeline."""
    planned = context.plan.motion.phases if context.plan else ()
    phases = [phase for phase in planned if phase.actor == obj.name]
    if phases:
        return min(phase.start for phase in phases), max(phase.end for phase in phases)
    return context.facts.frame_start, context.facts.frame_end


def _wrong_motions(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    structure = context.structure
    shared: dict[str, list[str]] = {}
    for obj, deformation, motion in declared_objects(context):
        name = obj.name
        yield from wrong_tag(R19, context, obj, "motion_kind", motion)
        if deformation in SOLVERS and motion != "none":
            yield from _unbaked(context, obj, deformation, shared)
        if motion == "keyframe" and not animated_objects(structure, obj):
            yield R19.finding((name,), f"{name!r} is declared to move by keyframes, but has none.")
        if motion == "none" and deformation not in SOLVERS and (moving := animated_objects(structure, obj)):
            yield R19.finding(
                (name, moving[0].name),
                f"{name!r} is declared to stand still, but {moving[0].name!r} is animated.",
            )
        if motion == "bake" and deformation not in SOLVERS and not active_solvers(structure, obj):
            yield R19.finding((name,), f"{name!r} is declared to be baked, but no solver moves it.")
    for problem, names in shared.items():
        yield R19.finding(tuple(names), f"{problem}.", fix=_BAKE)


def _unbaked(
    context: RuleContext, obj: LogicalObject, kind: str, shared: dict[str, list[str]]
) -> Iterator[Finding]:
    """Findings about an object's own caches; those of all bodies of a world are noted in ``shared``."""
    solver = solver_of(context.structure, obj, kind)
    if not solver.actors:
        return  # R15 says so
    start, end = _range(context, obj)
    if not solver.caches:
        yield R19.finding((obj.name,), f"{obj.name!r} has a {SOLVERS[kind][2]}, but no cache to bake.")
    for cache in solver.caches:
        problem = _bake_problem(cache, start, end)
        if problem and cache.object:
            message = f"The {_cache_name(cache)} of {obj.name!r} {problem}."
            yield R19.finding((obj.name, cache.object), message, fix=_BAKE)
        elif problem:
            shared.setdefault(f"The {_cache_name(cache)} {problem}", []).append(obj.name)


def _bake_problem(cache: CacheFacts, start: int, end: int) -> str:
    if not cache.baked:
        return "is not baked"
    if cache.outdated:
        since = f": since then {', '.join(cache.changed[:_NAMED])} changed" if cache.changed else ""
        return f"is baked, but outdated{since}; the old bake is played"
    # Blender sets the range of particles itself: from the first that is born to the last that dies.
    has_own_range = cache.kind == _PARTICLES
    if not has_own_range and (cache.frame_start > start or cache.frame_end < end):
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
    wrong: set[str] = set()
    for name, value, wanted in (
        ("frame rate", facts.fps, float(plan.fps)),
        ("first frame", facts.frame_start, plan.frame_start),
        ("last frame", facts.frame_end, plan.frame_end),
    ):
        if abs(value - wanted) > 1e-3:
            message = f"The scene's {name} is {value:g}; the plan says {wanted:g}."
            wrong.add(name)
            yield T1.finding((), message, measured=float(value), tolerance=0.0)
    for cache in (cache for cache in facts.caches if cache.on):
        if "frame rate" in wrong and cache.changed == ("the scene",):
            continue  # told above: with the planned rate, the bake fits again
        if problem := _bake_problem(cache, plan.frame_start, plan.frame_end):
            owner = f" of {cache.object!r}" if cache.object else ""
            yield T1.finding(
                (cache.object,) if cache.object else (),
                f"The {_cache_name(cache)}{owner} {problem}.",
                fix="Bake it over the whole timeline (blender_bake).",
            )


R19 = Rule(
    "R19",
    "motion as declared",
    "hard",
    "What motion_kind declares moves the object: keyframes, or a bake.",
    "An unbaked simulation plays differently on every machine; an object without its keyframes stands still.",
    "Bake the simulation, or set the keyframes; tag the object as it moves.",
    _wrong_motions,
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
RULES = (R19, T1)
