# SPDX-License-Identifier: GPL-3.0-or-later
"""Adds what a scene must not have: keyed motion, animated shapes, mesh caches, physics in a static scene."""

import bpy

_STEP = 0.0005  # of the scene's units: enough to be motion, too little for anyone to see
_NEAR = 1e-3


def key_every_frame(objects):
    """Keys the location of an object at every frame, half a millimetre a step."""
    obj = objects[0]
    place = obj.location.copy()
    for frame in _clip():
        obj.location.z = place.z + _STEP * (frame % 8)
        obj.keyframe_insert("location", frame=frame)
    return [obj]


def animate_shape_key(objects):
    """Blends a mesh into another shape key by two keys."""
    obj = next((each for each in objects if each.type in {"MESH", "CURVE", "SURFACE", "LATTICE"}), None)
    if obj is None:
        return []
    if obj.data.shape_keys is None:
        obj.shape_key_add(name="Basis")
    shape = obj.shape_key_add(name="Other", from_mix=False)
    shape.data[0].co.z += _NEAR
    first, *_, last = _clip()
    for frame, value in ((first, 0.0), (last, 1.0)):
        shape.value = value
        shape.keyframe_insert("value", frame=frame)
    return [obj]


def add_mesh_cache(objects):
    """Adds a mesh cache modifier that plays a file."""
    obj = next((each for each in objects if each.type == "MESH"), None)
    if obj is None:
        return []
    obj.modifiers.new("Recorded", "MESH_CACHE").filepath = "//recorded.pc2"
    return [obj]


def add_bake(objects):
    """Bakes a rigid-body world, then removes its only body."""
    [obj] = add_body(objects)
    world = bpy.context.scene.rigidbody_world
    with bpy.context.temp_override(point_cache=world.point_cache):
        bpy.ops.ptcache.bake(bake=True)
    world.collection.objects.unlink(obj)
    return [obj]


def add_body(objects):
    """Makes a mesh a passive rigid body."""
    del objects
    obj = _some_mesh()
    bpy.context.view_layer.objects.active = obj
    bpy.ops.rigidbody.object_add(type="PASSIVE")
    return [obj]


def add_solver(objects):
    """Makes a mesh a soft body."""
    del objects
    obj = _some_mesh()
    obj.modifiers.new("Softbody", "SOFT_BODY")
    return [obj]


def _some_mesh():
    return next(obj for obj in bpy.context.scene.objects if obj.type == "MESH")


def _clip():
    scene = bpy.context.scene
    return range(scene.frame_start, scene.frame_end + 1)
