"""Animatable is what Blender puts keys on: that depends on what owns it, which RNA's own flag does not ask."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from kb_build.blender.extract_reader import Extract

pytestmark = pytest.mark.blender

MAKING = """
import bpy
scene, obj = bpy.context.scene, bpy.data.objects["Cube"]
for kind in ("ARRAY", "BEVEL", "CLOTH", "SUBSURF", "NODES", "WAVE", "OCEAN", "MIRROR", "SOLIDIFY", "DISPLACE"):
    obj.modifiers.new(kind, kind)
for kind in ("COPY_LOCATION", "TRACK_TO", "LIMIT_SCALE", "CHILD_OF", "TRANSFORM"):
    obj.constraints.new(kind)
obj.shape_key_add(name="Basis")
material = bpy.data.materials.new("m")
nodes = [material.node_tree.nodes.new(f"ShaderNode{kind}") for kind in ("Math", "TexNoise", "Mapping", "ValToRGB")]
strips = scene.sequence_editor_create().strips
color = strips.new_effect("c", "COLOR", channel=1, frame_start=1, length=9)
text = strips.new_effect("t", "TEXT", channel=2, frame_start=1, length=9)
curve = bpy.data.curves.new("c", "CURVE")
spline = curve.splines.new("BEZIER")
bent = bpy.data.objects.new("bent", curve)
scene.collection.objects.link(bent)
bent.shape_key_add(name="Basis")
armature = bpy.data.armatures.new("a")
rig = bpy.data.objects.new("rig", armature)
scene.collection.objects.link(rig)
bpy.context.view_layer.objects.active = rig
bpy.ops.object.mode_set(mode="EDIT")
armature.edit_bones.new("b").tail = (0, 0, 1)
bpy.ops.object.mode_set(mode="OBJECT")
image, space = bpy.data.images.new("i", 4, 4), bpy.data.screens["Layout"].areas
view = next(area.spaces[0] for area in space if area.type == "VIEW_3D")
preferences = bpy.context.preferences
keymap = bpy.context.window_manager.keyconfigs.active.keymaps["Object Mode"]
key = keymap.keymap_items.new("object.delete", "X", "PRESS")
action = bpy.data.actions.new("act")
channels = action.layers.new("l").strips.new(type="KEYFRAME").channelbag(action.slots.new("OBJECT", "s"), ensure=True)
moved = channels.fcurves.new("location")
blended = obj.animation_data_create().nla_tracks.new().strips.new("s", 1, action)
blended.use_animated_influence = True
"""
ANIMATED = (
    *("obj", "scene", "scene.render", "scene.eevee", "scene.view_settings", "scene.render.image_settings", "rig"),
    *("obj.data", "material", "curve", "spline", "spline.bezier_points[0]", "armature", "armature.bones[0]"),
    *("rig.pose.bones[0]", "obj.data.shape_keys.key_blocks[0]", "bent.data.shape_keys.key_blocks[0].data[0]"),
    *("bpy.data.cameras[0]", "bpy.data.cameras[0].dof", "bpy.data.lights[0]", "bpy.data.worlds[0]", "color", "text"),
    *("color.crop", "color.transform", "obj.display", "scene.display.shading"),
    *("obj.modifiers['CLOTH'].settings", "obj.modifiers['CLOTH'].collision_settings", "scene.cycles", "obj.field"),
    *("scene.display", "scene.tool_settings", "bpy.data.speakers.new('s')", "bpy.data.metaballs.new('m')"),
    *("bpy.data.lattices.new('l')", "bpy.data.volumes.new('v').render", "nodes[3].color_ramp.elements[0]"),
    *("bpy.data.masks.new('m')", "bpy.data.textures.new('t', 'CLOUDS')", "bpy.data.linestyles.new('l')"),
    *("bpy.data.particles.new('p')", "bpy.data.lightprobes.new('p', type='SPHERE')"),
    "*obj.modifiers", "*obj.constraints", "*nodes", "*[node.inputs[0] for node in nodes]",
)  # fmt: skip
NEVER_ANIMATED = (
    *("image", "bpy.data.brushes.new('b')", "bpy.data.texts.new('t')", "bpy.data.collections.new('c')", "action"),
    *("moved", "moved.keyframe_points.insert(1, 1)", "channels.groups.new('g')", "view", "view.overlay"),
    *("view.region_3d", "space[0]", "bpy.data.screens[0]", "bpy.data.workspaces[0]", "bpy.context.window_manager"),
    *("preferences.view", "key", "keymap", "preferences.edit", "preferences.system", "preferences.filepaths"),
    "preferences.inputs",
    *("preferences.themes[0].user_interface", "bpy.data.palettes.new('p')", "bpy.context.window_manager.windows[0]"),
)  # fmt: skip
OF_ACTIONS = (
    *("moved", "moved.keyframe_points.insert(1, 1)", "channels.groups.new('g')", "action.slots[0]"),
    *("obj.driver_add('location', 1)", "obj.driver_add('location', 2).driver"),
    *(f"moved.modifiers.new('{kind}')" for kind in ("GENERATOR", "NOISE", "LIMITS", "STEPPED", "ENVELOPE")),
)
ANIMATION_DATA = ("obj.animation_data", "blended")
SHARED = {"ID"}
# Of what an expression gives, each property that RNA calls animatable: its path where it is declared, and the error.
ASKED = """
import json, sys
def declared(rna, name):
    pointer = rna.properties[name].as_pointer()
    while rna.base and (above := rna.base.properties.get(name)) and above.as_pointer() == pointer:
        rna = rna.base
    return f"bpy.types.{rna.identifier}.{name}"
