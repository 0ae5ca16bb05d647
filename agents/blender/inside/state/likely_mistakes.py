# SPDX-License-Identifier: GPL-3.0-or-later
"""What about a scene is likely to be a mistake, each in a sentence."""

import math
import os

import bpy

from .rna_values import text

MOST_NAMES = 6


def notes_of(scene, view_layer, objects, facts):
    """Sentences about these objects and what they use."""
    found = [
        *_unfinished(scene, objects),
        *_missing(),
        *_shapeless(facts),
        *_stale(facts),
        *_broken(facts),
    ]
    if view_layer is not None and bpy.context.mode != "OBJECT":
        active = view_layer.objects.active
        name = f" ({text(active.name)})" if active is not None else ""
        found.append(f"Blender is in {bpy.context.mode} mode{name}: edits show after it is left.")
    return found


def _unfinished(scene, objects):
    odd = [thing for thing in objects if not _finite(thing.matrix_world)]
    if odd:
        yield f"Transforms that are not finite: {_names(odd)}."
    world = scene.rigidbody_world
    bodies = [thing for thing in objects if thing.rigid_body is not None]
    if bodies and world is None:
        yield f"Rigid bodies without a rigid-body world in this scene: {_names(bodies)}."
    elif bodies:
        held = world.collection
        inside = {thing.name_full for thing in held.objects} if held is not None else set()
        out = [thing for thing in bodies if thing.name_full not in inside]
        if out:
            yield f"Rigid bodies that are not in the rigid-body world's collection: {_names(out)}."
    if scene.camera is None and any(thing.type == "CAMERA" for thing in objects):
        yield "No camera of the scene is the active one."
    ranged = scene.frame_start > scene.frame_end
    if ranged:
        yield f"The frame range is empty: {scene.frame_start} to {scene.frame_end}."


def _missing():
    lost = [library for library in bpy.data.libraries if getattr(library, "is_missing", False)]
    lost += [library for library in bpy.data.libraries if library not in lost and not _there(library)]
    for library in lost[:MOST_NAMES]:
        yield f"A linked library is missing: {text(library.filepath)}."
    pictures = [
        image
        for image in bpy.data.images
        if image.source == "FILE" and image.packed_file is None and image.filepath and not _there(image)
    ]
    if pictures:
        yield f"Images whose files are missing: {_names(pictures)}."


def _there(block):
    if getattr(block, "packed_file", None) is not None:
        return True
    try:
        return os.path.exists(bpy.path.abspath(block.filepath, library=block.library))
    except (OSError, ValueError):
        return False


def _shapeless(facts):
    odd = [
        entry["name"]
        for entry in facts.get("objects", ())
        if any(isinstance(end, str) for end in entry.get("extent", {}).get("min", ()))
    ]
    if odd:
        yield f"Geometry that is not finite, where it stands: {_listed(odd)}."


def _stale(facts):
    stale = [entry["name"] for entry in facts.get("physics", ()) if entry.get("cache", {}).get("outdated")]
    if stale:
        yield f"Caches that are outdated (bake again): {_listed(stale)}."


def _broken(facts):
    broken, unslotted = [], []
    for entry in facts.get("animation", ()):
        for part in (*entry.get("drivers", ()), *entry.get("channels", ())):
            if part.get("broken"):
                broken.append(f"{entry['name']}.{part['path']}")
        if "action" in entry and entry.get("slot", "") is None:
            unslotted.append(entry["name"])
    if broken:
        yield f"Drivers or channels that do not work: {_listed(broken)}."
    if unslotted:
        yield f"An action is assigned, but no slot of it, so that nothing plays: {_listed(unslotted)}."


def _finite(matrix):
    return all(math.isfinite(value) for row in matrix for value in row)


def _names(blocks):
    return _listed([text(block.name) for block in blocks])


def _listed(names):
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(names[:MOST_NAMES]) + more
