"""Checks a scene plan for itself, before anything is built.

``read_plan`` takes what a model wrote and gives a plan or its faults; ``faults_of`` finds what the fields alone do not
show: names that nobody has, relations that contradict each other, sizes that cannot be, phases outside the timeline.
"""

from __future__ import annotations

import json
from itertools import combinations
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from agents.plan import graph
from agents.plan.faults import Fault
from agents.plan.part import ALWAYS, owner_of
from agents.plan.relations import Distributed, EmbeddedIn, Inside, SupportedBy
from agents.plan.scene import PlannedObject, ScenePlan
from agents.plan.validation_messages import faults_from, near

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.motion import Phase

LARGEST = 2_000_000  # characters of a plan
_MOVED = frozenset({"rigid", "cloth", "soft", "fluid", "emitter", "rig", "keyframed"})


def read_plan(text: str | bytes | dict[str, Any]) -> tuple[ScenePlan | None, list[Fault]]:
    """A plan from JSON. (None, faults) for what is no plan; (plan, []) for one that contradicts itself nowhere."""
    if isinstance(text, (str, bytes)):
        if len(text) > LARGEST:
            return None, [Fault("", f"The plan has {len(text)} characters; {LARGEST} are the most.")]
        try:
            text = json.loads(text)
        except (ValueError, RecursionError) as error:
            return None, [Fault("", f"The plan is no JSON: {error}.")]
    try:
        plan = ScenePlan.model_validate(text)
    except ValidationError as error:
        return None, faults_from(error, text, ScenePlan)
    faults = faults_of(plan)
    return (None if faults else plan), faults


def faults_of(plan: ScenePlan) -> list[Fault]:
    """Everything that contradicts itself in a plan; [] for a sound one."""
    return [
        *_names(plan),
        *_systems(plan),
        *_members(plan),
        *graph.faults_of(plan.relations),
        *_grounds(plan),
        *_sizes(plan),
        *_rings(plan),
        *_phases(plan),
        *_stages(plan),
    ]


def _names(plan: ScenePlan) -> Iterator[Fault]:
    for field, names in (
        ("objects", [one.name for one in plan.objects]),
        ("systems", [*plan.systems]),
        ("groups", [one.name for one in plan.groups]),
        ("motion.phases", [one.name for one in plan.motion.phases]),
        ("lighting", [one.name for one in plan.lighting]),
    ):
        seen: set[str] = set()
        for place, name in enumerate(names):
            if name in seen:
                yield Fault(
                    f"{field}[{place}]", f"{name!r} is there twice; every one needs a name of its own."
                )
            seen.add(name)
    for place, one in enumerate(plan.objects):
        if one.name in plan.systems:
            yield Fault(
                f"objects[{place}].name",
                f"{one.name!r} is the name of a system too; collections share names.",
            )


def _systems(plan: ScenePlan) -> Iterator[Fault]:
    if "ground" not in plan.systems:
        yield Fault(
            "systems", "There is no system 'ground'; the scene needs one, with the object that all stands on."
        )
    elif not any("ground" in one.systems for one in plan.objects):
        yield Fault(
            "objects", "No object belongs to the system 'ground'; give it the floor, table or terrain."
        )
    for place, one in enumerate(plan.objects):
        for number, system in enumerate(one.systems):
            if system not in plan.systems:
                yield Fault(
                    f"objects[{place}].systems[{number}]",
                    f"There is no system {system!r}{near(system, plan.systems)}.",
                )


def _members(plan: ScenePlan) -> Iterator[Fault]:
    """Names that are used but not there."""
    names = [one.name for one in plan.objects]
    parts = {one.name: one.parts for one in plan.objects}

    def unknown(node: str) -> str | None:
        owner, _, part = node.partition("/")
        if owner not in parts:
            return f"There is no object {owner!r}{near(owner, names)}."
        if part and part not in parts[owner]:
            return f"{owner!r} has no part {part!r} (its parts: {', '.join(parts[owner]) or 'none'})."
        return None

    for place, relation in enumerate(plan.relations):
        for field, node in graph.fields_of(relation):
            if reason := unknown(node):
                yield Fault(f"relations[{place}].{field}", reason)
    for place, group in enumerate(plan.groups):
        for number, member in enumerate(group.members):
            if reason := unknown(member):
                yield Fault(f"groups[{place}].members[{number}]", reason)
    for number, subject in enumerate(plan.camera.subjects):
        if reason := unknown(subject):
            yield Fault(f"camera.subjects[{number}]", reason)
    for path, target in (
        ("camera.target", plan.camera.target),
        *((f"lighting[{place}].target", light.target) for place, light in enumerate(plan.lighting)),
    ):
        if isinstance(target, str) and (reason := unknown(target)):
            yield Fault(path, reason)
    for place, phase in enumerate(plan.motion.phases):
        if reason := unknown(phase.actor):
            yield Fault(f"motion.phases[{place}].actor", reason)


