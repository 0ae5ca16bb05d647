# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the operators that run only in an area of a window, and what the context can give them instead.

Each is asked whether it can run (``poll``) in a scene that has an object of every type with what operators ask for: in
every mode without an area, as in a Blender without a window; without one, but with each of the things that areas put
into the context; and in an area of every type, in the 3D viewport in every mode. Some say yes to a thing without an
area and end Blender all the same, so each is then called in a process of its own. What those that run in areas want of
all that is there, operator_wants finds.
"""

from collections import defaultdict
from contextlib import suppress

import bpy

from ..apart import apart, can_work_apart
from ..bpy_ops.operator_defaults import Defaults
from ..instances.making import activate, all_strips, choices
from . import operator_wants
from .active_objects import can_run

# What is asked in every area: most operators of editors want no more.
MANY = (("mesh", "EDIT"), ("grease_pencils", "OBJECT"), ("grease_pencils_v3", "OBJECT"))
# What is asked with things of the context: object and mode.
THINGS = (("mesh", "OBJECT"), ("mesh", "EDIT"))
EDITORS = (
    "VIEW_3D", "IMAGE_EDITOR", "UV", "ShaderNodeTree", "CompositorNodeTree", "GeometryNodeTree", "TextureNodeTree",
    "SEQUENCE_EDITOR", "CLIP_EDITOR", "DOPESHEET", "TIMELINE", "FCURVES", "DRIVERS", "NLA_EDITOR", "TEXT_EDITOR",
    "CONSOLE", "INFO", "OUTLINER", "PROPERTIES", "FILES", "ASSETS", "SPREADSHEET", "PREFERENCES",
)  # fmt: skip
# What people do to an interface: asked in an area that shows none, they end some of 3.4 to 5.3.
NOT_ASKED = (
    "object.modifier_copy_to_selected", "outliner.data_operation", "ui.region_clear_filter", "ui.region_start_filter",
    "ui.view_drop", "view2d.scroller_activate",
)  # fmt: skip
# The statement of what is wanted beside an area where that was not found.
ALONE = "..."
CURVES = ("CURVE", "SURFACE", "FONT")
COLLECTIONS = (
    "armatures", "lattices", "metaballs", "hair_curves", "grease_pencils", "grease_pencils_v3", "cameras", "speakers",
    "pointclouds", "volumes",
)  # fmt: skip
TRIED = (AttributeError, TypeError, RuntimeError, ValueError, KeyError)


class Stage:
    """A scene with an object of every type, and things for editors to show."""

    def __init__(self, scene):
        self.scene = scene
        self.window = bpy.context.window
        self.area = max(self.window.screen.areas, key=lambda area: area.width * area.height)
        self.image = bpy.data.images.new("image", 8, 8)
        self.text = bpy.data.texts.new("text")
        self.text.write("text")
        self.mask = bpy.data.masks.new("mask")
        self.material = bpy.data.materials.new("material")
        if hasattr(self.material, "use_nodes") and self.material.node_tree is None:
            self.material.use_nodes = True
        self.objects = {}
        for name, data in self.contents():
            with suppress(RuntimeError):  # of annotations, before 5.0
                self.objects[name] = self.linked(name, data)
        self.fill()

    def contents(self):
        """(name, data) of each object."""
        mesh = bpy.data.meshes.new("mesh")
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
        mesh.uv_layers.new()
        mesh.materials.append(self.material)
        yield "mesh", mesh
        yield "empty", None
        yield "particles", mesh.copy()
        for kind in CURVES:
            yield kind, bpy.data.curves.new(kind, kind)
        for name in COLLECTIONS:
            if hasattr(bpy.data, name):
                yield name, getattr(bpy.data, name).new(name)
        yield "lights", bpy.data.lights.new("light", "POINT")

    def linked(self, name, data):
        """A new object of the scene."""
        obj = bpy.data.objects.new(name, data)
        self.scene.collection.objects.link(obj)
        return obj

    def fill(self):
        """Adds keys, groups, modifiers, particles, a bone, a strip, a keying set, a marker."""
        mesh, hair, rig = (self.objects[name] for name in ("mesh", "particles", "armatures"))
        self.scene.camera = self.objects["cameras"]
        mesh.vertex_groups.new()
        mesh.shape_key_add()
        mesh.shape_key_add()
        for kind in ("CLOTH", "FLUID", "DYNAMIC_PAINT", "MULTIRES"):
            mesh.modifiers.new(kind, kind)
        mesh.keyframe_insert("location")
        hair.modifiers.new("hair", "PARTICLE_SYSTEM")
        for system in hair.particle_systems:
            system.settings.type = "HAIR"
        activate(rig)
        bpy.ops.object.mode_set(mode="EDIT")
        rig.data.edit_bones.new("bone").tail = (0, 0, 1)
        bpy.ops.object.mode_set(mode="OBJECT")
        editor = self.scene.sequence_editor_create()
        with suppress(*TRIED):
            all_strips(editor).new_effect("color", "COLOR", 1, 1, length=20)
        if hasattr(self.window.workspace, "sequencer_scene"):
            self.window.workspace.sequencer_scene = self.scene
        with suppress(*TRIED):
            bpy.ops.rigidbody.world_add()
        self.scene.keying_sets.new()
        self.scene.timeline_markers.new("marker")
        bpy.context.view_layer.use_freestyle = True

    def states(self):
        """Goes through every object in every mode; yields (name, mode)."""
        for name, obj in self.objects.items():
            activate(obj)
            obj.select_set(True)
            for mode in choices("Object", "mode"):
                with suppress(*TRIED):
                    if obj.mode != mode:
                        bpy.ops.object.mode_set(mode=mode)
                    if obj.mode == mode:
                        yield name, mode
            if obj.mode != "OBJECT":
                bpy.ops.object.mode_set(mode="OBJECT")
            obj.select_set(False)

    def things(self):
        """(member of the context that areas give, something for it). An operator is tried with the first it takes."""
        mesh, hair = self.objects["mesh"], self.objects["particles"]
        group = bpy.data.node_groups.new("group", "GeometryNodeTree")
        found = (
            # An asset that takes no time to be drawn, and something that has a preview.
            ("id", group), ("id", self.image), ("selected_ids", [group]), ("edit_image", self.image),
            ("edit_text", self.text), ("edit_mask", self.mask), ("material", self.material), ("mesh", mesh.data),
            ("material_slot", mesh.material_slots[0]), ("modifier", mesh.modifiers[0]),
            ("point_cache", mesh.modifiers[0].point_cache), ("light", self.objects["lights"].data),
            ("camera", self.objects["cameras"].data), ("armature", self.objects["armatures"].data),
            ("world", self.scene.world), ("node", self.material.node_tree.nodes[0]),
            ("constraint", mesh.constraints.new("CHILD_OF")), ("constraint", mesh.constraints.new("ARMATURE")),
            ("particle_system", next(iter(hair.particle_systems), None)),
        )  # fmt: skip
        return [(member, thing) for member, thing in found if thing is not None]

    def show(self, editor):
        """Makes the area an editor that shows something; whether there is such an editor."""
        try:
            self.area.ui_type = editor
        except TypeError:
            return False
        space = self.area.spaces.active
        with suppress(*TRIED):
            if editor in {"IMAGE_EDITOR", "UV"}:
                space.image = self.image
            elif editor == "TEXT_EDITOR":
                space.text = self.text
            elif editor == "ShaderNodeTree":
                space.node_tree = self.material.node_tree
        return True

    def within(self):
        """The context of the area."""
        region = next(region for region in self.area.regions if region.type == "WINDOW")
        return bpy.context.temp_override(
            window=self.window, screen=self.window.screen, area=self.area, region=region
        )


def works(operator, member, thing):
    """Whether an operator does its work, and Blender goes on, with one member of the context and no area."""
    if operator is None or not can_work_apart():
        return False

    def work():
        with bpy.context.temp_override(area=None, region=None, **{member: thing}):
            return "FINISHED" in operator()

    return apart(work)


def find_all(write, known, scene):
    """What each of these operators wants that runs in areas, with a thing of theirs, or with something set.

    One ``operator_areas`` record, without ``areas`` where a setting is enough; ``operator_refused`` for one that never
    ran. ``scene`` is an empty one.
    """
    stage = Stage(scene)
    things = stage.things()
    given, areas = {}, defaultdict(set)
    known = {path: operator for path, operator in known.items() if not path.endswith(NOT_ASKED)}
    defaults = Defaults(known)
    left = dict(known)
    for state in stage.states():
        for path in can_run(left):
            del left[path]
        if state in THINGS:
            for member, thing in things:
                with bpy.context.temp_override(area=None, region=None, **{member: thing}):
                    for path in can_run(left):
                        given.setdefault(path, (member, thing))
        for editor in EDITORS if state in MANY else EDITORS[:1]:
            if stage.show(editor):
                with stage.within():
                    running = can_run(left)
                    defaults.ask(running)
                    for path in running:
                        areas[path].add(stage.area.type)
    given = {path: member for path, (member, thing) in given.items() if works(left.get(path), member, thing)}
    found = operator_wants.find(write, known, areas, EDITORS, defaults)
    for path in sorted(known):
        needs, types, also = found.get(path, ({}, sorted(areas[path] if path in left else ()), [ALONE]))
        if types or path in given:
            more = {"needs": needs, "also": also} if types else {}
            write("operator_areas", path=path, areas=types, given=given.get(path, ""), **more)
        elif path in found:
            write("operator_areas", path=path, needs=needs)
        elif path in left:
            write("operator_refused", path=path)
    defaults.write(write)
