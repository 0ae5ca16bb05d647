# SPDX-License-Identifier: GPL-3.0-or-later
"""The UV maps of meshes: a checker on each, its map as a picture, and bounds, stretch and overlap in numbers."""

import itertools
import math
import os
import struct
import zlib

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.named_objects import objects_named
from ..blend.names import quoted
from .fixed_views import SCENE, PreviewRenderer, copy_of
from .framing import VIEWS
from .material_colours import PreviewMaterial
from .studio_scene import StudioScene, drawing_engine

try:
    import numpy
except ImportError:
    numpy = None

_THREE_QUARTER = next(view for view in VIEWS if view[0] == "three-quarter")
_MOST_MESHES = 8
_MOST_TRIANGLES = 40_000  # whose overlap is measured
_CELLS = 192  # of a map's longer side, in which overlap is counted
_ASIDE = (0.5137, 0.4931)  # middle of a cell, nearly
_NARROW = 2.0  # times that a pattern is longer one way than the other, from which it counts as stretched
_NAMED = 8
_FAR = 1e6
_MAP_FILE = ".preview-{}.png"
_PAPER, _EVEN, _STRETCHED, _OVERLAP, _TILE = (
    (250, 250, 248),
    (120, 170, 205),
    (235, 180, 70),
    (205, 45, 45),
    (24, 26, 30),
)


def uv_sheet(arguments, report):
    """Renders a checker on each mesh of ``objects`` (none: those of the scene that have a map), ``size`` pixels wide.

    Returns ``meshes``, each with the names of its files and its numbers, the names ``without`` a map, and ``notes``.
    """
    if numpy is None:
        raise Refused("UV maps cannot be measured: this Blender's Python has no numpy.")
    scene, notes = bpy.context.scene, []
    with _CheckerStudio(drawing_engine(notes)) as studio:
        subject = copy_of(studio, SCENE, scene.name, None, notes)
        drawn = {piece.owner for piece in subject.pieces}
        mapped, without = _meshes(scene, arguments["objects"], drawn)
        alike = _distinct(mapped)
        once = list(alike)
        if len(once) > _MOST_MESHES:
            notes.append(f"Not shown: {quoted([obj.name for obj in once[_MOST_MESHES:]], _NAMED)}.")
        renderer = PreviewRenderer(studio, subject, arguments["folder"], arguments["size"])
        renderer.set_up(False, True, [])
        graph = bpy.context.evaluated_depsgraph_get()
        meshes = []
        with renderer.cleaned_up():
            for at, obj in enumerate(once[:_MOST_MESHES]):
                report(at, len(once), obj.name)
                facts, picture = _measured(obj, graph)
                file, _ = renderer.alone({obj.name}, _THREE_QUARTER[1], arguments["size"])
                meshes.append(
                    {
                        **facts,
                        "checker": file,
                        "map": None,
                        "alike": alike[obj][:_NAMED],
                        "alike_in_all": len(alike[obj]),
                    }
                )
                if picture is not None:
                    name = _MAP_FILE.format(500 + at)
                    _write_png(os.path.join(arguments["folder"], name), picture)
                    meshes[-1]["map"] = name
    return {"title": scene.name, "meshes": meshes, "without": without[: _NAMED * 4], "notes": notes}


class _CheckerStudio(StudioScene):
    """A studio in which everything has the same checker, by its UV map."""

    def material(self, surface):
        """The checker, whatever the surface."""
        del surface
        if not self._materials:
            self._grid = self.owned(bpy.data.images.new(".checker", 512, 512))
            self._grid.generated_type = "COLOR_GRID"
        return super().material(PreviewMaterial((0.6, 0.6, 0.6), image=self._grid))


def _meshes(scene, names, drawn):
    """(objects with a UV map, names of those without). Raises Refused for unknown names."""
    named = objects_named(scene, names)
    chosen = [obj for name in names for obj in named[name]] if names else list(scene.objects)
    meshes = [obj for obj in dict.fromkeys(chosen) if obj.type == "MESH" and obj.name in drawn]
    if not meshes:
        raise Refused("There is no mesh that renders show.")
    mapped = [obj for obj in meshes if obj.data.uv_layers.active]
    return mapped, sorted(obj.name for obj in meshes if obj not in mapped)


