# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the open scene as data, without changing it: the frame stays, nothing is simulated."""

import fnmatch
import re

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.names import nearest
from ..blend.protocol_tags import ROLE
from ..digests.fingerprint import data_blocks
from ..readout_sections import DATA_BLOCKS, SECTIONS
from .animation import action_keys, animation_facts, unused_actions
from .appearance import camera_facts, light_facts, material_facts, render_facts, world_facts
from .likely_mistakes import notes_of
from .object_entries import SceneObjects, object_facts, tags_of, tree_of
from .physics_entries import physics_of, rigid_body_world_facts
from .rna_values import number, numbers, shortened, text
from .world_extents import MOST_INSTANCES, ExtentReader, evaluated_graph

MOST_OBJECTS = 5_000  # of one readout
MOST_ENTRIES = 5_000  # of any other section
_OF_VIEW = ("CAMERA", "LIGHT")


def _part_reader():
    """None in a Blender without numpy, as some systems' packages of it are."""
    try:
        from .loose_parts import PartReader
    except ImportError:
        return None
    return PartReader()


def scene_state(arguments, report):
    """``detail`` (summary, normal, full), ``objects`` (names and patterns, or None), ``sections``, and ``parts``, if
    meshes of several parts are to be measured part by part.

    Returns {section: entries} with ``scene``, ``notes``, ``chosen`` (how many objects) and ``unread``: of each
    section, how many entries were left out. ``data_blocks`` is as ``fingerprint.data_blocks`` returns it, with the
    ``keys`` of actions that have few, and whether any collection is ``tagged`` by the scene protocol. Raises Refused
    for a name that the scene does not have.
    """
    reading = _Reading(arguments, report)
    facts = {"scene": _scene_facts(reading), "chosen": len(reading.chosen), "unread": {}}
    for section in SECTIONS:
        if section not in arguments["sections"]:
            continue
        entries = []
        for entry in getattr(reading, section)():
            if len(entries) < MOST_ENTRIES:
                entries.append(entry)
            else:
                facts["unread"][section] = facts["unread"].get(section, 0) + 1
        facts[section] = entries
    if DATA_BLOCKS in arguments["sections"]:
        tagged = any(collection.get(ROLE) for collection in bpy.data.collections)
        facts[DATA_BLOCKS] = {**data_blocks(report), "keys": action_keys(), "tagged": tagged}
    if len(reading.chosen) > MOST_OBJECTS and "objects" in facts:
        facts["unread"]["objects"] = len(reading.chosen) - MOST_OBJECTS
    facts["notes"] = [*notes_of(reading.scene, reading.layer, reading.chosen, facts), *reading.remarks]
    return facts


class _Reading:
    """One readout: the request, and a method for each section."""

    def __init__(self, arguments, report):
        self.detail, self.parts = arguments["detail"], arguments.get("parts", False)
        self.scene, self.layer = bpy.context.scene, bpy.context.view_layer
        self.scene_objects = SceneObjects(self.scene)
        self.everything = self.scene_objects.objects
        self.whole = arguments["objects"] is None
        self.chosen = self.everything if self.whole else find_objects(arguments["objects"], self.everything)
        self.graph = evaluated_graph()
        self.remarks = []
        self._report = report

    def collections(self):
        return tree_of(self.scene, self.layer, None if self.whole else self.chosen)

    def objects(self):
        extents, parts = ExtentReader(self.graph), _part_reader() if self.parts else None
        visible = set()
        if self.layer is not None:
            visible_objects = (obj for obj in self.layer.objects if obj.visible_get(view_layer=self.layer))
            visible = {obj.name_full for obj in visible_objects}
        for count, obj in enumerate(self.chosen[:MOST_OBJECTS]):
            if count % 500 == 499:
                self._report(count, len(self.chosen), "reading objects")
            facts = object_facts(
                obj, self.scene_objects.collections[obj.name_full], extents, visible, self.detail
            )
            yield {**facts, **parts.entry(extents.evaluated(obj))} if parts is not None else facts
        if extents.instances_cut:
            self.remarks.append(f"Extents include only the first {MOST_INSTANCES:,} instances.")

    def physics(self):
        world = rigid_body_world_facts(self.scene)
        if world is not None and (self.whole or any(obj.rigid_body is not None for obj in self.chosen)):
            yield world
        for obj in self.chosen:
            yield from physics_of(obj, self.graph)

    def animation(self):
        yield from animation_facts(self.everything, None if self.whole else self.chosen, self.detail)
        if self.whole and (unused := unused_actions()):
            yield {"name": "unused actions", "actions": shortened(unused), "count": len(unused)}

    def materials(self):
        slots = (slot for obj in self.chosen for slot in obj.material_slots)
        used = {slot.material.name_full: slot.material for slot in slots if slot.material is not None}
        for material in bpy.data.materials if self.whole else used.values():
            if material.name_full in used or not getattr(material, "is_grease_pencil", False):
                yield material_facts(material, self.detail)

    def view(self):
        # Whoever asks for objects that are no camera or light wants to know how these are seen and lit.
        own = [obj for obj in self.chosen if obj.type in _OF_VIEW and obj.data is not None]
        every = [obj for obj in self.everything if obj.type in _OF_VIEW and obj.data is not None]
        for obj in sorted(own or every, key=lambda obj: _OF_VIEW.index(obj.type)):
            yield camera_facts(obj, self.scene) if obj.type == "CAMERA" else light_facts(obj)
        if self.scene.world is not None:
            yield world_facts(self.scene.world, self.detail)
        yield render_facts(self.scene, self.detail)


