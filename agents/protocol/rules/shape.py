"""R2 to R4: sizes, places, and geometry that is sound."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agents.protocol.judging.sample_frames import anchor, beginning, placed, rotation, turned
from agents.protocol.measures.measure import Extents, Measures, Poses, Surface, Unmeasured
from agents.protocol.rule import Idle, Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.scene import PlannedObject
    from agents.protocol.facts import ObjectFacts, Vector
    from agents.protocol.findings import Finding

_AXES = "XYZ"
_SIMULATED = frozenset({"CLOTH", "SOFT_BODY", "FLUID_EFFECTOR", "FLUID_FLOW"})


# Sizes


def _extents(subject: Subject, one: PlannedObject) -> Extents | None:
    """How far an object reaches along its root's axes; None for what is not there."""
    thing, root = subject.structure.by_name.get(one.name), anchor(subject, one.name)
    if thing is None or not thing.surfaces or root is None:
        return None
    return Extents(thing.surfaces, frame=beginning(subject, one.name), of=root)


def _sized(subject: Subject) -> Iterator[tuple[PlannedObject, Extents | None]]:
    """Planned objects that have a size of their own: a field has none, and what a fluid's solver makes has any."""
    structure = subject.structure
    for one in subject.planned.objects:
        thing = structure.by_name.get(one.name)
        meshes = [mesh for mesh in thing.meshes if mesh.surface and mesh.rendered] if thing else []
        if one.role != "force" and not (meshes and all(map(_is_domain, meshes))):
            yield one, _extents(subject, one)


def _is_domain(mesh: ObjectFacts) -> bool:
    return any(modifier.type == "FLUID_DOMAIN" for modifier in mesh.modifiers)


def _ask_sizes(subject: Subject) -> Iterator[Extents]:
    return (request for _, request in _sized(subject) if request is not None)


def _sizes(subject: Subject, measures: Measures) -> Iterator[Finding]:
    for one, request in _sized(subject):
        if request is None:
            yield R2.undecided((one.name,), f"there is no object {one.name!r} with a surface and a root")
            continue
        try:
            found = measures[request].size
        except Unmeasured as reason:
            yield R2.undecided((one.name,), reason)
            continue
        for axis, (is_, planned) in enumerate(zip(found, one.dimensions, strict=True)):
            most = max(subject.tolerances.dimension_share * planned, subject.tolerances.contact)
            if abs(is_ - planned) > most:
                yield R2.finding(
                    (one.name,),
                    f"{one.name!r} is {is_:.3f} m along {_AXES[axis]}; planned are {planned:g} m.",
                    fix=_resize(one.name, is_, planned, axis),
                    measured=is_,
                    tolerance=most,
                    unit="m",
                )


def _resize(name: str, is_: float, planned: float, axis: int) -> str:
    if not is_:
        return R2.fix
    return (
        f"Scale the meshes of {name!r} by {planned / is_:.3f} along {_AXES[axis]} (and apply the scale), "
        "or mend the modifier that changes the size."
    )


# Places


def _pose(subject: Subject, one: PlannedObject) -> tuple[str, Poses] | None:
    """(what carries its place, the request for where that is); None for what is not there."""
    root = anchor(subject, one.name)
    return None if root is None else (root, Poses((root,), beginning(subject, one.name)))


def _ask_places(subject: Subject) -> Iterator[Poses]:
    for one in subject.planned.objects:
        if (asked := _pose(subject, one)) is not None:
            yield asked[1]


