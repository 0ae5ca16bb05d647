# SPDX-License-Identifier: GPL-3.0-or-later
"""Things made of meshes. Each function gives an object of that name whose mesh has its size: its scale is 1.

``at`` is the thing's origin: of boxes, balls and cylinders their middle, of revolved ones their foot. ``turn``: degrees
around x, y and z. What is said of a thing beyond its shape is its look, as ``stage.paint`` takes it.
"""

import math
from itertools import pairwise

import bmesh
import bpy
from mathutils import Matrix, Vector

from .stage import paint


def mesh(name, points, faces, at=(0, 0, 0), **look):
    """A mesh of points and faces."""
    data = bpy.data.meshes.new(name)
    data.from_pydata(points, [], faces)
    return _thing(name, data, at, (0, 0, 0), look)


def box(name, size, at=(0, 0, 0), *, turn=(0, 0, 0), **look):
    """A box of ``size`` along x, y and z."""
    return _made(name, at, turn, look, bmesh.ops.create_cube, size=1, matrix=Matrix.Diagonal((*size, 1)))


def boxes(name, parts, at=(0, 0, 0), *, turn=(0, 0, 0), **look):
    """Several boxes as one thing: ``parts`` are (size, middle), as seen from the thing's origin."""
    made = bmesh.new()
    for size, middle in parts:
        placed = Matrix.Translation(middle) @ Matrix.Diagonal((*size, 1))
        bmesh.ops.create_cube(made, size=1, matrix=placed)
    return _finished(name, made, at, turn, look)


def legs(x, y, height, thick=0.06):
    """For ``boxes``: four legs of that height from the origin upwards, at the corners of a rectangle of half sides."""
    return [((thick, thick, height), (i, j, height / 2)) for i in (-x, x) for j in (-y, y)]


def prism(name, outline, width, at=(0, 0, 0), *, turn=(0, 0, 0), **look):
    """An outline in the plane of x and z, pairs of these, as a solid of that ``width`` along y, half to either side."""
    made = bmesh.new()
    near, far = ([made.verts.new((x, y, z)) for x, z in outline] for y in (-width / 2, width / 2))
    made.faces.new(near)
    made.faces.new(far)
    for one, after in pairwise([*range(len(outline)), 0]):
        made.faces.new((near[one], near[after], far[after], far[one]))
    bmesh.ops.recalc_face_normals(made, faces=made.faces)
    return _finished(name, made, at, turn, look)


def ball(name, radius, at=(0, 0, 0), *, detail=3, **look):
    """A ball of even triangles."""
    thing = _made(name, at, (0, 0, 0), look, bmesh.ops.create_icosphere, subdivisions=detail, radius=radius)
    return smooth(thing)


def cylinder(name, radius, height, at=(0, 0, 0), *, turn=(0, 0, 0), top=None, sides=32, **look):
    """A closed cylinder, or a cone with the radius ``top``."""
    return _made(
        name, at, turn, look, bmesh.ops.create_cone, cap_ends=True, segments=sides, radius1=radius,
        radius2=radius if top is None else top, depth=height,
    )  # fmt: skip


def sheet(name, size, cells, at=(0, 0, 0), *, turn=(0, 0, 0), **look):
    """A flat sheet of ``size`` along x and y, in ``cells`` along each."""
    thing = _made(
        name, at, turn, look, bmesh.ops.create_grid, x_segments=cells[0], y_segments=cells[1], size=0.5,
        matrix=Matrix.Diagonal((*size, 1, 1)),
    )  # fmt: skip
    return smooth(thing)


def block(name, size, cells, at=(0, 0, 0), *, turn=(0, 0, 0), **look):
    """A closed box whose sides are cut into ``cells`` along x, y and z, as what deforms needs it."""
    thing = box(name, size, at, turn=turn, **look)
    made = bmesh.new()
    made.from_mesh(thing.data)
    for axis, count in enumerate(cells):
        for cut in range(1, count):
            place, normal = Vector(), Vector()
            place[axis], normal[axis] = size[axis] * (cut / count - 0.5), 1
            bmesh.ops.bisect_plane(
                made, geom=[*made.verts, *made.edges, *made.faces], plane_co=place, plane_no=normal
            )
    made.to_mesh(thing.data)
    made.free()
    return thing


