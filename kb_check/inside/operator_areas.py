# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the operators that run only in an area: run by a Blender with a file for its answer as the last argument.

Every operator is asked whether it can run (``poll``) with an object of every type in every mode, once without an area,
as in a Blender without a window, and once in an area of every type. Those that say yes only in areas need one, or what
areas put into the context: without an area they are asked once more with each of those things. Some say yes to these
and end Blender all the same, so each is then called in a process of its own.

Each line of the answer is ``VIEW_3D IMAGE_EDITOR: mesh.loopcut paint.sample_color``; ``any`` stands for most types,
``id=`` for what can be given instead of an area.
"""

from __future__ import annotations

import os
import sys
from collections import defaultdict
from contextlib import suppress

import bpy

MOST_AREAS = 8
MODES = (
    "EDIT", "POSE", "SCULPT", "VERTEX_PAINT", "WEIGHT_PAINT", "TEXTURE_PAINT", "PARTICLE_EDIT", "SCULPT_GREASE_PENCIL",
    "PAINT_GREASE_PENCIL", "WEIGHT_GREASE_PENCIL", "VERTEX_GREASE_PENCIL", "SCULPT_CURVES",
)  # fmt: skip
EDITORS = (
    "VIEW_3D", "IMAGE_EDITOR", "UV", "ShaderNodeTree", "CompositorNodeTree", "GeometryNodeTree", "TextureNodeTree",
    "SEQUENCE_EDITOR", "CLIP_EDITOR", "DOPESHEET", "TIMELINE", "FCURVES", "DRIVERS", "NLA_EDITOR", "TEXT_EDITOR",
    "CONSOLE", "INFO", "OUTLINER", "PROPERTIES", "FILES", "ASSETS", "SPREADSHEET", "PREFERENCES",
)  # fmt: skip
TRIED = (AttributeError, TypeError, RuntimeError, ValueError, KeyError)


def make_objects():
    """One object of every type, with what operators ask for: keys, groups, materials, modifiers, particles."""
    scene, data = bpy.context.scene, bpy.data
    mesh = data.meshes.new("mesh")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    mesh.uv_layers.new()
    mesh.materials.append(data.materials.new("material"))
    contents = {"mesh": mesh, "empty": None, "particles": mesh.copy()}
    for kind in ("CURVE", "SURFACE", "FONT"):
        contents[kind] = data.curves.new(kind, kind)
    for kind in (
        "armatures", "lattices", "metaballs", "hair_curves", "grease_pencils", "cameras", "speakers", "pointclouds",
        "volumes",
    ):  # fmt: skip
        if hasattr(data, kind):
            contents[kind] = getattr(data, kind).new(kind)
    contents["light"] = data.lights.new("light", "POINT")
    objects = {name: data.objects.new(name, content) for name, content in contents.items()}
    for obj in objects.values():
        scene.collection.objects.link(obj)
    scene.camera = objects["cameras"]
    whole = objects["mesh"]
    whole.vertex_groups.new()
    whole.shape_key_add()
    whole.shape_key_add()
    for kind in ("CLOTH", "FLUID", "DYNAMIC_PAINT", "MULTIRES"):
        whole.modifiers.new(kind, kind)
    whole.keyframe_insert("location")
    objects["particles"].modifiers.new("hair", "PARTICLE_SYSTEM")
    for system in objects["particles"].particle_systems:
        system.settings.type = "HAIR"
    return list(objects.values())


def make_data():
    """What editors show: a bone, a strip, an image, a text, a keying set, a marker."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    layer.objects.active = bpy.data.objects["armatures"]
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.data.armatures["armatures"].edit_bones.new("bone").tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    editor = scene.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences  # pyright: ignore[reportAttributeAccessIssue]
    with suppress(*TRIED):
        strips.new_effect("color", "COLOR", 1, 1, length=20)
    with suppress(*TRIED):
        bpy.ops.rigidbody.world_add()
    scene.keying_sets.new()
    scene.timeline_markers.new("marker")
    layer.use_freestyle = True
    bpy.data.images.new("image", 8, 8)
    bpy.data.texts.new("text").write("text")
    bpy.data.masks.new("mask")


