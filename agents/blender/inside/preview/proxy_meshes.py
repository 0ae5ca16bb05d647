# SPDX-License-Identifier: GPL-3.0-or-later
"""Proxy meshes for what has no surface: strands, particles, smoke."""

import bpy
from mathutils import Vector

_MOST_SEGMENTS = 40_000
_MOST_BEADS = 12_000
_MOST_CELLS = 40  # along an axis of a gas, when drawn
_THIN = 0.02  # density from which gas is drawn
_HOT = 0.1
_OCTAHEDRON = [
    Vector(corner) for corner in ((1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
]
_OCTAHEDRON_FACES = ((0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4), (1, 0, 5), (2, 1, 5), (3, 2, 5), (0, 3, 5))
_SIDES = (
    ((1, 0, 0), ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1))),
    ((-1, 0, 0), ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0))),
    ((0, 1, 0), ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0))),
    ((0, -1, 0), ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1))),
    ((0, 0, 1), ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))),
    ((0, 0, -1), ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0))),
)


def tubes(segments, thickness):
    """Three-sided tubes along line segments (pairs of points); None if there are none."""
    points, faces = [], []
    for count, (start, end) in enumerate(segments):
        along = end - start
        if count >= _MOST_SEGMENTS or not along.length:
            continue
        aside = along.orthogonal().normalized() * (thickness / 2)
        across = along.normalized().cross(aside)
        ring = (aside, across * 0.87 - aside * 0.5, across * -0.87 - aside * 0.5)
        at = len(points)
        points += [start + way for way in ring] + [end + way for way in ring]
        faces += [(at + i, at + (i + 1) % 3, at + 3 + (i + 1) % 3, at + 3 + i) for i in range(3)]
        faces += [(at + 2, at + 1, at), (at + 3, at + 4, at + 5)]
    return _mesh(points, faces)


def octahedra(spots):
    """An octahedron at each of the spots (place, radius); None if there are none."""
    points, faces = [], []
    for place, radius in spots[:: max(1, -(-len(spots) // _MOST_BEADS))]:
        at = len(points)
        points += [place + corner * radius for corner in _OCTAHEDRON]
        faces += [tuple(at + i for i in face) for face in _OCTAHEDRON_FACES]
    return _mesh(points, faces)


def gas_cells(density, flame, across, box):
    """The surface of a gas's cells that are not empty, flames with material 1; None if all are empty.

    ``density`` and ``flame`` are flat grids of ``across`` cells in ``box`` (eight corners, as of an object).
    """
    if len(density) != across[0] * across[1] * across[2]:
        return None
    density = list(density)
    hot = list(flame) if len(flame) == len(density) else None
    step = max(1, -(-max(across) // _MOST_CELLS))
    low, high = Vector(box[0]), Vector(box[6])
    size = [(high[axis] - low[axis]) / across[axis] for axis in range(3)]
    filled = {}
    for z in range(0, across[2], step):
        for y in range(0, across[1], step):
            row = (z * across[1] + y) * across[0]
            for x in range(0, across[0], step):
                burning = hot is not None and hot[row + x] > _HOT
                if burning or density[row + x] > _THIN:
                    filled[x // step, y // step, z // step] = burning
    points, faces, numbers, materials = [], [], {}, []
    for (x, y, z), burning in filled.items():
        for (dx, dy, dz), side in _SIDES:
            if (x + dx, y + dy, z + dz) in filled:
                continue
            face = []
            for i, j, k in side:
                corner = (x + i, y + j, z + k)
                if corner not in numbers:
                    numbers[corner] = len(points)
                    points.append(low + Vector(size[axis] * step * corner[axis] for axis in range(3)))
                face.append(numbers[corner])
            faces.append(face)
            materials.append(int(burning))
    mesh = _mesh(points, faces)
    if mesh is not None:
        mesh.polygons.foreach_set("material_index", materials)
        mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
    return mesh


def _mesh(points, faces):
    if not faces:
        return None
    mesh = bpy.data.meshes.new(".preview")
    mesh.from_pydata([tuple(point) for point in points], [], [tuple(face) for face in faces])
    return mesh