def _distinct(meshes):
    """{object: names of its copies}, those with most faces first."""
    groups = {}
    for obj in sorted(meshes, key=lambda obj: -len(obj.data.polygons)):
        groups.setdefault(_look(obj), []).append(obj)
    return {first: [other.name for other in others] for first, *others in groups.values()}


def _look(obj):
    """What copies of a mesh have in common, whether or not they share their data."""
    mesh = obj.data
    flat = numpy.empty(2 * len(mesh.loops), dtype=numpy.float32)
    mesh.uv_layers.active.data.foreach_get("uv", flat)
    size = tuple(float(f"{part:.4g}") for part in obj.dimensions)
    return (len(mesh.polygons), size, tuple(modifier.type for modifier in obj.modifiers), flat.tobytes())


def _measured(obj, graph):
    """(numbers, picture of the map or None) of a mesh's active map, with its modifiers."""
    evaluated = obj.evaluated_get(graph)
    mesh = evaluated.to_mesh()
    try:
        layer = mesh.uv_layers.active
        facts = {"name": obj.name, "uv_map": layer.name if layer else "", "maps": len(mesh.uv_layers)}
        if layer is None or not len(mesh.polygons):
            return {**facts, "faces": 0, "missing": True}, None
        mesh.calc_loop_triangles()
        loops = _read(mesh.loop_triangles, "loops", 3, numpy.int32)
        corners = _read(mesh.loop_triangles, "vertices", 3, numpy.int32)
        flat = _read(layer.data, "uv", 2)[loops]
        solid = _read(mesh.vertices, "co", 3) @ numpy.array(obj.matrix_world.to_3x3()).T
        facts["faces"] = len(mesh.polygons)
    finally:
        evaluated.to_mesh_clear()
    if not numpy.isfinite(flat).all() or abs(flat).max() > _FAR:
        return {**facts, "missing": True}, None
    numbers, stretched = _numbers(flat, solid[corners])
    picture, overlap = _map_picture(flat, stretched)
    return {**facts, **numbers, "overlap": overlap, "missing": False}, picture


def _read(items, name, width, kind=None):
    values = numpy.empty(width * len(items), dtype=kind or numpy.float32)
    items.foreach_get(name, values)
    return values.reshape(-1, width) if kind else values.reshape(-1, width).astype(float)


def _numbers(flat, solid):
    """(numbers of a map, which of its triangles are stretched), of corners in the map and in space."""
    first, second = solid[:, 1] - solid[:, 0], solid[:, 2] - solid[:, 0]
    areas = numpy.linalg.norm(numpy.cross(first, second), axis=1) / 2
    one, two = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    signed = (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]) / 2
    total = max(areas.sum(), 1e-30)
    # In the plane of each triangle, the map is a matrix; its singular values say how long the pattern is each way.
    length = numpy.maximum(numpy.linalg.norm(first, axis=1), 1e-15)
    along = (second * first).sum(axis=1) / length
    across = numpy.maximum(2 * areas / length, 1e-15)
    a, c = one[:, 0] / length, one[:, 1] / length
    b, d = (two[:, 0] - a * along) / across, (two[:, 1] - c * along) / across
    sum_of_squares, determinant = a * a + b * b + c * c + d * d, abs(a * d - b * c)
    root = numpy.sqrt(numpy.maximum(sum_of_squares**2 - 4 * determinant**2, 0))
    long, short = (
        numpy.sqrt((sum_of_squares + root) / 2),
        numpy.sqrt(numpy.maximum(sum_of_squares - root, 0) / 2),
    )
    collapsed = abs(signed) < 1e-9 * max(abs(signed).max(), 1e-12)
    narrow = numpy.where(collapsed, numpy.inf, long / numpy.maximum(short, 1e-15))
    stretched = narrow > _NARROW
    density = numpy.sqrt(determinant)
    shown = ~collapsed & (areas > 1e-12 * total)
    low, high = _percentiles(density[shown], areas[shown]) if shown.any() else (0.0, 0.0)
    outside = (flat.min(axis=1) < -1e-4).any(axis=1) | (flat.max(axis=1) > 1 + 1e-4).any(axis=1)
    numbers = {
        "low": [float(part) for part in flat.reshape(-1, 2).min(axis=0)],
        "high": [float(part) for part in flat.reshape(-1, 2).max(axis=0)],
        "outside": float(areas[outside].sum() / total),
        "stretched": float(areas[stretched & ~collapsed].sum() / total),
        "collapsed": float(areas[collapsed].sum() / total),
        "mirrored": float(areas[(signed < 0) & ~collapsed].sum() / total),
        "scale": [float(low), float(high)],
    }
    return numbers, stretched