answers = []
for expression in json.load(open(sys.argv[-1])):
    for thing in eval(f"[{expression}]"):
        for prop in getattr(thing, "bl_rna").properties if hasattr(thing, "keyframe_insert") else ():
            if prop.is_animatable:
                try:
                    thing.keyframe_insert(prop.identifier)
                    error = ""
                except Exception as refusal:
                    error = f"{type(refusal).__name__}: {refusal}"
                answers.append([declared(thing.bl_rna, prop.identifier), error])
open(sys.argv[-1], "w").write(json.dumps(answers))
"""


@pytest.fixture(scope="module")
def animatable(extract: Extract) -> Mapping[str, bool]:
    return {s.path: "animatable" in s.flags for s in extract.symbols if s.kind == "property"}


def _asked(folder: Path, expressions: tuple[str, ...]) -> list[list[str]]:
    return told_by_blender(MAKING + ASKED, folder, list(expressions), seconds=240)


def _classes(paths: set[str]) -> set[str]:
    return {path.rpartition(".")[0] for path in paths}


def test_what_takes_keys_is_animatable(animatable: Mapping[str, bool], tmp_path: Path) -> None:
    keyed = {path for path, error in _asked(tmp_path, ANIMATED) if not error}
    assert len(keyed) > 1000
    assert len(_classes(keyed)) > 60
    assert [path for path in keyed if not animatable[path]] == []


def test_what_no_data_block_with_animation_data_holds_is_not(
    animatable: Mapping[str, bool], tmp_path: Path
) -> None:
    answers = _asked(tmp_path, NEVER_ANIMATED)
    refused = {path for path, error in answers if error}
    assert [path for path, error in answers if not error] == []
    assert len(refused) > 400
    assert len(_classes(refused)) > 20
    # Other data-blocks have what is declared for all.
    shared = {path for path in refused if path.split(".")[2] in SHARED}
    assert _classes(shared) == {f"bpy.types.{name}" for name in SHARED}
    assert [path for path in refused - shared if animatable[path]] == []


def test_what_an_action_holds_takes_no_key(animatable: Mapping[str, bool], tmp_path: Path) -> None:
    answers = _asked(tmp_path, OF_ACTIONS)
    refused = {path for path, error in answers if error}
    assert [path for path, error in answers if not error] == []
    assert len(_classes(refused)) > 8
    assert [path for path in refused if animatable[path]] == []


def test_animation_data_and_strips_that_blend_actions_do(
    animatable: Mapping[str, bool], tmp_path: Path
) -> None:
    keyed = {path for path, error in _asked(tmp_path, ANIMATION_DATA) if not error}
    assert {"bpy.types.AnimData.action_influence", "bpy.types.NlaStrip.influence"} <= keyed
    assert [path for path in keyed if not animatable[path]] == []


def test_what_others_have_like_an_action_stays(animatable: Mapping[str, bool]) -> None:
    assert animatable["bpy.types.TimelineMarker.frame"]


@pytest.mark.parametrize(
    "path",
    ["Event.type", "Operator.bl_options", "KeyMapItem.active", "Sound.use_mono", "PreferencesView.ui_scale"],
)
def test_what_cannot_be_made_here_is_not_either(animatable: Mapping[str, bool], path: str) -> None:
    assert not animatable.get(f"bpy.types.{path}")


def test_collections_that_are_held_count(animatable: Mapping[str, bool]) -> None:
    assert animatable["bpy.types.PointCaches.active_index"]
