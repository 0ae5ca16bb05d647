"""Checks of a scene plan before anything is built.

``read_plan`` reads what a model wrote and returns a plan or its faults. ``faults_of`` finds what no single field shows:
unknown names, relations that contradict each other, impossible sizes, phases outside the timeline.
"""

from __future__ import annotations

import json
from itertools import chain, islice
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from agents.plan.faults import MOST_FAULTS, Fault
from agents.plan.graph import held_by, reachable, relation_faults
from agents.plan.part import ALWAYS, owner_of
from agents.plan.relations import Distributed, EmbeddedIn, Inside, SupportedBy
from agents.plan.scene import PlannedObject, ScenePlan
from agents.plan.validation_messages import faults_from, format_path, near

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from agents.plan.motion import MotionPhase

MAX_CHARACTERS = 2_000_000
_MOST_ENTRIES = 1000  # of one list
_DEEPEST = 6  # steps; all lists of a plan lie above
_MOST_NAMED = 6  # of a cycle
_MOVED = frozenset({"rigid", "cloth", "soft", "fluid", "emitter", "rig", "keyframed"})


def read_plan(text: str | bytes | dict[str, Any]) -> tuple[ScenePlan | None, list[Fault]]:
    """Reads a plan from JSON: (plan, []) if it is valid and consistent, else (None, faults), of many the first."""
    if isinstance(text, (str, bytes)):
        if len(text) > MAX_CHARACTERS:
            return None, [Fault("", f"The plan has {len(text)} characters; the limit is {MAX_CHARACTERS}.")]
        try:
            text = json.loads(text)
        except (ValueError, RecursionError) as error:
            return None, [Fault("", f"The plan is not valid JSON: {error}.")]
    if long := list(islice(_long_lists(text), MOST_FAULTS)):
        return None, long
    try:
        plan = ScenePlan.model_validate(text)
    except ValidationError as error:
        return None, faults_from(error, text, ScenePlan)
    faults = faults_of(plan)
    return (None if faults else plan), faults


def faults_of(plan: ScenePlan) -> list[Fault]:
    """The contradictions in a plan, of many the first; [] if it is consistent."""
    faults = chain(
        _repeated_names(plan),
        _system_faults(plan),
        _unknown_names(plan),
        relation_faults(plan.relations),
        _ungrounded(plan),
        _impossible_sizes(plan),
        _pattern_faults(plan),
        _phase_faults(plan),
        _stage_faults(plan),
        _mechanism_faults(plan),
    )
    return list(islice(faults, MOST_FAULTS))


def _long_lists(data: Any) -> Iterator[Fault]:
    """Lists that are longer than any plan's: what is compared in pairs is to stay a matter of seconds."""
    left: list[tuple[tuple[int | str, ...], Any]] = [((), data)]
    for path, value in left:
        if isinstance(value, list) and len(value) > _MOST_ENTRIES:
            yield Fault(format_path(path), f"It has {len(value)} entries; the limit is {_MOST_ENTRIES}.")
        elif isinstance(value, (dict, list)) and len(path) < _DEEPEST:
            entries = value.items() if isinstance(value, dict) else enumerate(value)
            left += [((*path, name), entry) for name, entry in entries]


def _repeated_names(plan: ScenePlan) -> Iterator[Fault]:
    for field, names in (
        ("objects", [planned.name for planned in plan.objects]),
        ("systems", [*plan.systems]),
        ("groups", [group.name for group in plan.groups]),
        ("motion.phases", [phase.name for phase in plan.motion.phases]),
        ("lighting", [light.name for light in plan.lighting]),
    ):
        seen: set[str] = set()
        for place, name in enumerate(names):
            if name in seen:
                yield Fault(f"{field}[{place}]", f"{name!r} is used twice; give each its own name.")
            seen.add(name)
    for place, planned in enumerate(plan.objects):
        if planned.name in plan.systems:
            yield Fault(
                f"objects[{place}].name",
                f"{planned.name!r} is also the name of a system; objects and systems are both collections, so their "
                "names must differ.",
            )


def _system_faults(plan: ScenePlan) -> Iterator[Fault]:
    if "ground" not in plan.systems:
        yield Fault(
            "systems", "The system 'ground' is missing; add it, with the object that everything stands on."
        )
    elif not any("ground" in planned.systems for planned in plan.objects):
        yield Fault(
            "objects", "No object belongs to the system 'ground'; add the floor, table or terrain to it."
        )
    for place, planned in enumerate(plan.objects):
        for number, system in enumerate(planned.systems):
            if system not in plan.systems:
                yield Fault(
                    f"objects[{place}].systems[{number}]",
                    f"There is no system {system!r}{near(system, plan.systems)}.",
                )