def _scene_facts(reading):
    scene, layer, everything = reading.scene, reading.layer, reading.everything
    counts = {}
    for obj in everything:
        counts[obj.type] = counts.get(obj.type, 0) + 1
    render, units = scene.render, scene.unit_settings
    facts = {
        "name": text(scene.name),
        "file": text(bpy.path.basename(bpy.data.filepath)),
        "blender": bpy.app.version_string,
        "frame": {
            "current": number(scene.frame_current_final),
            "start": scene.frame_start,
            "end": scene.frame_end,
            "step": scene.frame_step,
            "fps": number(render.fps / render.fps_base),
        },
        "units": {"system": units.system, "scale_length": number(units.scale_length)},
        "gravity": numbers(scene.gravity) if scene.use_gravity else None,
        "engine": render.engine,
        "resolution": [render.resolution_x, render.resolution_y, render.resolution_percentage],
        "camera": text(scene.camera.name) if scene.camera is not None else None,
        "counts": counts,
    }
    samples = {"CYCLES": ("cycles", "samples")}.get(render.engine, ("eevee", "taa_render_samples"))
    settings = getattr(scene, samples[0], None)
    if settings is not None and hasattr(settings, samples[1]):
        facts["samples"] = getattr(settings, samples[1])
    if scene.use_preview_range:
        facts["frame"]["preview"] = [scene.frame_preview_start, scene.frame_preview_end]
    if tags := tags_of(scene):
        facts["tags"] = tags
    if scene.timeline_markers:
        facts["markers"] = shortened([_marker(marker) for marker in scene.timeline_markers], 24)
    if len(bpy.data.scenes) > 1:
        facts["other_scenes"] = shortened([other.name for other in bpy.data.scenes if other != scene], 8)
    if layer is not None and len(scene.view_layers) > 1:
        facts["view_layer"] = text(layer.name)
    used = {obj.name_full for every in bpy.data.scenes for obj in every.objects}
    if len(bpy.data.objects) > len(used):
        facts["outside"] = len(bpy.data.objects) - len(used)
    if bpy.data.libraries:
        facts["libraries"] = shortened([library.filepath for library in bpy.data.libraries])
    return facts


def _marker(marker):
    """``close 20``; with the camera that it switches to, if it does."""
    camera = f" (camera {marker.camera.name} from here)" if marker.camera is not None else ""
    return f"{marker.name} {marker.frame}{camera}"


def find_objects(names, everything):
    """The objects of these names, patterns and collections, in the scene's order. Raises Refused."""
    wanted = set()
    by_name = {}
    for obj in everything:
        by_name.setdefault(obj.name, []).append(obj)
    for pattern in names:
        matches = [*by_name.get(pattern, ()), *_of_collection(pattern, everything)]
        matches = matches or _fitting(pattern, everything)
        if not matches:
            raise Refused(_unknown(pattern, by_name))
        wanted.update(obj.name_full for obj in matches)
    return [obj for obj in everything if obj.name_full in wanted]


def _of_collection(name, everything):
    """The objects of a collection, which may be called as an object is."""
    collection = bpy.data.collections.get(name)
    inside = {obj.name_full for obj in collection.all_objects} if collection is not None else set()
    return [obj for obj in everything if obj.name_full in inside]


def _fitting(words, everything):
    if not any(sign in words for sign in "*?["):
        return []
    fits = re.compile(fnmatch.translate(words)).match
    return [obj for obj in everything if fits(obj.name)]


def _unknown(pattern, by_name):
    """Why no object has this name or fits this pattern, with the nearest names."""
    quoted = repr(text(pattern))
    if not by_name:
        return f"There is no object {quoted}: the scene has no objects."
    if bpy.data.objects.get(pattern) is not None:
        return f"The object {quoted} is in the file, but not in the scene {text(bpy.context.scene.name)!r}."
    names = [repr(text(name)) for name in nearest(pattern.strip("*?"), by_name, 5)]
    kind = "object fits" if any(sign in pattern for sign in "*?[") else "object or collection is called"
    hint = (
        f"Nearest: {', '.join(names)}." if names else f"The scene has {len(by_name)} objects of other names."
    )
    return f"No {kind} {quoted} in this scene. {hint}"
