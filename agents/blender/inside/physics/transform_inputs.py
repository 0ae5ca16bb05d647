# SPDX-License-Identifier: GPL-3.0-or-later
"""What an object's place follows from, whatever the frame: for comparing it at different times."""

from ..blend.fcurves import curves_of


def of_object(obj):
    """Its transform; if it is animated, its keys, since the transform changes with the frame."""
    animation = obj.animation_data
    if animation is not None and animation.action is not None:
        return [
            (curve.data_path, curve.array_index, [tuple(point.co) for point in curve.keyframe_points])
            for curve in curves_of(obj)
        ]
    return [tuple(row) for matrix in (obj.matrix_basis, obj.matrix_parent_inverse) for row in matrix]


def of_chain(obj):
    """The names and transforms of an object and of all that it is parented to."""
    inputs = []
    while obj is not None:
        inputs += [obj.name, of_object(obj)]
        obj = obj.parent
    return inputs
