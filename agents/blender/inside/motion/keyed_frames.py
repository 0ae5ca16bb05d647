# SPDX-License-Identifier: GPL-3.0-or-later
"""The keyframes of objects: the frames of keys that move them or their geometry."""

from ..blend.fcurves import curves_of


def keyed_frames(objects):
    """The frames with a key of these objects, their parents, armatures, data or shape keys, in order."""
    frames = set()
    for block in _animated(objects):
        for curve in curves_of(block):
            frames.update(round(point.co[0]) for point in curve.keyframe_points)
    return sorted(frames)


def _animated(objects):
    """The data-blocks whose actions can move these objects."""
    seen = {}
    for obj in objects:
        above = obj
        while above is not None and above.name not in seen:
            seen[above.name] = above
            above = above.parent
        for modifier in obj.modifiers:
            if modifier.type == "ARMATURE" and modifier.object is not None:
                seen[modifier.object.name] = modifier.object
    for obj in seen.values():
        yield obj
        if obj.data is not None:
            yield obj.data
            if getattr(obj.data, "shape_keys", None) is not None:
                yield obj.data.shape_keys
