# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether what rigid bodies were simulated with is as it was when they were baked.

Blender calls the bake of a rigid-body world outdated as soon as its file is opened, or anything at all is changed about
a body. So what the bake depends on is remembered: of a file, as it was when it was opened.
"""

import hashlib
from array import array

import bpy
from bpy.app.handlers import persistent

_remembered = {}  # scene → what its bodies were when they were last known to be as they were baked


def watch():
    """Looks at the bodies of every file that is opened from now on."""
    if _note not in bpy.app.handlers.load_post:
        bpy.app.handlers.load_post.append(_note)


@persistent
def _note(*_):
    _remembered.clear()
    for scene in bpy.data.scenes:
        world = scene.rigidbody_world
        if world is not None and world.point_cache is not None and world.point_cache.is_baked:
            _remembered[_key(scene)] = _state(scene)


def is_outdated(scene):
    """Whether the bake of a scene's rigid-body world is older than what it depends on."""
    state = _state(scene)
    if not scene.rigidbody_world.point_cache.is_outdated:
        _remembered[_key(scene)] = state
    return _remembered.get(_key(scene)) != state


def _key(scene):
    return getattr(scene, "session_uid", scene.name)


def _state(scene):
    """A digest of what the simulation depends on."""
    world = scene.rigidbody_world
    found = [_settings(world), tuple(scene.gravity), scene.use_gravity]
    for collection in (world.collection, world.constraints):
        for thing in collection.objects if collection else ():
            found += [_settings(thing.rigid_body), _settings(thing.rigid_body_constraint), _shape(thing.data)]
            carrier = thing
            while carrier is not None:
                found += [carrier.name, _place(carrier)]
                carrier = carrier.parent
    return hashlib.sha256(repr(found).encode(errors="surrogateescape")).hexdigest()


def _settings(part):
    """Plain settings; of other objects, their names."""
    if part is None:
        return None
    found = {}
    for prop in part.bl_rna.properties:
        if not prop.is_readonly and prop.identifier != "kinematic":
            value = getattr(part, prop.identifier)
            plain = getattr(value, "name", None) if prop.type in {"POINTER", "COLLECTION"} else value
            found[prop.identifier] = tuple(plain) if getattr(prop, "is_array", False) else plain
    return found


def _place(thing):
    """Where it was put; of what is animated, its keys: its place changes with the frame."""
    animation = thing.animation_data
    if animation is not None and animation.action is not None:
        from ..measure.scene_facts import curves_of  # which needs this module itself

        return [
            (curve.data_path, curve.array_index, [tuple(point.co) for point in curve.keyframe_points])
            for curve in curves_of(thing)
        ]
    return [tuple(row) for matrix in (thing.matrix_basis, thing.matrix_parent_inverse) for row in matrix]


def _shape(data):
    """The corners of a mesh."""
    if not isinstance(data, bpy.types.Mesh):
        return None
    corners = array("f", bytes(12 * len(data.vertices)))
    data.vertices.foreach_get("co", corners)
    return hashlib.sha256(corners.tobytes()).hexdigest()