def operators():
    """Name → operator."""
    found = {}
    for module in dir(bpy.ops):
        for name in dir(getattr(bpy.ops, module)):
            found[f"{module}.{name}"] = getattr(getattr(bpy.ops, module), name)
    return found


def polled(known):
    """The operators that can run here and now."""
    found = set()
    for name, operator in known.items():
        with suppress(*TRIED):
            if operator.poll():
                found.add(name)
    return found


def show(area, editor):
    """Makes an area an editor that shows something; whether there is such an editor."""
    try:
        area.ui_type = editor
    except TypeError:
        return False
    space = area.spaces.active
    with suppress(*TRIED):
        if editor in {"IMAGE_EDITOR", "UV"}:
            space.image = bpy.data.images["image"]
        elif editor == "TEXT_EDITOR":
            space.text = bpy.data.texts["text"]
        elif editor == "ShaderNodeTree":
            space.node_tree = bpy.data.materials["material"].node_tree
    return True


def members():
    """Members of the context that areas give, with something for each."""
    data = bpy.data
    whole = data.objects["mesh"]
    return {
        "id": whole, "selected_ids": [whole], "edit_image": data.images["image"], "edit_text": data.texts["text"],
        "edit_mask": data.masks["mask"], "material": data.materials["material"], "mesh": whole.data,
        "material_slot": whole.material_slots[0], "modifier": whole.modifiers[0], "light": data.lights["light"],
        "camera": data.cameras["cameras"], "armature": data.armatures["armatures"],
        "world": bpy.context.scene.world, "node": data.materials["material"].node_tree.nodes[0],
        "particle_system": data.objects["particles"].particle_systems[0],
    }  # fmt: skip


def works(operator, member, thing):
    """Whether an operator does its work, and Blender goes on, with one member of the context and no area."""
    process = os.fork()
    if not process:
        done = set()
        with suppress(BaseException), bpy.context.temp_override(area=None, region=None, **{member: thing}):
            done = operator()
        os._exit("FINISHED" not in done)
    return os.waitpid(process, 0)[1] == 0


def states(objects):
    """Goes through every object in every mode; yields in each."""
    layer = bpy.context.view_layer
    for obj in objects:
        for other in objects:
            other.select_set(other is obj)
        layer.objects.active = obj
        yield
        for mode in MODES:
            with suppress(*TRIED):
                bpy.ops.object.mode_set(mode=mode)
            if obj.mode != mode:
                continue
            with suppress(*TRIED):
                getattr(bpy.ops, obj.type.lower()).select_all(action="SELECT")
            yield
            with suppress(*TRIED):
                bpy.ops.object.mode_set(mode="OBJECT")


def main(path):
    """Writes the answer."""
    objects = make_objects()
    make_data()
    known = operators()
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda one: one.width * one.height)
    without, within, given = set(), defaultdict(set), {}
    for _ in states(objects):
        without |= polled(known)
        for member, thing in members().items():
            with bpy.context.temp_override(area=None, region=None, **{member: thing}):
                for name in polled(known):
                    given.setdefault(name, member)
        for editor in EDITORS:
            if not show(area, editor):
                continue
            region = next(one for one in area.regions if one.type == "WINDOW")
            with bpy.context.temp_override(window=window, screen=window.screen, area=area, region=region):
                for name in polled(known):
                    within[name].add(area.type)
    lines = defaultdict(list)
    for name, areas in sorted(within.items()):
        if name not in without:
            where = "any" if len(areas) > MOST_AREAS else " ".join(sorted(areas))
            member = given.get(name, "")
            instead = f" {member}=" if member and works(known[name], member, members()[member]) else ""
            lines[where + instead].append(name)
    with open(path, "w", encoding="utf-8") as file:
        file.writelines(f"{areas}: {' '.join(names)}\n" for areas, names in sorted(lines.items()))


if __name__ == "__main__":
    main(sys.argv[-1])
