# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the open file's facts, as ``bench/audit/facts.py`` describes them: settings first, then the played motion."""

import os

import bpy

from simworlds.sandbox.inside.refusal import Refused

from . import channels, sample_frames, shapes, solvers
from .json_values import called, number, text

MOST_OBJECTS = 20_000
_PLAIN_PROPERTIES = (str, int, float, bool)
_INVISIBLE = {"CAMERA", "LIGHT", "SPEAKER", "LIGHT_PROBE", "ARMATURE", "LATTICE"}


def read_facts(play, most=MOST_OBJECTS):
    """The facts of the active scene, as JSON. ``play``: whether the clip is played; else only its start is evaluated.

    Raises Refused for a scene of more than ``most`` objects.
    """
    scene = bpy.context.scene
    if len(scene.objects) > most:
        raise Refused(f"the scene has {len(scene.objects):,} objects; at most {most:,} can be audited")
    shapes.forget()
    channels.forget()
    watched = []
    told = _objects(scene, watched)
    scene_facts = _scene(scene)  # as the file has it: playing switches off what is not baked
    solvers.take_moved_caches(told)
    unbaked = sample_frames.unbaked_of(scene, told)
    _play(sample_frames.play(scene, told, unbaked), told, watched, whole=play)
    if unbaked:
        labels = sorted(each.label for each in unbaked)
        rest = f" and {len(labels) - 4} more" if len(labels) > 4 else ""
        scene_facts["unplayed"] = f"unbaked: {', '.join(labels[:4])}{rest}"
    elif not play:
        scene_facts["unplayed"] = "Blender ends while it plays the clip"
    scene_facts["objects"] = [facts for _, facts in sorted(told.items(), key=lambda item: item[1]["name"])]
    return scene_facts


def _play(played, told, watched, whole):
    for turn, graph in enumerate(played):
        for each in watched:
            each.look()
        if turn == 0:
            for thing, facts in told.items():
                if facts["in_scene"]:
                    facts["vertices"], facts["faces"] = sample_frames.surface_of(thing, graph)
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
            (_library(each) for each in bpy.data.libraries), key=lambda one: (one["path"], one["missing"])
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
    found = [f"text {text(each.name)}" for each in bpy.data.texts if each.use_module]
    for thing in bpy.data.objects:
        drivers = thing.animation_data.drivers if thing.animation_data is not None else ()
        if any(each.driver.type == "SCRIPTED" and not each.driver.is_simple_expression for each in drivers):
            found.append(f"driver of {called(thing)}")
    return sorted(found)[:20]


# Collections, and their objects that a render shows


def _collections(scene):
    parents = {}
    for parent in (scene.collection, *bpy.data.collections):
        for child in parent.children:
            parents.setdefault(child, parent)
    found = []
    for collection in bpy.data.collections:
        parent = parents.get(collection)
        found.append(
            {
                "name": called(collection),
                "parent": called(parent) if parent not in (None, scene.collection) else None,
                "objects": sorted(called(thing) for thing in collection.objects),
                "properties": {
                    text(key): text(value)
                    for key, value in sorted(collection.items())
                    if isinstance(value, _PLAIN_PROPERTIES)
                },
            }
        )
    return sorted(found, key=lambda one: one["name"])


def _rendered(scene):
    """The objects that some view layer of the scene renders."""
    found = set()
    for view_layer in scene.view_layers:
        if view_layer.use:
            _rendered_in(view_layer.layer_collection, found)
    return {
        thing for thing in found if not thing.hide_render and thing.visible_camera and not thing.is_holdout
    }


def _rendered_in(layer, found):
    if layer.exclude or layer.holdout or layer.indirect_only or layer.collection.hide_render:
        return
    found.update(layer.collection.objects)
    for below in layer.children:
        _rendered_in(below, found)


# Objects


def _objects(scene, watched):
    """{object: its facts}: those of the scene, and those that only a collection instance shows."""
    own = set(scene.objects)
    shown, waiting = set(), [thing.instance_collection for thing in own if _shows_collection(thing)]
    while waiting:
        for thing in waiting.pop().all_objects:
            if thing not in own and thing not in shown and len(own) + len(shown) < MOST_OBJECTS:
                shown.add(thing)
                if _shows_collection(thing):
                    waiting.append(thing.instance_collection)
    rendered = _rendered(scene)
    world = solvers.rigid_world_of(scene) or {"bodies": [], "constraints": []}
    simulated = set(world["bodies"]), set(world["constraints"])
    things = sorted(own | shown, key=called)
    return {
        thing: {
            **_object(thing, (scene.frame_start, scene.frame_end), simulated, watched),
            "in_scene": thing in own,
            "renders": thing in rendered and thing.type not in _INVISIBLE,
        }
        for thing in things
    }


def _shows_collection(thing):
    return thing.instance_type == "COLLECTION" and thing.instance_collection is not None


def _object(thing, frames, simulated, watched):
    """``frames``: first and last of the clip. ``simulated``: names in the world's bodies, and in its constraints."""
    bodies, joints = simulated
    topology, islands = shapes.shape_of(thing.data)
    shape_keys, shape_channels = channels.shapes_of(thing, frames, watched)
    constraints = channels.constraints_of(thing)
    force = thing.field if thing.field is not None and thing.field.type != "NONE" else None
    return {
        "name": called(thing),
        "type": thing.type,
        "data": called(thing.data),
        "library": text(thing.library.filepath) if thing.library is not None else None,
        "parent": called(thing.parent),
        "follows": channels.followed(thing, constraints),
        "collections": sorted(called(each) for each in thing.users_collection if not each.is_embedded_data),
        "instances": called(thing.instance_collection) if _shows_collection(thing) else None,
        "vertices": 0,
        "faces": 0,
        "islands": islands,
        "topology": topology,
        "moments": [],
        "modifiers": solvers.modifiers_of(thing),
        "rigid_body": solvers.rigid_body_of(thing, bodies),
        "rigid_constraint": solvers.rigid_constraint_of(thing, joints),
        "force": {"type": force.type, "strength": number(force.strength)} if force is not None else None,
        "vertex_groups": shapes.vertex_groups_of(thing),
        "shape_keys": shape_keys,
        "shape_channels": shape_channels,
        "channels": channels.channels_of(thing, frames, watched),
        "constraints": constraints,
        "materials": sorted(
            {called(slot.material) for slot in thing.material_slots if slot.material is not None}
        ),
    }