def _places(subject: Subject, measures: Measures) -> Iterator[Finding]:
    tolerances = subject.tolerances
    for one in subject.planned.objects:
        asked = _pose(subject, one)
        if asked is None:
            yield R3.undecided((one.name,), f"there is nothing called {one.name!r} that has a place")
            continue
        root, request = asked
        try:
            place, axes = placed(measures[request].matrices[root])
        except Unmeasured as reason:
            yield R3.undecided((one.name,), reason)
            continue
        diagonal = float(np.linalg.norm(one.dimensions))
        away = float(np.linalg.norm(place - np.array(one.position)))
        most = max(tolerances.place, tolerances.place_share * diagonal)
        if away > most:
            here = ", ".join(f"{value:.3f}" for value in place)
            planned = ", ".join(f"{value:g}" for value in one.position)
            yield R3.finding(
                (one.name, root),
                f"The root of {one.name!r} is at ({here}), {away:.3f} m from the planned ({planned}).",
                fix=f"Set the location of {root!r} to ({planned}); leave the meshes where they are below it.",
                measured=away,
                tolerance=most,
                unit="m",
                at=(float(place[0]), float(place[1]), float(place[2])),
            )
        euler = ", ".join(f"{value:g}" for value in one.rotation)
        if (off := turned(axes, rotation(one.rotation))) > tolerances.turn:
            yield R3.finding(
                (one.name, root),
                f"The root of {one.name!r} is turned {off:.1f}° away from its planned rotation.",
                fix=f"Set the rotation of {root!r} to ({euler})° (XYZ); leave the meshes as they are below it.",
                measured=off,
                tolerance=tolerances.turn,
                unit="°",
            )


# Geometry


def _judged(subject: Subject) -> Iterator[ObjectFacts]:
    """What renders show: what only encloses a simulation is not geometry of the scene."""
    for mesh in subject.structure.meshes:
        if mesh.rendered and not _is_domain(mesh) and (mesh.type == "MESH" or mesh.surface):
            yield mesh


def _closed(subject: Subject) -> set[str]:
    """Names of the meshes that must be closed."""
    if subject.plan is None:
        return set()
    things = (subject.structure.by_name.get(one.name) for one in subject.plan.objects if one.holds_volume)
    return {mesh.name for thing in things if thing is not None for mesh in thing.meshes}


def _ask_surfaces(subject: Subject) -> Iterator[Surface]:
    closed = _closed(subject)
    for mesh in _judged(subject):
        if mesh.surface:
            yield from _asked(subject, mesh, must_close=mesh.name in closed)


def _asked(subject: Subject, mesh: ObjectFacts, *, must_close: bool) -> Iterator[Surface]:
    """As it is, if it must be closed; as it is at last, if it is simulated: solvers may explode."""
    if must_close:
        yield Surface(mesh.name)
    if _is_simulated(mesh) and subject.facts.frame_end != subject.facts.frame:
        yield Surface(mesh.name, subject.facts.frame_end)


def _is_simulated(mesh: ObjectFacts) -> bool:
    body = mesh.rigid_body
    return (body is not None and body.active and body.enabled) or any(
        one.type in _SIMULATED and one.on for one in mesh.modifiers
    )


def _sound(subject: Subject, measures: Measures) -> Iterator[Finding]:
    if not subject.structure.meshes:
        raise Idle("the scene has no mesh")
    if abs(subject.facts.metres - 1) > subject.tolerances.unit_scale:
        yield R4.finding(
            (),
            f"One unit is {subject.facts.metres:g} m in this scene; all lengths are judged as if it were 1 m.",
            fix="Set scene.unit_settings.scale_length to 1, and scale what was built to match.",
            outcome="undecided",
            measured=subject.facts.metres,
            tolerance=subject.tolerances.unit_scale,
        )
    closed = _closed(subject)
    for mesh in _judged(subject):
        if not mesh.evaluated:
            hidden = "it is hidden from the viewport, but not from renders: Blender does not evaluate it"
            yield R4.undecided((mesh.name,), hidden)
        elif mesh.fault:
            yield R4.finding((mesh.name,), f"{mesh.name!r}: {mesh.fault}.")
        elif not mesh.surface:
            yield R4.finding((mesh.name,), f"The mesh {mesh.name!r} has no faces.", measured=0.0)
        else:
            yield from _scaled(subject, mesh)
            yield from _whole(subject, measures, mesh, must_close=mesh.name in closed)


