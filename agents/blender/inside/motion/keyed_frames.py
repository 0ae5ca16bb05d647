# SPDX-License-Identifier: GPL-3.0-or-later
"""Where objects are keyed: the frames of the keyframes that move them, or the geometry that they have."""

from ..measure.scene_facts import curves_of


def keyed_frames(objects, start, end):
    """Frames from ``start`` to ``end`` with a key of these objects, their parents, armatures, data or shape keys."""
    found = set()
    for block in _animated(objects):
        for curve in curves_of(block):
            found.update(round(point.co[0]) for point in curve.keyframe_points)
    return sorted(frame for frame in found if start <= frame <= end)


def _animated(objects):
    """The data-blocks whose actions can move these objects."""
    seen = {}
    for thing in objects:
        above = thing
        while above is not None and above.name not in seen:
            seen[above.name] = above
            above = above.parent
        for modifier in thing.modifiers:
            if modifier.type == "ARMATURE" and modifier.object is not None:
                seen[modifier.object.name] = modifier.object
    for thing in seen.values():
        yield thing
        if thing.data is not None:
            yield thing.data
            if getattr(thing.data, "shape_keys", None) is not None:
                yield thing.data.shape_keys
