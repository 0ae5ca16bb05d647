"""Makes small scenes in Blender, and reads their facts as the audit does. For scripts that run beside it."""

import contextlib
import io
import json
import os
import sys

import bpy

from bench.audit.inside import facts, opening
from simworlds.sandbox.inside import mantaflow

FRAMES = 12
PLACE, RESULT = sys.argv[1:3]


def new(frames=FRAMES):
    """An empty scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, frames
    return scene


def add(kind, name, location=(0, 0, 0), **given):
    """A primitive mesh, as a new object."""
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(location=location, **given)
    thing = bpy.context.object
    thing.name = thing.data.name = name
    return thing


def empty(name, location=(0, 0, 0)):
    """An empty."""
    bpy.ops.object.empty_add(location=location)
    bpy.context.object.name = name
    return bpy.context.object


def get(name):
    """The object of that name."""
    return bpy.data.objects[name]


def into(collection, *things, parent=None):
    """Moves things into a new collection."""
    made = bpy.data.collections.new(collection)
    (parent or bpy.context.scene.collection).children.link(made)
    for thing in things:
        for each in thing.users_collection:
            if not each.name.startswith("RigidBody"):
                each.objects.unlink(thing)
        made.objects.link(thing)
    return made


def cloth_on(thing, frames=FRAMES):
    """A cloth modifier, to be baked."""
    modifier = thing.modifiers.new("Cloth", "CLOTH")
    modifier.settings.quality = 2
    modifier.point_cache.frame_end = frames
    return modifier


def body(thing, kind="ACTIVE"):
    """A rigid body; makes the world if there is none."""
    if bpy.context.scene.rigidbody_world is None:
        bpy.ops.rigidbody.world_add()
        bpy.context.scene.rigidbody_world.point_cache.frame_end = bpy.context.scene.frame_end
    bpy.context.view_layer.objects.active = thing
    bpy.ops.rigidbody.object_add(type=kind)
    return thing.rigid_body


def bake():
    """Bakes all but fluids."""
    with contextlib.redirect_stdout(io.StringIO()):
        bpy.ops.ptcache.bake_all(bake=True)


def keys(thing, path, values, frames):
    """Keys on a property of three axes, or one."""
    for value, frame in zip(values, frames, strict=True):
        owner, _, name = path.rpartition(".")
        target = thing.path_resolve(owner) if owner else thing
        setattr(target, name, value)
        target.keyframe_insert(name, frame=frame)


def save(name):
    """Writes the scene; its path."""
    path = os.path.join(PLACE, f"{name}.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False, compress=False)
    return path


def read(path, change=None):
    """The facts of a saved scene, as it is or after ``change``, which is saved beside it and opened again."""
    opening.open_file(path)
    if change is not None:
        change()
        path = path.replace(".blend", "_changed.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
        opening.open_file(path)
    return facts.read_facts(play=True)


def finish(found):
    """Writes the result, and ends without Blender's own ending, which fluids spoil."""
    with open(RESULT + ".part", "w") as file:
        json.dump(found, file)
    os.rename(RESULT + ".part", RESULT)
    sys.stdout.flush()
    os._exit(0)


mantaflow.mend()
