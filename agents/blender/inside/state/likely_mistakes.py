# SPDX-License-Identifier: GPL-3.0-or-later
"""Likely mistakes in a scene, a sentence for each."""

import math
import os

import bpy

from ..blend.names import listed
from ..physics.body_centres import CENTRED_SHAPES, is_kinematic, off_centre, origin_outside
from .rna_values import number, text

MOST_NAMES = 6
_OFF, _OFF_SHARE = 0.001, 0.01  # metres, and share of its size, that a shape may be off its mesh
_OUTSIDE_SHARE = 0.05  # of its size, that the origin of a body may be outside its mesh
_MOST_BODIES = 500


def notes_of(scene, view_layer, objects, facts):
    """Sentences about likely mistakes in these objects and what they use; ``facts`` is the readout so far."""
    notes = [
        *_invalid_setup(scene, objects),
        *_missing_files(),
        *_not_finite(facts),
        *_outdated_caches(facts),
        *_broken_animation(facts),
    ]
    if view_layer is not None and bpy.context.mode != "OBJECT":
        active = view_layer.objects.active
        name = f" ({text(active.name)})" if active is not None else ""
        notes.append(f"Blender is in {bpy.context.mode} mode{name}: edits show only after leaving it.")
    return notes


def _invalid_setup(scene, objects):
    odd = [obj for obj in objects if not _is_finite(obj.matrix_world)]
    if odd:
        yield f"Transforms with values that are not finite: {_names(odd)}."
    world = scene.rigidbody_world
    bodies = [obj for obj in objects if obj.rigid_body is not None]
    if bodies and world is None:
        yield f"Rigid bodies, but the scene has no rigid-body world to simulate them: {_names(bodies)}."
    elif bodies:
        held = world.collection
        inside = {obj.name_full for obj in held.objects} if held is not None else set()
        out = [obj for obj in bodies if obj.name_full not in inside]
        if out:
            yield f"Rigid bodies outside the rigid-body world's collection, so not simulated: {_names(out)}."
    yield from bodies_off_their_meshes(bodies)
    if scene.camera is None and any(obj.type == "CAMERA" for obj in objects):
        yield "The scene has cameras, but none is active (scene.camera)."
    if scene.frame_start > scene.frame_end:
        yield f"The frame range is empty: {scene.frame_start} to {scene.frame_end}."


def bodies_off_their_meshes(bodies):
    """A body turns about its origin, and a primitive collision shape is centred on it, wherever the mesh is."""
    outside, off = [], []
    for obj in bodies[:_MOST_BODIES]:
        if obj.type != "MESH" or not _is_finite(obj.matrix_world):
            continue
        body, size = obj.rigid_body, obj.dimensions.length
        if (
            body.enabled
            and body.type == "ACTIVE"
            and not is_kinematic(obj)
            and (gap := origin_outside(obj)) > _OUTSIDE_SHARE * size
        ):
            outside.append(f"{text(obj.name)!r} by {number(round(gap, 4))} m")
        elif body.collision_shape in CENTRED_SHAPES and (way := off_centre(obj)) > max(
            _OFF, _OFF_SHARE * size
        ):
            off.append(f"{body.collision_shape} of {text(obj.name)!r} by {number(round(way, 4))} m")
    if outside:
        yield (
            "A rigid body's centre of mass is its origin; here that is outside the mesh, so that it falls and turns "
            f"as nothing real does: {listed(outside, MOST_NAMES)}. Set the origin to the middle of its bounds."
        )
    if off:
        yield (
            "Primitive collision shapes are centred on the origin; here that is not the middle of the mesh: "
            f"{listed(off, MOST_NAMES)}. Set the origin to the middle of its bounds, or use CONVEX_HULL."
        )


def _missing_files():
    lost = [library for library in bpy.data.libraries if getattr(library, "is_missing", False)]
    lost += [library for library in bpy.data.libraries if library not in lost and not _file_exists(library)]
    for library in lost[:MOST_NAMES]:
        yield f"A linked library is missing: {text(library.filepath)}."
    pictures = [
        image
        for image in bpy.data.images
        if image.source == "FILE" and image.packed_file is None and image.filepath and not _file_exists(image)
    ]
    if pictures:
        yield f"Images whose files are missing: {_names(pictures)}."


def _file_exists(block):
    if getattr(block, "packed_file", None) is not None:
        return True
    try:
        return os.path.exists(bpy.path.abspath(block.filepath, library=block.library))
    except (OSError, ValueError):
        return False


def _not_finite(facts):
    odd = [
        entry["name"]
        for entry in facts.get("objects", ())
        if any(isinstance(end, str) for end in entry.get("extent", {}).get("min", ()))
    ]
    if odd:
        yield f"Geometry with coordinates that are not finite: {listed(odd, MOST_NAMES)}."


def _outdated_caches(facts):
    """Old bakes, which are played as they are; old frames that are not baked are simulated again unasked."""
    caches = [(entry["name"], entry.get("cache", {})) for entry in facts.get("physics", ())]
    stale = [name for name, cache in caches if cache.get("outdated") and cache["state"] == "baked"]
    if stale:
        yield f"Outdated bakes (free them, or bake again): {listed(stale, MOST_NAMES)}."


def _broken_animation(facts):
    broken, unslotted = [], []
    for entry in facts.get("animation", ()):
        for part in (*entry.get("drivers", ()), *entry.get("channels", ())):
            if part.get("broken"):
                broken.append(f"{entry['name']}.{part['path']}")
        if "action" in entry and entry.get("slot", "") is None:
            unslotted.append(entry["name"])
    if broken:
        yield f"Broken drivers or animation channels: {listed(broken, MOST_NAMES)}."
    if unslotted:
        yield f"An action is assigned without a slot, so nothing plays: {listed(unslotted, MOST_NAMES)}."


def _is_finite(matrix):
    return all(math.isfinite(value) for row in matrix for value in row)


def _names(blocks):
    return listed((text(block.name) for block in blocks), MOST_NAMES)