def _scaled(subject: Subject, mesh: ObjectFacts) -> Iterator[Finding]:
    matrix = np.array(mesh.matrix, dtype=float).reshape(4, 4)[:3, :3]
    sizes = np.linalg.norm(matrix, axis=0)
    fix = "Apply the scale (bpy.ops.object.transform_apply, or write it into the mesh)."
    if any(value < 0 for value in mesh.scale):
        worst = min(mesh.scale)
        message = f"{mesh.name!r} has a negative scale, {_three(mesh.scale)}."
        yield R4.finding((mesh.name,), message, fix=fix, measured=worst, tolerance=0.0)
    elif np.linalg.det(matrix) < 0:
        by = next((name for name in subject.structure.parents_of(mesh.name) if _mirrors(subject, name)), None)
        said = f"by its parent {by!r}" if by else "by what it follows"
        yield R4.finding((mesh.name, *([by] if by else [])), f"{mesh.name!r} is mirrored {said}.", fix=fix)
    if not sizes.all():
        yield R4.finding((mesh.name,), f"{mesh.name!r} is scaled to nothing.", fix=fix, measured=0.0)
    off = float(np.abs(sizes - 1).max())
    if _is_simulated(mesh) and off > subject.tolerances.unit_scale:
        scale = (float(sizes[0]), float(sizes[1]), float(sizes[2]))
        yield R4.finding(
            (mesh.name,),
            f"{mesh.name!r} is simulated, but its scale in the world is {_three(scale)}; solvers reckon with 1.",
            fix=fix,
            measured=off,
            tolerance=subject.tolerances.unit_scale,
        )


def _mirrors(subject: Subject, name: str) -> bool:
    one = subject.structure.objects.get(name)
    return one is not None and bool(np.prod(one.scale) < 0)


def _whole(subject: Subject, measures: Measures, mesh: ObjectFacts, *, must_close: bool) -> Iterator[Finding]:
    for request in _asked(subject, mesh, must_close=must_close):
        try:
            surface = measures[request]
        except Unmeasured as reason:
            yield R4.undecided((mesh.name,), reason, frame=request.frame)
            continue
        if not surface.finite:
            yield R4.finding(
                (mesh.name,),
                f"{mesh.name!r} has vertices at places that are not numbers at frame {request.frame}.",
                fix="Find what makes the simulation explode: bodies in each other at the start, too few steps.",
                frame=request.frame,
            )
        elif must_close and request.frame is None and surface.open_edges:
            yield R4.finding(
                (mesh.name,),
                f"{mesh.name!r} must be closed to hold a volume, but {surface.open_edges} of its edges are open.",
                measured=float(surface.open_edges),
                tolerance=0.0,
            )


def _three(values: Vector) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in values) + ")"


R2 = Rule(
    "R2",
    "dimensions",
    "hard",
    "The evaluated extent of each object along its root's axes is the planned one.",
    "A chair as large as the house is seen at once; one a fifth too large is what everything else no longer fits.",
    "Scale the meshes (and apply the scale), or mend the modifier that changes the size.",
    _sizes,
    _ask_sizes,
    needs_plan=True,
    tolerances=("dimension_share", "contact"),
)
R3 = Rule(
    "R3",
    "placement",
    "hard",
    "Each object's root is where the plan puts it, turned as planned. Of what moves, at the first frame.",
    "Every relation between objects starts from where they are.",
    "Move or turn the root Empty; leave the meshes where they are below it.",
    _places,
    _ask_places,
    needs_plan=True,
    tolerances=("place", "place_share", "turn"),
)
R4 = Rule(
    "R4",
    "sound geometry",
    "hard",
    "Meshes are finite, filled, of positive scale; what holds a volume is closed; simulated bodies have scale 1.",
    "Solvers and Boolean operations take broken geometry badly: they explode, leak, or do nothing.",
    "Rebuild or close the mesh, remove what is empty, apply the scale.",
    _sound,
    _ask_surfaces,
    tolerances=("unit_scale",),
)
RULES = (R2, R3, R4)
