# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what only evaluated objects have: Blender computes it for them, and leaves it empty on the originals.

Objects with every modifier, and with particles, are computed for a few frames; then each is compared with its
evaluated one (``Object.evaluated_get``).
"""

import traceback

import bpy

from ..classes.rna import path_of
from ..instances.layouts import NOT_ASKED
from ..instances.making import attempts, choices, mesh_object, new_modifier, scratch_scene
from ..instances.observer import AROUND, DEPTH, UNREADABLE

FRAMES = 4
# More elements than these are all alike.
MOST_ELEMENTS = 3


def modified():
    """A mesh object with each modifier that it takes; those that need others to work on do nothing."""
    for kind in choices("Modifier", "type"):
        obj = mesh_object()
        if new_modifier(obj, kind) is not None:
            yield obj


def with_particles():
    """What emits particles, and what has hair with children."""
    for kind in ("EMITTER", "HAIR"):
        obj = mesh_object()
        obj.modifiers.new("new", "PARTICLE_SYSTEM")
        settings = obj.particle_systems[-1].settings
        settings.type = kind
        settings.count = 8
        settings.frame_end = FRAMES
        settings.child_type = "SIMPLE"
        yield obj


def differing(original, evaluated, left=DEPTH):
    """The paths of what is empty, or None, in the first of two structs, and not in the second."""
    for prop in original.bl_rna.properties:
        name = prop.identifier
        if prop.type not in {"COLLECTION", "POINTER"} or name in AROUND or name in NOT_ASKED:
            continue
        pair = getattr(original, name, None), getattr(evaluated, name, None)
        path = path_of(original.bl_rna, name)
        if prop.type == "COLLECTION":
            try:
                sizes = [len(side) for side in pair]
            except (TypeError, RuntimeError):
                continue
            if not sizes[0] and sizes[1]:
                yield path
            pairs = list(zip(*pair, strict=False)) if left and sizes[0] == sizes[1] <= MOST_ELEMENTS else []
        else:
            if pair[0] is None and pair[1] is not None:
                yield path
            pairs = [pair] if left and None not in pair else []
        for first, second in pairs:
            if is_part(first) and is_part(second):
                yield from differing(first, second, left - 1)


def is_part(value):
    """Whether a value belongs to an object alone."""
    return (
        isinstance(value, bpy.types.bpy_struct)
        and not isinstance(value, bpy.types.ID)
        and value.bl_rna.identifier not in UNREADABLE
    )


def write_iterated(write):
    """An ``iterated`` record for each collection of the evaluated scene that gives its elements to loops alone."""
    graph = bpy.context.evaluated_depsgraph_get()
    for prop in graph.bl_rna.properties:
        if prop.type != "COLLECTION":
            continue
        try:
            getattr(graph, prop.identifier)[0]
        except TypeError:
            write("iterated", path=path_of(graph.bl_rna, prop.identifier))
        except IndexError:
            pass


def clear(scene):
    """Goes back to a scene, and removes the one that the window shows, with what is in it."""
    scratch = bpy.context.scene
    bpy.data.batch_remove(list(scratch.collection.objects))
    if bpy.context.window is not None:
        bpy.context.window.scene = scene
        bpy.data.scenes.remove(scratch)


def find_all(write, skipped):
    """One ``evaluated`` record for each property that only evaluated objects have filled."""
    found = set()
    before = bpy.context.scene
    for make in attempts(write, (modified, with_particles), skipped):
        scratch_scene()
        try:
            objects = list(make())
            for frame in range(1, FRAMES + 1):
                bpy.context.scene.frame_set(frame)
            graph = bpy.context.evaluated_depsgraph_get()
            for obj in objects:
                found.update(differing(obj, obj.evaluated_get(graph)))
        except Exception:
            write("fault", step="evaluated", traceback=traceback.format_exc())
        finally:
            clear(before)
    for path in sorted(found):
        write("evaluated", path=path)
    write_iterated(write)
