# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the open scene as data and leaves no trace in it: no frame is changed, nothing is simulated."""

import difflib
import fnmatch
import re

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..tag import ROLE
from .animation import animation_facts, unused_actions
from .appearance import camera_facts, light_facts, material_facts, render_facts, world_facts
from .fingerprint import data_blocks
from .likely_mistakes import notes_of
from .object_entries import Census, object_facts, tags_of, tree_of
from .physics_entries import physics_of
from .physics_entries import world_facts as rigid_body_world_facts
from .rna_values import few, number, numbers, text
from .world_extents import MOST_INSTANCES, Extents, evaluated_graph

MOST_OBJECTS = 5_000  # of one readout that are told one by one
MOST_ENTRIES = 5_000  # of any other section
SECTIONS = ("collections", "objects", "physics", "animation", "materials", "view")
DATA_BLOCKS = "data_blocks"
_NEAREST = 5


def scene_state(arguments, report):
    """``detail`` (summary, normal, full), ``objects`` (names and patterns, or None), ``sections``.

    Returns {section: entries} with ``scene``, ``notes``, ``chosen`` (how many objects) and ``unread``: of each
    section, how many entries were not looked at. ``data_blocks`` is as ``fingerprint.data_blocks`` returns it, and
    whether any collection is ``tagged`` by the scene protocol. Raises Refused for a name that the scene does not have.
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
        facts[DATA_BLOCKS] = {**data_blocks(report), "tagged": tagged}
    if len(reading.chosen) > MOST_OBJECTS and "objects" in facts:
        facts["unread"]["objects"] = len(reading.chosen) - MOST_OBJECTS
    facts["notes"] = [*notes_of(reading.scene, reading.layer, reading.chosen, facts), *reading.remarks]
    return facts


class _Reading:
    """One readout: what was asked for, and a method for each section."""

    def __init__(self, arguments, report):
        self.detail = arguments["detail"]
        self.scene, self.layer = bpy.context.scene, bpy.context.view_layer
        self.census = Census(self.scene)
        self.everything = self.census.objects
        self.whole = arguments["objects"] is None
        self.chosen = self.everything if self.whole else _find(arguments["objects"], self.everything)
        self.graph = evaluated_graph()
        self.remarks = []
        self._report = report

    def collections(self):
        return tree_of(self.scene, self.layer, None if self.whole else self.chosen)

    def objects(self):
        extents = Extents(self.graph)
        visible = set()
        if self.layer is not None:
            shown = (thing for thing in self.layer.objects if thing.visible_get(view_layer=self.layer))
            visible = {thing.name_full for thing in shown}
        for count, thing in enumerate(self.chosen[:MOST_OBJECTS]):
            if count % 500 == 499:
                self._report(count, len(self.chosen), "reading objects")
            yield object_facts(thing, self.census.collections[thing.name_full], extents, visible, self.detail)
        if extents.instances_cut:
            self.remarks.append(f"Of the instances, only the first {MOST_INSTANCES:,} are in the extents.")

    def physics(self):
        world = rigid_body_world_facts(self.scene)
        if world is not None and (self.whole or any(thing.rigid_body is not None for thing in self.chosen)):
            yield world
        for thing in self.chosen:
            yield from physics_of(thing, self.graph)

    def animation(self):
        yield from animation_facts(self.everything, None if self.whole else self.chosen, self.detail)
        if self.whole and (idle := unused_actions()):
            yield {"name": "unused actions", "actions": few(idle), "count": len(idle)}

    def materials(self):
        slots = (slot for thing in self.chosen for slot in thing.material_slots)
        used = {slot.material.name_full: slot.material for slot in slots if slot.material is not None}
        for material in bpy.data.materials if self.whole else used.values():
            if material.name_full in used or not getattr(material, "is_grease_pencil", False):
                yield material_facts(material, self.detail)

    def view(self):
        for thing in self.chosen:
            if thing.type == "CAMERA" and thing.data is not None:
                yield camera_facts(thing, self.scene)
        for thing in self.chosen:
            if thing.type == "LIGHT" and thing.data is not None:
                yield light_facts(thing)
        if self.whole:
            if self.scene.world is not None:
                yield world_facts(self.scene.world, self.detail)
            yield render_facts(self.scene, self.detail)


def _scene_facts(reading):
    scene, layer, everything = reading.scene, reading.layer, reading.everything
    counts = {}
    for thing in everything:
        counts[thing.type] = counts.get(thing.type, 0) + 1
    render, units = scene.render, scene.unit_settings
    told = {
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
        told["samples"] = getattr(settings, samples[1])
    if scene.use_preview_range:
        told["frame"]["preview"] = [scene.frame_preview_start, scene.frame_preview_end]
    if tags := tags_of(scene):
        told["tags"] = tags
    if scene.timeline_markers:
        told["markers"] = few([f"{one.name} {one.frame}" for one in scene.timeline_markers], 24)
    if len(bpy.data.scenes) > 1:
        told["other_scenes"] = few([one.name for one in bpy.data.scenes if one != scene], 8)
    if layer is not None and len(scene.view_layers) > 1:
        told["view_layer"] = text(layer.name)
    used = {thing.name_full for one in bpy.data.scenes for thing in one.objects}
    if len(bpy.data.objects) > len(used):
        told["outside"] = len(bpy.data.objects) - len(used)
    if bpy.data.libraries:
        told["libraries"] = few([one.filepath for one in bpy.data.libraries])
    return told


def _find(asked, everything):
    """The objects of these names, patterns and collections, in the scene's order. Raises Refused."""
    wanted = set()
    by_name = {}
    for thing in everything:
        by_name.setdefault(thing.name, []).append(thing)
    for words in asked:
        found = by_name.get(words) or _matching(words, everything)
        if not found:
            raise Refused(_nobody(words, by_name))
        wanted.update(thing.name_full for thing in found)
    return [thing for thing in everything if thing.name_full in wanted]


def _matching(words, everything):
    collection = bpy.data.collections.get(words)
    if collection is not None:
        inside = {thing.name_full for thing in collection.all_objects}
        return [thing for thing in everything if thing.name_full in inside]
    if not any(sign in words for sign in "*?["):
        return []
    fits = re.compile(fnmatch.translate(words)).match
    return [thing for thing in everything if fits(thing.name)]


def _nobody(words, by_name):
    shown = text(words)
    if not by_name:
        return f"There is no object {shown!r}: the scene has no objects."
    plain = {name.lower(): name for name in by_name}
    near = difflib.get_close_matches(words.lower().strip("*?"), plain, n=_NEAREST, cutoff=0.5)
    names = [repr(text(plain[name])) for name in near]
    if bpy.data.objects.get(words) is not None:
        return f"The object {shown!r} is in the file, but not in the scene {text(bpy.context.scene.name)!r}."
    kind = "object fits" if any(sign in words for sign in "*?[") else "object or collection is called"
    hint = (
        f"Nearest: {', '.join(names)}." if names else f"The scene has {len(by_name)} objects of other names."
    )
    return f"No {kind} {shown!r} in this scene. {hint}"
