# SPDX-License-Identifier: GPL-3.0-or-later
"""Mesh objects. Each function makes an object of the given name whose mesh has the final size: its scale is 1.

``at`` is the origin: the middle of boxes, balls and cylinders, the foot of revolved objects. ``turn``: degrees around
x, y and z. Further arguments are its material, as ``scene_setup.paint`` takes them.
"""

import math
from itertools import pairwise

import bmesh
import bpy
from mathutils import Matrix, Vector

from .scene_setup import paint


def mesh(name, points, faces, at=(0, 0, 0), **look):
    """A mesh of points and faces."""
    data = bpy.data.meshes.new(name)
    data.from_pydata(points, [], faces)
    return _object(name, data, at, (0, 0, 0), look)


def box(name, size, at=(0, 0, 0), *, turn=(0, 0, 0), **look):
    """A box of ``size`` along x, y and z."""
    return _from_operator(
        name, at, turn, look, bmesh.ops.create_cube, size=1, matrix=Matrix.Diagonal((*size, 1))
    )


def boxes(name, parts, at=(0, 0, 0), *, turn=(0, 0, 0), **look):
    """Several boxes as one object: ``parts`` are (size, middle), from the object's origin."""
    bm = bmesh.new()
    for size, middle in parts:
        placed = Matrix.Translation(middle) @ Matrix.Diagonal((*size, 1))
        bmesh.ops.create_cube(bm, size=1, matrix=placed)
    return _from_bmesh(name, bm, at, turn, look)


def legs(x, y, height, thick=0.06):
    """For ``boxes``: four legs from the origin up, at the corners of a rectangle with half sides ``x`` and ``y``."""
    return [((thick, thick, height), (i, j, height / 2)) for i in (-x, x) for j in (-y, y)]


def prism(name, outline, width, at=(0, 0, 0), *, turn=(0, 0, 0), **look):
    """Extrudes an outline of (x, z) pairs to a solid of ``width`` along y, half to either side."""
    bm = bmesh.new()
    near, far = ([bm.verts.new((x, y, z)) for x, z in outline] for y in (-width / 2, width / 2))
    bm.faces.new(near)
    bm.faces.new(far)
    for this, after in pairwise([*range(len(outline)), 0]):
        bm.faces.new((near[this], near[after], far[after], far[this]))
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces)
    return _from_bmesh(name, bm, at, turn, look)


def ball(name, radius, at=(0, 0, 0), *, detail=3, **look):
    """A ball of even triangles."""
    obj = _from_operator(
        name, at, (0, 0, 0), look, bmesh.ops.create_icosphere, subdivisions=detail, radius=radius
    )
    return smooth(obj)


def cylinder(name, radius, height, at=(0, 0, 0), *, turn=(0, 0, 0), top=None, sides=32, **look):
    """A closed cylinder, or a cone with the radius ``top``."""
    return _from_operator(
        name, at, turn, look, bmesh.ops.create_cone, cap_ends=True, segments=sides, radius1=radius,
        radius2=radius if top is None else top, depth=height,
    )  # fmt: skip


def sheet(name, size, cells, at=(0, 0, 0), *, turn=(0, 0, 0), **look):
    """A flat sheet of ``size`` along x and y, in ``cells`` along each."""
    obj = _from_operator(
        name, at, turn, look, bmesh.ops.create_grid, x_segments=cells[0], y_segments=cells[1], size=0.5,
        matrix=Matrix.Diagonal((*size, 1, 1)),
    )  # fmt: skip
    return smooth(obj)


def block(name, size, cells, at=(0, 0, 0), *, turn=(0, 0, 0), **look):
    """A closed box whose sides are cut into ``cells`` along x, y and z, for meshes that deform."""
    obj = box(name, size, at, turn=turn, **look)
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    for axis, count in enumerate(cells):
        for cut in range(1, count):
            place, normal = Vector(), Vector()
            place[axis], normal[axis] = size[axis] * (cut / count - 0.5), 1
            bmesh.ops.bisect_plane(
                bm, geom=[*bm.verts, *bm.edges, *bm.faces], plane_co=place, plane_no=normal
            )
    bm.to_mesh(obj.data)
    bm.free()
    return obj


