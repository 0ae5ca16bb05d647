# SPDX-License-Identifier: GPL-3.0-or-later
"""Where rigid bodies have their centre: at the object's origin, wherever the mesh is. Metres."""

from mathutils import Vector

from ..blend.fcurves import curves_of, varies

# Shapes that are centred on the origin too; the others follow the mesh, and only turn about it.
CENTRED_SHAPES = frozenset({"BOX", "SPHERE", "CAPSULE", "CYLINDER", "CONE"})


def is_kinematic(obj):
    """Whether its animation moves a body all the time: the solver moves one that is released during the timeline."""
    released = any(curve.data_path == "rigid_body.kinematic" and varies(curve) for curve in curves_of(obj))
    return bool(obj.rigid_body.kinematic) and not released


def off_centre(obj):
    """How far the middle of an object's bounds is from its origin."""
    low, high = _bounds(obj)
    return ((low + high) / 2).length


def origin_outside(obj):
    """How far the origin of a body is outside its own bounds; 0 where it is not that body's centre of mass.

    A compound has the shapes of its children, and they its centre.
    """
    if obj.rigid_body.collision_shape == "COMPOUND" or _is_part_of_compound(obj):
        return 0.0
    low, high = _bounds(obj)
    return Vector([max(least, -most, 0) for least, most in zip(low, high, strict=True)]).length


def _is_part_of_compound(obj):
    body = obj.parent.rigid_body if obj.parent is not None else None
    return body is not None and body.collision_shape == "COMPOUND"


def _bounds(obj):
    """The lowest and highest corner around an object's geometry, along its own axes and from its origin."""
    scale = obj.matrix_world.to_scale()
    along = tuple(zip(*(Vector(corner) * scale for corner in obj.bound_box), strict=True))
    return Vector(map(min, along)), Vector(map(max, along))