def revolved(name, profile, at=(0, 0, 0), *, sides=32, **look):
    """What a profile of (radius, height) makes when it turns around Z.

    A profile that runs from the axis to the axis, or back to its beginning, gives a closed solid: a bowl goes up its
    outer side and down its inner one.
    """
    made = bmesh.new()
    rings = []
    for radius, height in profile:
        if radius == 0:
            rings.append([made.verts.new((0, 0, height))] * sides)
            continue
        turns = (2 * math.pi * number / sides for number in range(sides))
        rings.append([made.verts.new((radius * math.cos(t), radius * math.sin(t), height)) for t in turns])
    for low, high in pairwise(rings):
        for one in range(sides):
            two = (one + 1) % sides
            made.faces.new(dict.fromkeys((low[one], low[two], high[two], high[one])))
    bmesh.ops.recalc_face_normals(made, faces=made.faces)
    return smooth(_finished(name, made, at, (0, 0, 0), look))


def tube(name, points, radius, at=(0, 0, 0), *, sides=12, **look):
    """A round tube through points, closed at its ends."""
    points = [Vector(point) for point in points]
    made = bmesh.new()
    rings = []
    for number, point in enumerate(points):
        along = points[min(number + 1, len(points) - 1)] - points[max(number - 1, 0)]
        turned = along.to_track_quat("Z", "Y")
        turns = (2 * math.pi * side / sides for side in range(sides))
        rings.append(
            [
                made.verts.new(point + turned @ Vector((radius * math.cos(t), radius * math.sin(t), 0)))
                for t in turns
            ]
        )
    for low, high in pairwise(rings):
        for one in range(sides):
            two = (one + 1) % sides
            made.faces.new((low[one], low[two], high[two], high[one]))
    made.faces.new(rings[0][::-1])
    made.faces.new(rings[-1])
    bmesh.ops.recalc_face_normals(made, faces=made.faces)
    return _finished(name, made, at, (0, 0, 0), look)


def joined(name, *things):
    """Several things as one: one object with one mesh, at the place of the first. The others are gone."""
    bpy.ops.object.select_all(action="DESELECT")
    for thing in things:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = things[0]
    bpy.ops.object.join()
    things[0].name = things[0].data.name = name
    return things[0]


def fused(name, cell, *things, **look):
    """Solids that overlap, as one closed solid of even faces of about ``cell``."""
    thing = joined(name, *things)
    thing.data.remesh_voxel_size = cell
    bpy.ops.object.voxel_remesh()
    return paint(smooth(thing), **look)


def smooth(thing):
    """Shades a thing smoothly, but for its edges."""
    thing.data.shade_smooth()
    thing.data.set_sharp_from_angle(angle=math.radians(40))
    return thing


def weigh(thing, group, chosen, weight=1.0):
    """A vertex group of the points for which ``chosen(point)`` holds, in the thing's own space. Gives its name."""
    found = [point.index for point in thing.data.vertices if chosen(point.co)]
    if not found:
        raise ValueError(f"no point of {thing.name} is in its group {group}")
    thing.vertex_groups.new(name=group).add(found, weight, "REPLACE")
    return group


def _made(name, at, turn, look, create, **how):
    made = bmesh.new()
    create(made, **how)
    return _finished(name, made, at, turn, look)


def _finished(name, made, at, turn, look):
    data = bpy.data.meshes.new(name)
    made.to_mesh(data)
    made.free()
    return _thing(name, data, at, turn, look)


def _thing(name, data, at, turn, look):
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    thing.location = at
    thing.rotation_euler = [math.radians(angle) for angle in turn]
    bpy.context.view_layer.update()
    return paint(thing, **look)
