# SPDX-License-Identifier: GPL-3.0-or-later
"""Sizes of geometry as each modifier would make it, from stored data and settings alone."""

import math
from dataclasses import dataclass, replace

import numpy

MOST_POINTS = 20_000_000  # faces and points of all objects, after their modifiers
MOST_CELLS = 200_000_000  # of one grid: of a fluid, an ocean, a volume
CELLS = "grid cells"
_ENDLESS = 10**30
_LETTER_POINTS = 16  # control points of a letter's outline, about
_META_SCALE = 2.0  # a metaball's surface, in radii


class TooLarge(Exception):  # noqa: N818 - reads as the state it names
    """``setting`` (in words) would make ``count`` of ``unit``; at most ``most`` are allowed."""

    def __init__(self, setting, count, unit, most):
        super().__init__(setting)
        self.setting, self.count, self.unit, self.most = setting, count, unit, most


@dataclass(frozen=True)
class Size:
    """How much geometry there is. ``extent``: of its bounds along x, y and z. ``instances``: what nodes show as
    instances, ``inside``: how much geometry these have in all.
    """

    vertices: int = 0
    edges: int = 0
    faces: int = 0
    corners: int = 0
    extent: tuple = (0.0, 0.0, 0.0)
    instances: int = 0
    inside: int = 0

    @property
    def points(self):
        """What counts toward the limit."""
        return max(self.vertices, self.edges // 2, self.faces)

    @property
    def unit(self):
        """What ``points`` are."""
        return "faces" if self.faces and self.faces >= self.vertices // 2 else "points"

    def times(self, count):
        """So many copies of it."""
        return replace(
            self,
            vertices=self.vertices * count,
            edges=self.edges * count,
            faces=self.faces * count,
            corners=self.corners * count,
            instances=self.instances * count,
            inside=self.inside * count,
        )

    def joined(self, other):
        """Both."""
        return Size(
            self.vertices + other.vertices,
            self.edges + other.edges,
            self.faces + other.faces,
            self.corners + other.corners,
            tuple(map(max, self.extent, other.extent)),
            self.instances + other.instances,
            self.inside + other.inside,
        )

    def checked(self, setting):
        """Itself. Raises TooLarge if it is beyond the limit."""
        if self.points > MOST_POINTS:
            raise TooLarge(setting, self.points, self.unit, MOST_POINTS)
        return self


def ratio(length, step):
    """How many steps a length has; endless if that cannot be told."""
    if not (math.isfinite(length) and math.isfinite(step)) or step <= 0:
        return _ENDLESS
    return min(_ENDLESS, math.ceil(abs(length) / step))


def quads(count, extent=(0.0, 0.0, 0.0)):
    """A surface of so many four-sided faces."""
    return Size(count, 2 * count, count, 4 * count, extent)


def check_cells(setting, count):
    """Raises TooLarge for a grid beyond the limit."""
    if count > MOST_CELLS:
        raise TooLarge(setting, count, CELLS, MOST_CELLS)


def subdivided(size, levels):
    """After subdivision: each face becomes as many as it has corners, then each of them four, and so on."""
    for _ in range(levels):
        size = replace(
            size,
            vertices=size.vertices + size.edges + size.faces,
            edges=2 * size.edges + size.corners,
            faces=size.corners,
            corners=4 * size.corners,
        )
        if size.points > MOST_POINTS << 64:
            break  # enough to refuse it; the true number may have millions of digits
    return size


# What is stored


def base_size(obj, setup):
    """The size of an object's own data, before its modifiers. Raises TooLarge. ``setup``: as for ``grown``."""
    read = _BASES.get(obj.type)
    if read is None or obj.data is None:
        return Size()
    return setup.once((read, obj.data), lambda: read(obj, obj.data, setup))


def _mesh(_obj, mesh, _setup):
    size = Size(
        len(mesh.vertices), len(mesh.edges), len(mesh.polygons), len(mesh.loops), _extent(mesh.vertices)
    )
    return size.checked("its mesh")


def _extent(points, width=3):
    if not len(points):
        return 0.0, 0.0, 0.0
    flat = numpy.empty(width * len(points), dtype=numpy.float32)
    points.foreach_get("co", flat)
    rows = flat.reshape(-1, width)[:, :3].astype(numpy.float64)
    return tuple((rows.max(axis=0) - rows.min(axis=0)).tolist())


def _curve(obj, curve, setup):
    size = Size()
    for spline in curve.splines:
        along, across = spline.resolution_u, spline.resolution_v
        if setup.render:
            along, across = curve.render_resolution_u or along, curve.render_resolution_v or across
        along, across = max(along, setup.high(curve, "resolution_u"), 1), max(across, 1)
        if spline.type == "BEZIER":
            count, extent = len(spline.bezier_points) * along, _extent(spline.bezier_points)
        else:
            bent = spline.type != "POLY"
            count, extent = len(spline.points) * (along if bent else 1), _extent(spline.points, 4)
            if obj.type == "SURFACE":
                count *= across if bent else 1
        size = size.joined(
            quads(count, extent) if obj.type == "SURFACE" else Size(count, count, 0, 0, extent)
        )
    size = size.checked(f"resolution {_resolution(curve, setup)}")
    return _with_bevel(size, curve, setup)


def _text(_obj, text, setup):
    count = len(text.body) * _LETTER_POINTS * _resolution(text, setup)
    extent = (len(text.body) * text.size, text.size, 2 * text.extrude)
    return _with_bevel(Size(count, count, count, 3 * count, extent), text, setup)


def _resolution(curve, setup):
    return max(1, (curve.render_resolution_u if setup.render else 0) or setup.high(curve, "resolution_u"))


def _with_bevel(size, curve, setup):
    """A curve with its tube."""
    ring = 2 if curve.extrude else 0
    if curve.bevel_mode == "OBJECT":
        profile = curve.bevel_object
        if profile is not None and profile.type == "CURVE":
            ring = setup.once((_outline, profile.data), lambda: _outline(profile.data))
    elif setup.high(curve, "bevel_depth"):
        ring += 4 * (max(setup.high(curve, "bevel_resolution"), 0) + 1)
    if not ring:
        return size
    setting = f"bevel resolution {curve.bevel_resolution}, resolution {curve.resolution_u}"
    return quads(size.vertices * ring, size.extent).checked(setting)


def _outline(curve):
    """How many points a curve has, without a tube."""
    return sum(
        max(1, len(spline.bezier_points), len(spline.points)) * spline.resolution_u
        for spline in curve.splines
    )


def _metaballs(_obj, ball, setup):
    step = setup.low(ball, "render_resolution" if setup.render else "resolution")
    count = 0
    for element in ball.elements:
        longest = max(1.0, element.size_x, element.size_y, element.size_z)
        count += 6 * ratio(_META_SCALE * element.radius * longest, step) ** 2
    return quads(count).checked(f"resolution {step:g}")


def _hair(_obj, curves, _setup):
    return Size(len(curves.points), len(curves.points))


def _points(_obj, cloud, _setup):
    return Size(len(cloud.points))


def _strokes(_obj, data, _setup):
    """Grease pencil: the points of the drawing that has most of them, in every layer."""
    count = 0
    for layer in data.layers:
        drawings = [frame.drawing for frame in layer.frames if hasattr(frame, "drawing")]
        sizes = [d.attributes.domain_size("POINT") for d in drawings if hasattr(d, "attributes")]
        count += max(sizes, default=0)
    return Size(count, count)


_BASES = {
    "MESH": _mesh,
    "CURVE": _curve,
    "SURFACE": _curve,
    "FONT": _text,
    "META": _metaballs,
    "CURVES": _hair,
    "POINTCLOUD": _points,
    "GREASEPENCIL": _strokes,
}


# Modifiers


def grown(size, modifier, setup):
    """The size after a modifier; of a type that adds nothing, the size before. Raises TooLarge.

    ``setup``: ``render``, ``most_levels`` of subdivision, ``high`` and ``low``: the extremes of a setting in the clip,
    ``once(key, work)``: the result of work that is done once per key.
    """
    grow = _GROWTH.get(modifier.type)
    if grow is None:
        return size
    size, setting = grow(size, modifier, setup)
    return size.checked(setting)


def _subdivision(size, modifier, setup):
    levels = setup.high(modifier, "render_levels" if setup.render else "levels")
    levels = min(levels, setup.most_levels)
    return subdivided(size, levels), f"{levels} levels"


def _array(size, modifier, setup):
    count = max(1, setup.high(modifier, "count"))
    step = [0.0, 0.0, 0.0]
    if modifier.use_constant_offset:
        step = list(modifier.constant_offset_displace)
    if modifier.use_relative_offset:
        relative = modifier.relative_offset_displace
        step = [at + share * length for at, share, length in zip(step, relative, size.extent, strict=True)]
    if modifier.use_object_offset and modifier.offset_object is not None:
        matrix = modifier.id_data.matrix_world.inverted_safe() @ modifier.offset_object.matrix_world
        step = [at + more for at, more in zip(step, matrix.translation, strict=True)]
    setting = f"count {count:,}"
    if modifier.fit_type != "FIXED_COUNT":
        length = setup.high(modifier, "fit_length")
        if modifier.fit_type == "FIT_CURVE":
            curve = modifier.curve
            length = setup.once((_length_of, curve), lambda: _length_of(curve))
        apart = math.dist(step, (0.0, 0.0, 0.0))
        count = 1 if apart < 1e-6 else ratio(length, apart) + 1
        setting = f"length {length:g} in steps of {apart:g}"
    extent = tuple(length + abs(at) * (count - 1) for length, at in zip(size.extent, step, strict=True))
    size = replace(size.times(count), extent=extent)
    for cap in (modifier.start_cap, modifier.end_cap):
        if cap is not None:
            size = size.joined(base_size(cap, setup))
    return size, setting


def _length_of(curve):
    if curve is None or curve.type != "CURVE":
        return 0.0
    scale = max(curve.matrix_world.to_scale(), key=abs)
    return abs(scale) * sum(spline.calc_length() for spline in curve.data.splines)


def _mirror(size, modifier, _setup):
    axes = sum(modifier.use_axis)
    wider = tuple(
        2 * length if used else length for length, used in zip(size.extent, modifier.use_axis, strict=True)
    )
    return replace(size.times(2**axes), extent=wider), f"{axes} axes"


def _screw(size, modifier, setup):
    steps = max(1, setup.high(modifier, "render_steps" if setup.render else "steps"))
    iterations = max(1, setup.high(modifier, "iterations"))
    turns = steps * iterations
    grown_size = Size(
        size.vertices * (turns + 1),
        size.edges * (turns + 1) + size.vertices * turns,
        size.edges * turns,
        4 * size.edges * turns,
        tuple(2 * max(size.extent) + abs(modifier.screw_offset) * iterations for _ in range(3)),
    )
    return grown_size, f"{steps:,} steps, {iterations:,} iterations"


def _solidify(size, _modifier, _setup):
    return replace(size.times(2), faces=2 * size.faces + size.edges // 2), "thickness"


def _bevel(size, modifier, setup):
    segments = max(1, setup.high(modifier, "segments"))
    faces = size.faces + size.edges * segments + 2 * size.edges * (segments * segments // 4 + 1)
    return quads(faces, size.extent), f"{segments:,} segments"


def _remesh(size, modifier, setup):
    if modifier.mode != "VOXEL":
        depth = max(1, setup.high(modifier, "octree_depth"))
        return quads(6 * 4**depth, size.extent), f"octree depth {depth}"
    if modifier.voxel_size <= 0:
        return size, ""  # Blender does not do it either
    step = setup.low(modifier, "voxel_size")
    x, y, z = (ratio(length, step) + 1 for length in size.extent)
    return quads(2 * (x * y + y * z + z * x), size.extent), f"voxel size {step:g}"


def _decimate(size, modifier, _setup):
    if modifier.decimate_type != "COLLAPSE":
        return size, ""
    return replace(size, faces=int(size.faces * modifier.ratio) + 1), ""


def _wireframe(size, _modifier, _setup):
    return quads(4 * size.edges, size.extent), "one tube per edge"


def _skin(size, _modifier, _setup):
    return quads(4 * size.edges + 4 * size.vertices, size.extent), "its skin"


def _ocean(size, modifier, setup):
    resolution = setup.high(modifier, "resolution" if setup.render else "viewport_resolution")
    across, setting = resolution**2, f"resolution {resolution}"
    check_cells(setting, across * across)
    if modifier.geometry_mode != "GENERATE":
        return size, ""
    along, aside = (max(1, setup.high(modifier, name)) for name in ("repeat_x", "repeat_y"))
    return quads(across * across * along * aside), f"{setting}, repeated {along} × {aside}"


def _fluid(size, modifier, setup):
    domain = modifier.domain_settings if modifier.fluid_type == "DOMAIN" else None
    if domain is not None:
        finest = setup.high(domain, "resolution_max")
        setting = f"{finest} divisions"
        if domain.use_noise:
            finest, setting = (
                finest * domain.noise_scale,
                f"{setting}, noise {domain.noise_scale} times as fine",
            )
        scale = modifier.id_data.matrix_world.to_scale()
        extent = [abs(length * by) for length, by in zip(size.extent, scale, strict=True)]
        longest = max(extent, default=0.0)
        shares = [length / longest if longest > 0 else 1.0 for length in extent]
        check_cells(setting, math.prod(max(1, math.ceil(finest * share)) for share in shares))
    return size, ""


def _to_volume(size, modifier, setup):
    mesh = modifier.object
    extent = _extent(mesh.data.vertices) if mesh is not None and mesh.type == "MESH" else size.extent
    if modifier.resolution_mode == "VOXEL_AMOUNT":
        amount = max(1, setup.high(modifier, "voxel_amount"))
        step, setting = max(extent) / amount, f"{amount:,} voxels"
    else:
        step = setup.low(modifier, "voxel_size")
        setting = f"voxel size {step:g}"
    if step > 0:
        check_cells(setting, math.prod(ratio(length, step) + 1 for length in extent))
    return size, setting


def _strokes_repeated(size, modifier, setup):
    count = max(1, setup.high(modifier, "count"))
    return size.times(count), f"count {count:,}"


def _strokes_subdivided(size, modifier, setup):
    level = max(0, setup.high(modifier, "level"))
    return size.times(2**level), f"level {level}"


def _strokes_multiplied(size, modifier, setup):
    count = max(0, setup.high(modifier, "duplicates"))
    return size.times(1 + count), f"{count} duplicates"


_GROWTH = {
    "SUBSURF": _subdivision,
    "MULTIRES": _subdivision,
    "ARRAY": _array,
    "MIRROR": _mirror,
    "SCREW": _screw,
    "SOLIDIFY": _solidify,
    "BEVEL": _bevel,
    "REMESH": _remesh,
    "DECIMATE": _decimate,
    "WIREFRAME": _wireframe,
    "SKIN": _skin,
    "OCEAN": _ocean,
    "FLUID": _fluid,
    "MESH_TO_VOLUME": _to_volume,
    "GREASE_PENCIL_ARRAY": _strokes_repeated,
    "GREASE_PENCIL_SUBDIV": _strokes_subdivided,
    "GREASE_PENCIL_MULTIPLY": _strokes_multiplied,
}
