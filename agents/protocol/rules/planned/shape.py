"""R2 to R4: dimensions, placement, and valid geometry."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agents.protocol.judging.geometry.poses import anchor
from agents.protocol.judging.geometry.vectors import (
    as_vector,
    axes_of_euler,
    place_and_axes,
    rotation_between,
)
from agents.protocol.judging.sample_frames import planned_pose_frame
from agents.protocol.measures.geometry import ExtentsRequest, PosesRequest, SurfaceRequest
from agents.protocol.measures.requests import Measures, Unmeasured
from agents.protocol.rule import NotApplicable, Rule, RuleContext

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.scene import PlannedObject
    from agents.protocol.facts import ObjectFacts, Vector
    from agents.protocol.findings import Finding

_AXES = "XYZ"
# What makes a mesh's faces out of what may come later: particles, instances.
_COPIES = frozenset({"PARTICLE_INSTANCE", "NODES", "EXPLODE", "BUILD"})
_SIMULATED = frozenset({"CLOTH", "SOFT_BODY", "FLUID_EFFECTOR", "FLUID_FLOW"})


# Dimensions


def _extents(context: RuleContext, name: str) -> ExtentsRequest | None:
    """How far an object reaches along its root's axes; None if it is missing."""
    obj, root = context.structure.by_name.get(name), anchor(context, name)
    if obj is None or not obj.surfaces or root is None:
        return None
    return ExtentsRequest(obj.surfaces, frame=planned_pose_frame(context, name), of=root)


def _sized(context: RuleContext) -> Iterator[tuple[PlannedObject, ExtentsRequest | None]]:
    """Planned objects with a size of their own, which force fields and simulated fluids do not have."""
    for planned in context.planned.objects:
        obj = context.structure.by_name.get(planned.name)
        is_fluid = obj is not None and any(mesh.is_fluid_domain and mesh.rendered for mesh in obj.meshes)
        if planned.role != "force" and not is_fluid:
            yield planned, _extents(context, planned.name)


def _extents_requests(context: RuleContext) -> Iterator[ExtentsRequest]:
    return (request for _, request in _sized(context) if request is not None)


