"""R2 to R4: dimensions, placement, and valid geometry."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

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
    from collections.abc import Iterator, Sequence

    from agents.plan.scene import PlannedObject
    from agents.protocol.facts import ObjectFacts, Vector
    from agents.protocol.findings import Finding

_AXES = "XYZ"
# What makes a mesh's faces out of what may come later: particles, instances.
_COPIES = frozenset({"PARTICLE_INSTANCE", "NODES", "EXPLODE", "BUILD"})
_SIMULATED = frozenset({"CLOTH", "SOFT_BODY", "FLUID_EFFECTOR", "FLUID_FLOW"})

_SCALES = frozenset({"scale", "delta_scale"})
_APPLY = "Apply the scale (bpy.ops.object.transform_apply, or write it into the mesh)."
# What to do instead where the scale changes over time.
_NOT_BELOW = "Let it stay above 0, and mirror the mesh itself."
_NOT_ZERO = "Let it stay above 0 (0.001 is too small to be seen), or key whether it is shown (hide_render)."
_NOT_SIMULATED = (
    "Give the mesh its size and leave the scale at 1: a solver takes no body whose scale changes."
)


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
        off = [
            _Extent(axis, size, wanted, most)
            for axis, size, wanted in zip(_AXES, sizes, planned.dimensions, strict=True)
            if abs(size - wanted) > (most := max(tolerances.dimension_share * wanted, tolerances.contact))
            and (size or wanted > tolerances.sheet)
        ]
        if off:
            worst = max(off, key=lambda extent: abs(extent.size - extent.wanted) / extent.most)
            yield R2.finding(
                (name,),
                f"{name!r} is {', '.join(extent.text for extent in off)}.",
                fix=_resizing(context, name, off),
                measured=worst.size,
                tolerance=worst.most,
                unit="m",
            )


class _Extent(NamedTuple):
    """How far an object reaches along an axis, and should, give or take ``most``."""

    axis: str
    size: float
    wanted: float
    most: float

    @property
    def text(self) -> str:
        """In words."""
        return f"{self.size:.3f} m along {self.axis} (the plan says {self.wanted:g} m)"


def _resizing(context: RuleContext, name: str, off: Sequence[_Extent]) -> str:
    """What to do about extents that are not the planned ones."""
    if not all(extent.size for extent in off):
        return R2.fix
    for mesh in context.structure.by_name[name].surfaces:
        if scaled := _scaled_by(context, mesh):
            return f"{scaled} Change it at the frame at which the size is measured, or change the meshes."
    factors = [f"{extent.wanted / extent.size:.3f}" for extent in off]
    if len(off) == len(_AXES) and len(set(factors)) == 1:
        by = factors[0]
    else:
        by = ", ".join(f"{factor} along {extent.axis}" for factor, extent in zip(factors, off, strict=True))
    return f"Scale the meshes of {name!r} by {by} (and apply the scale), or fix the modifier that changes the size."


def _scaled_by(context: RuleContext, name: str) -> str:
    """What changes the scale of an object over time, in a sentence; "" if nothing does."""
    for one in (name, *context.structure.parents_of(name)):
        item = context.structure.objects.get(one)
        if item is not None and not _SCALES.isdisjoint({*item.keys, *item.driven}):
            how = "set by a driver" if _SCALES.isdisjoint(item.keys) else "keyed"
            return f"The scale of {one!r} is {how}: to apply it would not hold beyond this frame."
    return ""


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
    scaled = _scaled_by(context, mesh.name)

    def fix(instead: str) -> str:
        return f"{scaled} {instead}" if scaled else _APPLY

    if any(value < 0 for value in mesh.scale):
        message = f"{mesh.name!r} has a negative scale, {_three(mesh.scale)}."
        yield R4.finding((mesh.name,), message, fix=fix(_NOT_BELOW), measured=min(mesh.scale), tolerance=0.0)
    elif np.linalg.det(matrix) < 0:
        parents = context.structure.parents_of(mesh.name)
        parent = next((name for name in parents if _mirrors(context, name)), None)
        by = f"by its parent {parent!r}" if parent else "by what it follows"
        objects = (mesh.name, *([parent] if parent else []))
        yield R4.finding(objects, f"{mesh.name!r} is mirrored {by}.", fix=fix(_NOT_BELOW))
    if not sizes.all():
        yield R4.finding((mesh.name,), f"{mesh.name!r} has scale 0.", fix=fix(_NOT_ZERO), measured=0.0)
    off = float(np.abs(sizes - 1).max())
    if _is_simulated(mesh) and off > context.tolerances.unit_scale:
        yield R4.finding(
            (mesh.name,),
            f"{mesh.name!r} is simulated, but its scale in the world is {_three(as_vector(sizes))}; solvers expect 1.",
            fix=fix(_NOT_SIMULATED),
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