def _unknown_names(plan: ScenePlan) -> Iterator[Fault]:
    """Names that are used but that the plan does not have."""
    parts = {planned.name: planned.parts for planned in plan.objects}

    def unknown(node: str) -> str | None:
        owner, _, part = node.partition("/")
        if owner not in parts:
            return f"There is no object {owner!r}{near(owner, parts)}."
        if part and part not in parts[owner]:
            return f"{owner!r} has no part {part!r} (its parts: {', '.join(parts[owner]) or 'none'})."
        return None

    for place, relation in enumerate(plan.relations):
        for field, node in relation.named_nodes:
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


def _ungrounded(plan: ScenePlan) -> Iterator[Fault]:
    """A supported object must stand, directly or through others, on an object of the ground."""
    ground = [planned.name for planned in plan.objects if "ground" in planned.systems]
    held_on: dict[str, set[str]] = {}
    for relation in plan.relations:
        for held, holder in held_by(relation):
            held_on.setdefault(owner_of(holder), set()).add(owner_of(held))
    grounded = reachable(ground, lambda name: held_on.get(name, ()))
    for place, relation in enumerate(plan.relations):
        if isinstance(relation, SupportedBy) and owner_of(relation.child) not in grounded:
            yield Fault(
                f"relations[{place}]",
                f"{relation.child!r} is supported, but nothing below it leads to an object of the system 'ground'; "
                "add the missing SupportedBy.",
            )


def _impossible_sizes(plan: ScenePlan) -> Iterator[Fault]:
    """A content must fit into its container in some orientation."""
    by_name = {planned.name: planned for planned in plan.objects}
    for place, relation in enumerate(plan.relations):
        if isinstance(relation, Inside) and not relation.partial:
            content, container = by_name.get(relation.content), by_name.get(relation.container)
            if content and container and not _fits(content, container):
                yield Fault(
                    f"relations[{place}]",
                    f"{content.name!r} ({_size(content)}) does not fit inside {container.name!r} "
                    f"({_size(container)}) in any orientation.",
                )
        elif isinstance(relation, EmbeddedIn):
            host = by_name.get(relation.host)
            if host and relation.depth > max(host.dimensions):
                yield Fault(
                    f"relations[{place}].depth",
                    f"{relation.depth} m is more than the size of {host.name!r} ({_size(host)}).",
                )


def _fits(content: PlannedObject, container: PlannedObject) -> bool:
    """Whether the sorted edges of one box fit those of the other: exact for boxes that are parallel."""
    pairs = zip(sorted(content.dimensions), sorted(container.dimensions), strict=True)
    return all(inner <= outer for inner, outer in pairs)


def _size(planned: PlannedObject) -> str:
    return " × ".join(f"{size:g}" for size in planned.dimensions) + " m"


def _pattern_faults(plan: ScenePlan) -> Iterator[Fault]:
    for place, relation in enumerate(plan.relations):
        if not isinstance(relation, Distributed):
            continue
        count, path = len(relation.members), f"relations[{place}]"
        if relation.fold is not None and relation.fold != count:
            yield Fault(f"{path}.fold", f"fold is {relation.fold}, but members has {count} names.")
        if relation.pattern == "circle" and count < 3:
            yield Fault(
                f"{path}.members",
                "A circle needs at least three members; add some, or use the pattern 'line'.",
            )
        cells = (relation.rows or 0) * (relation.columns or 0)
        if relation.pattern == "grid" and cells and cells != count:
            yield Fault(
                f"{path}.members",
                f"{relation.rows} rows × {relation.columns} columns are {cells} places, but {count} members are named.",
            )


def _phase_faults(plan: ScenePlan) -> Iterator[Fault]:
    by_name = {phase.name: phase for phase in plan.motion.phases}
    roles = {planned.name: planned.role for planned in plan.objects}
    for place, phase in enumerate(plan.motion.phases):
        path = f"motion.phases[{place}]"
        if phase.start < plan.frame_start or phase.end > plan.frame_end:
            yield Fault(
                path,
                f"Frames {phase.start}–{phase.end} are outside the scene's, {plan.frame_start}–{plan.frame_end}.",
            )
        if phase.cause is not None:
            yield from _cause_faults(path, phase, by_name)
        if phase.kind != "hold" and roles.get(phase.actor, "rigid") not in _MOVED:
            yield Fault(
                f"{path}.actor",
                f"{phase.actor!r} moves, but its role {roles[phase.actor]!r} does not; choose one of "
                f"{', '.join(sorted(_MOVED))}.",
            )
    yield from _cycle_faults(plan.motion.phases, by_name)
    yield from _overlaps(plan.motion.phases)


