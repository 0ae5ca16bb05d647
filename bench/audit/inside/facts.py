# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the open file's facts, as ``bench/audit/facts.py`` describes them: settings first, then the played motion."""

import os

import bpy

from . import channels, sample_frames, shapes, solvers
from .json_values import called, number, text

_PLAIN_PROPERTIES = (str, int, float, bool)
_INVISIBLE = {"CAMERA", "LIGHT", "SPEAKER", "LIGHT_PROBE", "ARMATURE", "LATTICE"}


def read_facts(play):
    """The facts of the active scene, as JSON. ``play``: whether the clip is played; else only its start is read."""
    scene = bpy.context.scene
    shapes.forget()
    channels.forget()
    watched = []
    facts_by_object = _objects(scene, watched)
    scene_facts = _scene(scene)  # as the file has it: playing switches off what is not baked
    solvers.take_moved_caches(facts_by_object)
    unbaked = sample_frames.unbaked_of(scene, facts_by_object)
    _play(sample_frames.play(scene, facts_by_object, unbaked), facts_by_object, watched, whole=play)
    if unbaked:
        labels = sorted(item.label for item in unbaked)
        rest = f" and {len(labels) - 4} more" if len(labels) > 4 else ""
        scene_facts["unplayed"] = f"unbaked: {', '.join(labels[:4])}{rest}"
    elif not play:
        scene_facts["unplayed"] = "Blender ends while it plays the clip"
    scene_facts["objects"] = [
        facts for _, facts in sorted(facts_by_object.items(), key=lambda item: item[1]["name"])
    ]
    return scene_facts


def _play(played, facts_by_object, watched, whole):
    for turn, graph in enumerate(played):
        for driven in watched:
            driven.record()
        if turn == 0:
            for obj, facts in facts_by_object.items():
                if facts["in_scene"]:
                    facts["vertices"], facts["faces"] = sample_frames.surface_of(obj, graph)
            if not whole:
                return


def _scene(scene):
    return {
        "name": text(scene.name),
        "blender": bpy.app.version_string,
        "saved_by": list(bpy.data.version)[:2],
        "range": [scene.frame_start, scene.frame_end],
        "fps": sample_frames.rate(scene),
        "unit_scale": number(sample_frames.metres(scene)),
        "camera": called(scene.camera),
        "unplayed": "",
        "collections": _collections(scene),
        "rigid_world": solvers.rigid_world_of(scene),
        "libraries": sorted(
            (_library(library) for library in bpy.data.libraries),
            key=lambda library_facts: (library_facts["path"], library_facts["missing"]),
        ),
        "scripts": _scripts(),
    }


def _library(library):
    missing = getattr(library, "is_missing", False) or not _is_there(library.filepath)
    return {"path": text(library.filepath), "missing": bool(missing)}


def _is_there(path):
    return os.path.isfile(bpy.path.abspath(path))


def _scripts():
    """What would have run on opening: registered texts, and drivers with Python expressions."""
    scripts = [f"text {text(item.name)}" for item in bpy.data.texts if item.use_module]
    for obj in bpy.data.objects:
        drivers = obj.animation_data.drivers if obj.animation_data is not None else ()
        if any(item.driver.type == "SCRIPTED" and not item.driver.is_simple_expression for item in drivers):
            scripts.append(f"driver of {called(obj)}")
    return sorted(scripts)[:20]


# Collections, and their objects that a render shows


def _collections(scene):
    parents = {}
    for parent in (scene.collection, *bpy.data.collections):
        for child in parent.children:
            parents.setdefault(child, parent)
    rows = []
    for collection in bpy.data.collections:
        parent = parents.get(collection)
        rows.append(
            {
                "name": called(collection),
                "parent": called(parent) if parent not in (None, scene.collection) else None,
                "objects": sorted(called(obj) for obj in collection.objects),
                "properties": {
                    text(key): text(value)
                    for key, value in sorted(collection.items())
                    if isinstance(value, _PLAIN_PROPERTIES)
                },
            }
        )
    return sorted(rows, key=lambda row: row["name"])


def _rendered(scene):
    """The objects that some view layer of the scene renders."""
    objects = set()
    for view_layer in scene.view_layers:
        if view_layer.use:
            _rendered_in(view_layer.layer_collection, objects)
    return {obj for obj in objects if not obj.hide_render and obj.visible_camera and not obj.is_holdout}


def _rendered_in(layer, objects):
    if layer.exclude or layer.holdout or layer.indirect_only or layer.collection.hide_render:
        return
    objects.update(layer.collection.objects)
    for child in layer.children:
        _rendered_in(child, objects)


# Objects


def _objects(scene, watched):
    """{object: its facts}: those of the scene, and those that only a collection instance shows."""
    own = set(scene.objects)
    instanced, waiting = set(), [obj.instance_collection for obj in own if _instances_collection(obj)]
    while waiting:
        for obj in waiting.pop().all_objects:
            if obj not in own and obj not in instanced:
                instanced.add(obj)
                if _instances_collection(obj):
                    waiting.append(obj.instance_collection)
    rendered = _rendered(scene)
    world = solvers.rigid_world_of(scene) or {"bodies": [], "constraints": []}
    simulated = set(world["bodies"]), set(world["constraints"])
    objects = sorted(own | instanced, key=called)  # pyright: ignore[reportCallIssue]
    return {
        obj: {
            **_object(obj, (scene.frame_start, scene.frame_end), simulated, watched),
            "in_scene": obj in own,
            "renders": obj in rendered and obj.type not in _INVISIBLE,
        }
        for obj in objects
    }


def _instances_collection(obj):
    return obj.instance_type == "COLLECTION" and obj.instance_collection is not None


def _object(obj, frames, simulated, watched):
    """``frames``: first and last of the clip. ``simulated``: names in the world's bodies, and in its constraints."""
    bodies, joints = simulated
    topology, islands = shapes.shape_of(obj.data)
    shape_keys, shape_channels = channels.shapes_of(obj, frames, watched)
    constraints = channels.constraints_of(obj)
    force = obj.field if obj.field is not None and obj.field.type != "NONE" else None
    return {
        "name": called(obj),
        "type": obj.type,
        "data": called(obj.data),
        "library": text(obj.library.filepath) if obj.library is not None else None,
        "parent": called(obj.parent),
        "follows": channels.followed(obj, constraints),
        "collections": sorted(
            called(collection) for collection in obj.users_collection if not collection.is_embedded_data
        ),
        "instances": called(obj.instance_collection) if _instances_collection(obj) else None,
        "vertices": 0,
        "faces": 0,
        "islands": islands,
        "topology": topology,
        "moments": [],
        "modifiers": solvers.modifiers_of(obj),
        "rigid_body": solvers.rigid_body_of(obj, bodies),
        "rigid_constraint": solvers.rigid_constraint_of(obj, joints),
        "force": {"type": force.type, "strength": number(force.strength)} if force is not None else None,
        "vertex_groups": shapes.vertex_groups_of(obj),
        "shape_keys": shape_keys,
        "shape_channels": shape_channels,
        "channels": channels.channels_of(obj, frames, watched),
        "constraints": constraints,
        "materials": sorted(
            {called(slot.material) for slot in obj.material_slots if slot.material is not None}
        ),
    }
