# SPDX-License-Identifier: GPL-3.0-or-later
"""What must not be there: recorded motion, stored shapes, physics in a still scene; and fields without force."""

import bpy

from .lookup import mute_keys

_STEP = 0.0005  # of the scene's units: enough to be motion, too little for anyone to see
_NEAR = 1e-3


def calm(things):
    """Takes the force out of fields: of these, or of all."""
    found = [
        thing for thing in things or bpy.context.scene.objects if thing.field and thing.field.type != "NONE"
    ]
    for thing in found:
        mute_keys(thing, "field.strength")
        thing.field.strength = 0.0
    return found


def record(things):
    """Keys the place of a thing at every frame, on a path of half a millimetre a step."""
    thing = things[0]
    place = thing.location.copy()
    for frame in _clip():
        thing.location.z = place.z + _STEP * (frame % 8)
        thing.keyframe_insert("location", frame=frame)
    return [thing]


def reshape(things):
    """Blends the surface of a thing into another shape, by two keys."""
    thing = next((each for each in things if each.type in {"MESH", "CURVE", "SURFACE", "LATTICE"}), None)
    if thing is None:
        return []
    if thing.data.shape_keys is None:
        thing.shape_key_add(name="Basis")
    shape = thing.shape_key_add(name="Other", from_mix=False)
    shape.data[0].co.z += _NEAR
    first, *_, last = _clip()
    for frame, value in ((first, 0.0), (last, 1.0)):
        shape.value = value
        shape.keyframe_insert("value", frame=frame)
    return [thing]


def play_mesh(things):
    """Has the surface of a thing be played from a file."""
    thing = next((each for each in things if each.type == "MESH"), None)
    if thing is None:
        return []
    thing.modifiers.new("Recorded", "MESH_CACHE").filepath = "//recorded.pc2"
    return [thing]


def add_bake(things):
    """Bakes a rigid-body world, and takes its only body out of it again."""
    del things
    thing = _some_mesh()
    bpy.context.view_layer.objects.active = thing
    bpy.ops.rigidbody.object_add(type="PASSIVE")
    world = bpy.context.scene.rigidbody_world
    with bpy.context.temp_override(point_cache=world.point_cache):
        bpy.ops.ptcache.bake(bake=True)
    world.collection.objects.unlink(thing)
    return [thing]


def add_body(things):
    """Makes a thing a passive rigid body."""
    del things
    thing = _some_mesh()
    bpy.context.view_layer.objects.active = thing
    bpy.ops.rigidbody.object_add(type="PASSIVE")
    return [thing]


def add_solver(things):
    """Makes a thing a soft body."""
    del things
    thing = _some_mesh()
    thing.modifiers.new("Softbody", "SOFT_BODY")
    return [thing]


def _some_mesh():
    return next(thing for thing in bpy.context.scene.objects if thing.type == "MESH")


def _clip():
    scene = bpy.context.scene
    return range(scene.frame_start, scene.frame_end + 1)