def _overlaps(phases: Sequence[MotionPhase]) -> Iterator[Fault]:
    """Phases of one actor at one time: each is told with the one before it that lasts the longest."""
    longest: dict[str, int] = {}
    for place in sorted(range(len(phases)), key=lambda place: (phases[place].start, phases[place].end)):
        phase, before = phases[place], longest.get(phases[place].actor)
        if before is not None and phases[before].start < phase.end and phase.start < phases[before].end:
            first, second = sorted((before, place))
            yield Fault(
                f"motion.phases[{second}]",
                f"{phases[second].name!r} overlaps {phases[first].name!r} (phases[{first}]) of the same actor "
                f"{phase.actor!r}.",
            )
        if before is None or phase.end > phases[before].end:
            longest[phase.actor] = place


def _cause_faults(path: str, phase: MotionPhase, by_name: dict[str, MotionPhase]) -> Iterator[Fault]:
    cause = by_name.get(phase.cause or "")
    if cause is None:
        yield Fault(f"{path}.cause", f"There is no phase {phase.cause!r}{near(phase.cause or '', by_name)}.")
    elif cause is phase:
        yield Fault(f"{path}.cause", "A phase cannot cause itself.")
    elif cause.start > phase.start:
        yield Fault(
            f"{path}.cause",
            f"The cause {cause.name!r} starts at frame {cause.start}, after its effect at frame {phase.start}.",
        )


def _cycle_faults(phases: Sequence[MotionPhase], by_name: Mapping[str, MotionPhase]) -> Iterator[Fault]:
    """Each cycle of phases that cause one another, at the one of them that the plan names first."""
    walks: dict[str, int] = {}  # phase → the walk along causes that came to it
    for place, first in enumerate(phases):
        here = by_name.get(first.name)
        while here is not None and here.name not in walks:
            walks[here.name] = place
            here = by_name.get(here.cause or "")
        if here is None or walks[here.name] != place or here.cause == here.name:
            continue
        cycle = [here.name]
        while (cause := by_name[cycle[-1]].cause) and cause != here.name:
            cycle.append(cause)
        named = cycle if len(cycle) <= _MOST_NAMED else [*cycle[: _MOST_NAMED - 1], "…"]
        names = " → ".join((*named, here.name))
        yield Fault(
            f"motion.phases[{place}].cause",
            f"Its cause closes a cycle, each phase caused by the next: {names}. Leave out the cause of the one "
            "that begins.",
        )


def _mechanism_faults(plan: ScenePlan) -> Iterator[Fault]:
    """Fluids' words for what is no fluid; joints of what is no rigid body."""
    roles = {planned.name: planned.role for planned in plan.objects}
    for place, planned in enumerate(plan.objects):
        if planned.role != "fluid" and (planned.fluid_kind is not None or planned.inflow):
            field = "fluid_kind" if planned.fluid_kind is not None else "inflow"
            yield Fault(
                f"objects[{place}].{field}", f"{planned.name!r} has the role {planned.role!r}, not 'fluid'."
            )
    for place, joint in enumerate(plan.joints):
        for field, name in (("part", joint.part), ("host", joint.host)):
            if name not in roles:
                yield Fault(f"joints[{place}].{field}", f"There is no object {name!r}{near(name, roles)}.")
        if joint.part == joint.host:
            yield Fault(f"joints[{place}].host", f"{joint.part!r} cannot be joined to itself.")
        elif roles.get(joint.part, "rigid") != "rigid":
            yield Fault(
                f"joints[{place}].part",
                f"{joint.part!r} is not a rigid body; its role is {roles[joint.part]!r}.",
            )


def _stage_faults(plan: ScenePlan) -> Iterator[Fault]:
    for place, stage in enumerate(plan.opt_out):
        if stage in ALWAYS:
            yield Fault(f"opt_out[{place}]", f"The stage {stage!r} cannot be skipped.")
    moved = [planned.name for planned in plan.objects if planned.role in _MOVED]
    if plan.motion.phases and "motion" in plan.opt_out:
        yield Fault("opt_out", "The stage 'motion' is skipped, but motion.phases is not empty.")
    if plan.render.kind == "animation" and plan.frame_end == plan.frame_start:
        yield Fault("frame_end", "An animation needs more than one frame.")
    if moved and plan.render.kind == "animation" and not plan.motion.phases:
        yield Fault(
            "motion.phases", f"{', '.join(moved[:5])}: the role is one that moves, but no phase says how."
        )