def _percentiles(values, weights):
    """The values below which 5 and 95 % of the weight is."""
    order = numpy.argsort(values)
    reached = numpy.cumsum(weights[order]) / weights.sum()
    return tuple(
        values[order][min(int(numpy.searchsorted(reached, share)), len(values) - 1)] for share in (0.05, 0.95)
    )


def _map_picture(flat, stretched):
    """(rows of pixels, share of the covered area that is covered twice or more; None for maps of too many faces)."""
    if len(flat) > _MOST_TRIANGLES:
        return None, None
    low = numpy.minimum(flat.reshape(-1, 2).min(axis=0), 0)
    size = numpy.maximum(flat.reshape(-1, 2).max(axis=0), 1) - low
    cell = size.max() / (_CELLS - 1)
    counts = numpy.zeros((_CELLS, _CELLS), dtype=numpy.int32)
    marked = numpy.zeros((_CELLS, _CELLS), dtype=bool)
    places = (flat - low) / cell
    starts = numpy.ceil(places.min(axis=1) - 0.5).astype(int)
    ends = numpy.floor(places.max(axis=1) - 0.5).astype(int)
    for triangle, (x0, y0), (x1, y1), is_stretched in zip(places, starts, ends, stretched, strict=True):
        if x1 < x0 or y1 < y0:
            continue
        covered = _covered(triangle, x0, x1, y0, y1)
        counts[y0 : y1 + 1, x0 : x1 + 1] += covered
        if is_stretched:
            marked[y0 : y1 + 1, x0 : x1 + 1] |= covered
    picture = numpy.empty((_CELLS, _CELLS, 3), dtype=numpy.uint8)
    picture[:] = _PAPER
    picture[counts > 0] = _EVEN
    picture[marked] = _STRETCHED
    picture[counts > 1] = _OVERLAP
    edge = [round(float(part)) for pair in (-low / cell, (1 - low) / cell) for part in pair]
    left, bottom, right, top = (min(max(part, 0), _CELLS - 1) for part in edge)
    picture[[bottom, top], left : right + 1] = _TILE
    picture[bottom : top + 1, [left, right]] = _TILE
    used = (counts > 0).sum()
    return picture[::-1], float((counts > 1).sum() / used) if used else 0.0


def _covered(triangle, x0, x1, y0, y1):
    """Which cells' middles are inside a triangle. They are a little aside, so that hardly one is right on an edge."""
    x, y = numpy.meshgrid(numpy.arange(x0, x1 + 1) + _ASIDE[0], numpy.arange(y0, y1 + 1) + _ASIDE[1])
    (ax, ay), (bx, by), (cx, cy) = triangle
    turn = math.copysign(1.0, (bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
    inside = numpy.ones(x.shape, dtype=bool)
    for (px, py), (qx, qy) in itertools.pairwise((*triangle, triangle[0])):
        inside &= turn * ((qx - px) * (y - py) - (qy - py) * (x - px)) > 0
    return inside


def _write_png(path, picture):
    """Writes rows of RGB pixels."""
    height, width, _ = picture.shape
    rows = b"".join(b"\0" + picture[at].tobytes() for at in range(height))
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(rows)),
        (b"IEND", b""),
    )
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for kind, data in chunks:
            checksum = zlib.crc32(kind + data)
            file.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", checksum))
