# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the inputs of a rigid-body simulation are still those of its bake.

Blender marks the bake of a rigid-body world as outdated as soon as its file is opened, or anything about a body
changes, and no longer once the old bake has been played. So a digest of what the bake depends on is kept, from when
it was made; for a file with a bake, from when it was opened.
"""

import hashlib
from array import array

import bpy
from bpy.app.handlers import persistent

from . import transform_inputs

_remembered = {}  # scene → digest of the inputs when they last matched the bake


def watch():
    """Remembers the inputs of every file that is opened from now on, and follows what becomes of its bakes."""
    if _note not in bpy.app.handlers.load_post:
        bpy.app.handlers.load_post.append(_note)
    if _follow not in bpy.app.handlers.frame_change_post:
        bpy.app.handlers.frame_change_post.append(_follow)


@persistent
def _note(*_):
    _remembered.clear()
    for scene in bpy.data.scenes:
        points = _points(scene)
        if points is not None and points.is_baked:
            _remembered[_key(scene)] = _inputs_digest(scene)


@persistent
def _follow(scene, _graph=None):
    """Forgets the inputs of a bake that is freed or made anew, and remembers those of the new one once it is made."""
    points = _points(scene)
    if points is None or not points.is_baked:
        _remembered.pop(_key(scene), None)
    elif _key(scene) not in _remembered and not points.is_outdated:
        _remembered[_key(scene)] = _inputs_digest(scene)


def _points(scene):
    world = scene.rigidbody_world
    return world.point_cache if world is not None else None


def is_outdated(scene):
    """Whether the bake of a scene's rigid-body world is older than what it depends on."""
    state = _inputs_digest(scene)
    is_followed = _follow in bpy.app.handlers.frame_change_post
    if not _points(scene).is_outdated and not (is_followed and _key(scene) in _remembered):
        _remembered[_key(scene)] = state
    return _remembered.get(_key(scene)) != state


def _key(scene):
    return getattr(scene, "session_uid", scene.name)


def _inputs_digest(scene):
    """A digest of what the simulation depends on."""
    world = scene.rigidbody_world
    inputs = [_settings(world), tuple(scene.gravity), scene.use_gravity]
    for collection in (world.collection, world.constraints):
        for obj in collection.objects if collection else ():
            inputs += [
                _settings(obj.rigid_body),
                _settings(obj.rigid_body_constraint),
                _mesh_digest(obj.data),
            ]
            inputs += transform_inputs.of_chain(obj)
    return hashlib.sha256(repr(inputs).encode(errors="surrogateescape")).hexdigest()


def _settings(part):
    """The settings of a struct; for pointers, names."""
    if part is None:
        return None
    settings = {}
    for prop in part.bl_rna.properties:
        if not prop.is_readonly and prop.identifier != "kinematic":
            value = getattr(part, prop.identifier)
            plain = getattr(value, "name", None) if prop.type in {"POINTER", "COLLECTION"} else value
            settings[prop.identifier] = tuple(plain) if getattr(prop, "is_array", False) else plain
    return settings


def _mesh_digest(data):
    """A digest of a mesh's vertices; None for other data."""
    if not isinstance(data, bpy.types.Mesh):
        return None
    coordinates = array("f", bytes(12 * len(data.vertices)))
    data.vertices.foreach_get("co", coordinates)
    return hashlib.sha256(coordinates.tobytes()).hexdigest()