def _grounds(plan: ScenePlan) -> Iterator[Fault]:
    """What is supported must in the end stand on something of the ground."""
    ground = {one.name for one in plan.objects if "ground" in one.systems}
    bearers: dict[str, set[str]] = {}
    for relation in plan.relations:
        if isinstance(relation, SupportedBy):
            bearers.setdefault(owner_of(relation.child), set()).update(map(owner_of, relation.parents))
        else:
            for child, bearer in graph.held_by(relation):
                bearers.setdefault(owner_of(child), set()).add(owner_of(bearer))
    for place, relation in enumerate(plan.relations):
        if not isinstance(relation, SupportedBy):
            continue
        reached, waiting = set[str](), [owner_of(relation.child)]
        while waiting:
            name = waiting.pop()
            if name not in reached:
                reached.add(name)
                waiting += bearers.get(name, ())
        if not reached & ground:
            yield Fault(
                f"relations[{place}]",
                f"{relation.child!r} is supported, but nothing below it stands on an object of the system 'ground'.",
            )


def _sizes(plan: ScenePlan) -> Iterator[Fault]:
    """What is to be contained must fit, however it is turned."""
    by_name = {one.name: one for one in plan.objects}
    for place, relation in enumerate(plan.relations):
        if isinstance(relation, Inside) and not relation.partial:
            content, container = by_name.get(relation.content), by_name.get(relation.container)
            if content and container and not _fits(content, container):
                yield Fault(
                    f"relations[{place}]",
                    f"{content.name!r} ({_metres(content)}) cannot lie inside {container.name!r} "
                    f"({_metres(container)}), however it is turned.",
                )
        elif isinstance(relation, EmbeddedIn):
            host = by_name.get(relation.host)
            if host and relation.depth > max(host.dimensions):
                yield Fault(
                    f"relations[{place}].depth",
                    f"{relation.depth} m is deeper than {host.name!r} ({_metres(host)}).",
                )


def _fits(content: PlannedObject, container: PlannedObject) -> bool:
    """Whether one box can hold the other, edges compared by size: necessary, and enough for axis-aligned boxes."""
    pairs = zip(sorted(content.dimensions), sorted(container.dimensions), strict=True)
    return all(inner <= outer for inner, outer in pairs)


def _metres(one: PlannedObject) -> str:
    return " × ".join(f"{size:g}" for size in one.dimensions) + " m"


def _rings(plan: ScenePlan) -> Iterator[Fault]:
    for place, relation in enumerate(plan.relations):
        if not isinstance(relation, Distributed):
            continue
        count, path = len(relation.members), f"relations[{place}]"
        if relation.fold is not None and relation.fold != count:
            yield Fault(f"{path}.fold", f"{relation.fold} members are asked for, {count} are named.")
        if relation.pattern == "circle" and count < 3:
            yield Fault(f"{path}.members", "Two objects make no circle; name three or more, or say 'line'.")
        cells = (relation.rows or 0) * (relation.columns or 0)
        if relation.pattern == "grid" and cells and cells != count:
            yield Fault(
                f"{path}.members",
                f"{relation.rows} rows of {relation.columns} are {cells}; {count} are named.",
            )


def _phases(plan: ScenePlan) -> Iterator[Fault]:
    by_name = {phase.name: phase for phase in plan.motion.phases}
    roles = {one.name: one.role for one in plan.objects}
    for place, phase in enumerate(plan.motion.phases):
        path = f"motion.phases[{place}]"
        if phase.start < plan.frame_start or phase.end > plan.frame_end:
            yield Fault(
                path,
                f"Frames {phase.start}–{phase.end} are outside the scene's, {plan.frame_start}–{plan.frame_end}.",
            )
        if phase.cause is not None:
            yield from _cause(path, phase, by_name)
        if phase.kind != "hold" and roles.get(phase.actor, "rigid") not in _MOVED:
            yield Fault(
                f"{path}.actor",
                f"{phase.actor!r} is to move, but its role is {roles[phase.actor]!r}; say what moves it "
                f"({', '.join(sorted(_MOVED))}).",
            )
    for (first, one), (second, other) in combinations(enumerate(plan.motion.phases), 2):
        if one.actor == other.actor and one.start < other.end and other.start < one.end:
            yield Fault(
                f"motion.phases[{second}]",
                f"{other.name!r} overlaps {one.name!r} (phases[{first}]) of the same actor {one.actor!r}.",
            )


def _cause(path: str, phase: Phase, by_name: dict[str, Phase]) -> Iterator[Fault]:
    cause = by_name.get(phase.cause or "")
    if cause is None:
        yield Fault(f"{path}.cause", f"There is no phase {phase.cause!r}{near(phase.cause or '', by_name)}.")
    elif cause is phase:
        yield Fault(f"{path}.cause", "A phase cannot be its own cause.")
    elif cause.start > phase.start:
        yield Fault(
            f"{path}.cause",
            f"{cause.name!r} begins at frame {cause.start}, after its effect at {phase.start}.",
        )


def _stages(plan: ScenePlan) -> Iterator[Fault]:
    for place, stage in enumerate(plan.opt_out):
        if stage in ALWAYS:
            yield Fault(f"opt_out[{place}]", f"No scene does without the stage {stage!r}.")
    moved = [one.name for one in plan.objects if one.role in _MOVED]
    if plan.motion.phases and "motion" in plan.opt_out:
        yield Fault("opt_out", "The stage 'motion' is opted out, but phases are planned.")
    if plan.render.kind == "animation" and plan.frame_end == plan.frame_start:
        yield Fault("frame_end", "An animation needs more than one frame.")
    if moved and plan.render.kind == "animation" and not plan.motion.phases:
        yield Fault("motion.phases", f"{', '.join(moved[:5])} are to move, but no phase says how.")