def revolved(name, profile, at=(0, 0, 0), *, sides=32, **look):
    """A profile of (radius, height) turned around Z.

    A profile that runs from the axis to the axis, or back to its beginning, gives a closed solid: a bowl goes up its
    outer side and down its inner one.
    """
    bm = bmesh.new()
    rings = []
    for radius, height in profile:
        if radius == 0:
            rings.append([bm.verts.new((0, 0, height))] * sides)
            continue
        turns = (2 * math.pi * number / sides for number in range(sides))
        rings.append([bm.verts.new((radius * math.cos(t), radius * math.sin(t), height)) for t in turns])
    for low, high in pairwise(rings):
        for side in range(sides):
            after = (side + 1) % sides
            bm.faces.new(dict.fromkeys((low[side], low[after], high[after], high[side])))
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces)
    return smooth(_from_bmesh(name, bm, at, (0, 0, 0), look))


def tube(name, points, radius, at=(0, 0, 0), *, sides=12, **look):
    """A round tube through points, closed at its ends."""
    points = [Vector(point) for point in points]
    bm = bmesh.new()
    rings = []
    for number, point in enumerate(points):
        along = points[min(number + 1, len(points) - 1)] - points[max(number - 1, 0)]
        turned = along.to_track_quat("Z", "Y")
        turns = (2 * math.pi * side / sides for side in range(sides))
        rings.append(
            [
                bm.verts.new(point + turned @ Vector((radius * math.cos(t), radius * math.sin(t), 0)))
                for t in turns
            ]
        )
    for low, high in pairwise(rings):
        for this in range(sides):
            after = (this + 1) % sides
            bm.faces.new((low[this], low[after], high[after], high[this]))
    bm.faces.new(rings[0][::-1])
    bm.faces.new(rings[-1])
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces)
    return _from_bmesh(name, bm, at, (0, 0, 0), look)


def joined(name, *objects):
    """Joins objects to one with one mesh, at the place of the first. The others are gone."""
    bpy.ops.object.select_all(action="DESELECT")
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]
    bpy.ops.object.join()
    objects[0].name = objects[0].data.name = name
    return objects[0]


def fused(name, cell, *objects, **look):
    """Fuses overlapping solids to one closed solid with even faces of about ``cell``."""
    obj = joined(name, *objects)
    obj.data.remesh_voxel_size = cell
    bpy.ops.object.voxel_remesh()
    return paint(smooth(obj), **look)


def smooth(obj):
    """Shades an object smooth, except at sharp edges."""
    obj.data.shade_smooth()
    obj.data.set_sharp_from_angle(angle=math.radians(40))
    return obj


def weigh(obj, group, condition, weight=1.0):
    """Makes a vertex group of the points for which ``chosen(point)`` holds, in local space. Returns its name."""
    indices = [point.index for point in obj.data.vertices if condition(point.co)]
    if not indices:
        raise ValueError(f"no point of {obj.name} is in its group {group}")
    obj.vertex_groups.new(name=group).add(indices, weight, "REPLACE")
    return group


def _from_operator(name, at, turn, look, create, **how):
    bm = bmesh.new()
    create(bm, **how)
    return _from_bmesh(name, bm, at, turn, look)


def _from_bmesh(name, bm, at, turn, look):
    data = bpy.data.meshes.new(name)
    bm.to_mesh(data)
    bm.free()
    return _object(name, data, at, turn, look)


def _object(name, data, at, turn, look):
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    obj.location = at
    obj.rotation_euler = [math.radians(angle) for angle in turn]
    bpy.context.view_layer.update()
    return paint(obj, **look)