def _wrong_dimensions(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    tolerances = context.tolerances
    for planned, request in _sized(context):
        name = planned.name
        if request is None:
            yield R2.undecided((name,), f"no object {name!r} has a surface and a root")
            continue
        try:
            sizes = measures[request].size
        except Unmeasured as reason:
            yield R2.undecided((name,), reason)
            continue
        for axis, size, wanted in zip(_AXES, sizes, planned.dimensions, strict=True):
            most = max(tolerances.dimension_share * wanted, tolerances.contact)
            if not size and wanted <= tolerances.sheet:
                continue
            if abs(size - wanted) > most:
                yield R2.finding(
                    (name,),
                    f"{name!r} is {size:.3f} m along {axis}; the plan says {wanted:g} m.",
                    fix=f"Scale the meshes of {name!r} by {wanted / size:.3f} along {axis} (and apply the scale), or "
                    "fix the modifier that changes the size."
                    if size
                    else R2.fix,
                    measured=size,
                    tolerance=most,
                    unit="m",
                )


# Placement


def _pose(context: RuleContext, name: str) -> PosesRequest | None:
    """The request for where an object's root is; None if it is missing."""
    root = anchor(context, name)
    return None if root is None else PosesRequest((root,), planned_pose_frame(context, name))


def _pose_requests(context: RuleContext) -> Iterator[PosesRequest]:
    for planned in context.planned.objects:
        if (request := _pose(context, planned.name)) is not None:
            yield request


def _misplaced(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    tolerances = context.tolerances
    for planned in context.planned.objects:
        name, request = planned.name, _pose(context, planned.name)
        if request is None:
            # A field is a solver's partner, made when that is set up: R15 looks for it.
            if planned.role != "force":
                yield R3.undecided((name,), f"no object {name!r} has a place")
            continue
        (root,) = request.names
        try:
            place, axes = place_and_axes(measures[request].matrices[root])
        except Unmeasured as reason:
            yield R3.undecided((name,), reason)
            continue
        diagonal = float(np.linalg.norm(planned.dimensions))
        off = float(np.linalg.norm(place - np.array(planned.position)))
        most = max(tolerances.place, tolerances.place_share * diagonal)
        if off > most:
            here = ", ".join(f"{value:.3f}" for value in place)
            wanted = ", ".join(f"{value:g}" for value in planned.position)
            yield R3.finding(
                (name, root),
                f"The root of {name!r} is at ({here}), {off:.3f} m from its planned position ({wanted}).",
                fix=f"Set the location of {root!r} to ({wanted}); do not move the meshes relative to it.",
                measured=off,
                tolerance=most,
                unit="m",
                at=as_vector(place),
            )
        # A force field blows along its own axis, of which the plan says nothing.
        off = 0.0 if planned.role == "force" else rotation_between(axes, axes_of_euler(planned.rotation))
        if off > tolerances.turn:
            euler = ", ".join(f"{value:g}" for value in planned.rotation)
            yield R3.finding(
                (name, root),
                f"The root of {name!r} is turned {off:.1f}° away from its planned rotation.",
                fix=f"Set the rotation of {root!r} to ({euler})° (XYZ); do not turn the meshes relative to it.",
                measured=off,
                tolerance=tolerances.turn,
                unit="°",
            )


# Geometry


def _judged_meshes(context: RuleContext) -> Iterator[ObjectFacts]:
    """The meshes that renders show, without fluid domains, which only enclose a simulation."""
    for mesh in context.structure.meshes:
        if mesh.rendered and not mesh.is_fluid_domain and (mesh.type == "MESH" or mesh.surface):
            yield mesh


def _must_be_closed(context: RuleContext) -> set[str]:
    """Names of the meshes that must be closed."""
    planned = context.plan.objects if context.plan else ()
    objects = (context.structure.by_name.get(item.name) for item in planned if item.holds_volume)
    return {mesh.name for obj in objects if obj is not None for mesh in obj.meshes}


def _surface_requests(context: RuleContext) -> Iterator[SurfaceRequest]:
    closed = _must_be_closed(context)
    for mesh in _judged_meshes(context):
        if mesh.surface:
            yield from _surfaces(context, mesh, must_close=mesh.name in closed)
        else:
            yield from _later_surfaces(context, mesh)


def _later_surfaces(context: RuleContext, mesh: ObjectFacts) -> Iterator[SurfaceRequest]:
    """The surfaces, halfway and at the end, of a mesh that may have none yet."""
    facts = context.facts
    if mesh.has_modifier(_COPIES) and context.judges_end:
        for frame in ((facts.frame_start + facts.frame_end) // 2, facts.frame_end):
            if frame != facts.frame:
                yield SurfaceRequest(mesh.name, frame)


def _has_none(context: RuleContext, measures: Measures, mesh: ObjectFacts) -> bool:
    """Whether a mesh without faces will have none; where motion is not judged yet, what copies may still have some."""
    if mesh.has_modifier(_COPIES) and not context.judges_end:
        return False
    for request in _later_surfaces(context, mesh):
        try:
            if measures[request].polygons:
                return False
        except Unmeasured:  # it has none then either
            continue
    return True


def _surfaces(context: RuleContext, mesh: ObjectFacts, *, must_close: bool) -> Iterator[SurfaceRequest]:
    """The current surface of a mesh that must be closed, and the last one of a simulated mesh: solvers may explode."""
    if must_close:
        yield SurfaceRequest(mesh.name)
    if _is_simulated(mesh) and context.facts.frame_end != context.facts.frame:
        yield SurfaceRequest(mesh.name, context.facts.frame_end)


def _is_simulated(mesh: ObjectFacts) -> bool:
    return mesh.is_active_body or mesh.has_modifier(_SIMULATED)


def _invalid_geometry(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    if not context.structure.meshes:
        raise NotApplicable("the scene has no mesh")
    if abs(context.facts.metres - 1) > context.tolerances.unit_scale:
        yield R4.finding(
            (),
            f"One Blender unit is {context.facts.metres:g} m in this scene; lengths are judged as if it were 1 m.",
            fix="Set scene.unit_settings.scale_length to 1, and scale what was built to match.",
            outcome="undecided",
            measured=context.facts.metres,
            tolerance=context.tolerances.unit_scale,
        )
    closed = _must_be_closed(context)
    for mesh in _judged_meshes(context):
        if not mesh.evaluated:
            reason = "it is hidden from the viewport, but not from renders, so Blender does not evaluate it"
            yield R4.undecided((mesh.name,), reason)
        elif mesh.fault:
            yield R4.finding((mesh.name,), f"{mesh.name!r}: {mesh.fault}.")
        elif not mesh.surface and not _has_none(context, measures, mesh):
            continue
        elif not mesh.surface:
            yield R4.finding((mesh.name,), f"The mesh {mesh.name!r} has no faces.", measured=0.0)
        else:
            yield from _wrong_scale(context, mesh)
            yield from _broken_surface(context, measures, mesh, must_close=mesh.name in closed)


def _wrong_scale(context: RuleContext, mesh: ObjectFacts) -> Iterator[Finding]:
    matrix = np.array(mesh.matrix, dtype=float).reshape(4, 4)[:3, :3]
    sizes = np.linalg.norm(matrix, axis=0)
    fix = "Apply the scale (bpy.ops.object.transform_apply, or write it into the mesh)."
    if any(value < 0 for value in mesh.scale):
        message = f"{mesh.name!r} has a negative scale, {_three(mesh.scale)}."
        yield R4.finding((mesh.name,), message, fix=fix, measured=min(mesh.scale), tolerance=0.0)
    elif np.linalg.det(matrix) < 0:
        parents = context.structure.parents_of(mesh.name)
        parent = next((name for name in parents if _mirrors(context, name)), None)
        by = f"by its parent {parent!r}" if parent else "by what it follows"
        objects = (mesh.name, *([parent] if parent else []))
        yield R4.finding(objects, f"{mesh.name!r} is mirrored {by}.", fix=fix)
    if not sizes.all():
        yield R4.finding((mesh.name,), f"{mesh.name!r} has scale 0.", fix=fix, measured=0.0)
    off = float(np.abs(sizes - 1).max())
    if _is_simulated(mesh) and off > context.tolerances.unit_scale:
        yield R4.finding(
            (mesh.name,),
            f"{mesh.name!r} is simulated, but its scale in the world is {_three(as_vector(sizes))}; solvers expect 1.",
            fix=fix,
            measured=off,
            tolerance=context.tolerances.unit_scale,
        )


def _mirrors(context: RuleContext, name: str) -> bool:
    item = context.structure.objects.get(name)
    return item is not None and bool(np.prod(item.scale) < 0)


def _broken_surface(
    context: RuleContext, measures: Measures, mesh: ObjectFacts, *, must_close: bool
) -> Iterator[Finding]:
    for request in _surfaces(context, mesh, must_close=must_close):
        try:
            surface = measures[request]
        except Unmeasured as reason:
            yield R4.undecided((mesh.name,), reason, frame=request.frame)
            continue
        if not surface.finite:
            yield R4.finding(
                (mesh.name,),
                f"{mesh.name!r} has vertices with coordinates that are not finite at frame {request.frame}.",
                fix="Find what makes the simulation explode: bodies that overlap at the start, or too few substeps.",
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
    "A chair as large as a house is seen at once; one that is a fifth too large no longer fits everything else.",
    "Scale the meshes (and apply the scale), or fix the modifier that changes the size.",
    _wrong_dimensions,
    _extents_requests,
    needs_plan=True,
    tolerances=("dimension_share", "contact", "sheet"),
)
R3 = Rule(
    "R3",
    "placement",
    "hard",
    "Each object's root has its planned position and rotation; moving objects have it at the first frame.",
    "Every relation between objects depends on where they are.",
    "Move or turn the root Empty; do not move the meshes relative to it.",
    _misplaced,
    _pose_requests,
    needs_plan=True,
    tolerances=("place", "place_share", "turn"),
)
R4 = Rule(
    "R4",
    "valid geometry",
    "hard",
    "Meshes are finite, have faces (copies may later) and a positive scale; those that hold a volume are "
    "closed; simulated bodies have scale 1.",
    "Solvers and Boolean operations fail on broken geometry: they explode, leak, or do nothing.",
    "Rebuild or close the mesh, remove empty meshes, apply the scale.",
    _invalid_geometry,
    _surface_requests,
    tolerances=("unit_scale",),
)
RULES = (R2, R3, R4)
