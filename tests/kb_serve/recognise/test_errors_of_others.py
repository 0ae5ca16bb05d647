"""Messages as scripts for other Blenders and add-ons get them, with the line that failed: what is said first."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

if TYPE_CHECKING:
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase

_FIRST = {
    # What this Blender has, and the one of the message has not yet.
    "AttributeError: 'PoseBone' object has no attribute 'select'\nbone.select = True": (
        "since 5.0: the message is an older one's. There, use `bpy.types.Bone.select`."
    ),
    "RuntimeError: Error: Node type ShaderNodeSeparateColor undefined": "since 3.3: the message is an older one's.",
    "ModuleNotFoundError: No module named 'bl_math'": "the message is an older one's.",
    "AttributeError: 'module' object has no attribute 'ImageStrip'": "the message is an older one's.",
    'TypeError: UILayout.label(): error with keyword argument "icon" -  enum "WARNING_LARGE" not found in '
    "('NONE', 'QUESTION', 'ERROR')": "Blender 5.1 takes `WARNING_LARGE` for",
    'TypeError: Converting py args to operator properties: : keyword "use_active_scene" unrecognized\n'
    'bpy.ops.export_scene.gltf(filepath="a.glb", use_active_scene=True)': "takes `use_active_scene` in Blender 5.1",
    # What another kind of the same thing has.
    "AttributeError: 'PointLight' object has no attribute 'angle'": "test `light.type == 'SUN'` before.",
    "AttributeError: 'SpaceProperties' object has no attribute 'region_3d'\nview = area.spaces[0].region_3d": (
        "test `space.type == 'VIEW_3D'` before."
    ),
    # What was renamed, and lacks the name all the same.
    "AttributeError: 'ColorSequence' object has no attribute 'input_1'": "`bpy.types.ColorStrip` has no `input_1`",
    "AttributeError: 'ImageSequence' object has no attribute 'filepath'": (
        "strip.directory + strip.elements[0].filename"
    ),
    # What the line has besides is not what failed.
    "ReferenceError: StructRNA of type Scene has been removed\nsettings = scene.my_settings": (
        "look it up again by name"
    ),
    "AttributeError: 'str' object has no attribute 'scene'\nif context.scene.my_settings.on:": (
        "Take `bpy.context.scene`"
    ),
    "AttributeError: 'NoneType' object has no attribute 'name'\nprint(slot.material.name)": (
        "The object before `.name`, `bpy.types.MaterialSlot.material`, is None"
    ),
    "IndexError: bpy_prop_collection[index]: index 9 out of range, size 2\nnode.outputs[9]": "node.outputs.keys()",
    "IndexError: bpy_prop_collection[index]: index 0 out of range, size 0\nstrip = action.layers[0].strips[0]": (
        "`.layers.new(name)` adds one and `.strips.new()` adds one"
    ),
    "TypeError: bpy_struct: item.attr = val:\nnode.outputs[0].default_value = 0.5": "several are wanted",
    'KeyError: \'bpy_prop_collection[key]: key "GeometryNodes" not found\'\nobj.modifiers["GeometryNodes"]': (
        "The object has no modifier of that name"
    ),
    'KeyError: \'bpy_prop_collection[key]: key "Color2" not found\'\nlinks.new(a.outputs[0], mix.inputs["Color2"])': (
        'which has no `inputs["Color2"]`'
    ),
    'KeyError: \'bpy_prop_collection[key]: key "Depth" not found\'\nlinks.new(layers.outputs["Depth"], b.inputs[0])': (
        "only with `view_layer.use_pass_z=True`"
    ),
    # Whose they are.
    "AttributeError: module 'bpy' has no attribute 'ops'": "`import bpy` brings `bpy.ops`",
    "RuntimeError: Operator bpy.ops.my_tools.do.poll() failed, context is incorrect": "is an add-on's",
    "ReferenceError: StructRNA of type MyTool has been removed": "An operator that has ended is gone",
    "RuntimeError: Error: No module named 'my-tools'\nbpy.ops.preferences.addon_enable(module=name)": (
        "is not installed"
    ),
    # What is wanted.
    "TypeError: bpy_struct: item.attr = val: enum \"OBDATA\" not found in ('OBJECT', 'DATA')\nslot.link = kind": (
        "which has `OBJECT`, `DATA`"
    ),
    "TypeError: UILayout.prop(): error with argument 1, \"data\" -  Function.data does not support a 'None' assignment "
    "AnyType type": "`data` is None here",
    'TypeError: VertexGroup.add(): error with argument 1, "index" - ': "takes several values",
    'AttributeError: expected Panel, MyPanel class to have an "draw" attribute': "lacks `draw`",
    "AttributeError: foreach_get(..) 'Mesh.vertices[...]' elements have no attribute 'bevel_weight'": (
        "bevel_weight_vert"
    ),
    'TypeError: bpy_struct.keyframe_insert() property "angle" not animatable': "Animate `lens`.",
    "RuntimeError: Error: Cannot add node of type GeometryNodeMeshCube to node tree 'Shader Nodetree'\n"
    "  Not a geometry node tree": "is a node of a `GeometryNodeTree`",
    "TypeError: Inplace element-wise multiplication: not supported between 'Matrix' and 'Matrix' types": "`a @ b`",
    "Matrix multiplication: not supported between 'Matrix' and 'Vector' types": "that pip installs",
    'Failed to load manifest from: missing "license"': 'license = ["SPDX:GPL-3.0-or-later"]',
    'Archive has no manifest: "blender_manifest.toml"': "is a legacy add-on",
    'TypeError: Converting py args to operator properties: : keyword "undo" unrecognized\n'
    "bpy.ops.transform.translate(undo=True)": "bpy.ops.transform.translate('EXEC_DEFAULT', True, …)",
}


@pytest.mark.parametrize(("message", "said"), _FIRST.items())
def test_the_cause_is_told_above_the_page(kb: KnowledgeBase, message: str, said: str) -> None:
    assert said in kb.query(message).text.partition("\n## ")[0]


@pytest.mark.parametrize(
    "message",
    [
        "ReferenceError: StructRNA of type Scene has been removed\nsettings = scene.my_settings",
        "TypeError: '_PropertyDeferred' object is not subscriptable\nname = preferences.my_settings[1]",
        "AttributeError: 'Keyframe' object has no attribute 'co_ui'\nx = key.co_ui.x",
        "AttributeError: 'str' object has no attribute 'scene'\nif context.scene.my_settings.on:",
    ],
)
def test_what_the_line_has_besides_is_not_denied(kb: KnowledgeBase, message: str) -> None:
    assert "has no `" not in kb.query(message).text


_TOLD_TO_DO = """
import json, sys
import bpy
from bpy_extras import anim_utils

def told():
    bpy.ops.transform.translate('EXEC_DEFAULT', True, value=(0, 0, 1))
    action = bpy.data.actions.new("a")
    assert len(action.layers) == 0
    layer = action.layers.new("l")
    assert len(layer.strips) == 0
    layer.strips.new(type='KEYFRAME')
    strips = bpy.context.scene.sequence_editor_create().strips
    image = strips.new_image("i", sys.argv[-1], 1, 1)
    assert not hasattr(image, "filepath") and image.elements[0].filename and image.directory
    assert not hasattr(strips.new_effect("c", 'COLOR', 2, 1, length=5), "input_1")
    lights = {kind: bpy.data.lights.new("l", kind) for kind in ('SUN', 'POINT')}
    assert hasattr(lights['SUN'], "angle") and not hasattr(lights['POINT'], "angle")
    spaces = {area.type: area.spaces.active for area in bpy.context.screen.areas} if bpy.context.screen else {}
    assert all(hasattr(space, "region_3d") == (kind == 'VIEW_3D') for kind, space in spaces.items())
    try:
        bpy.data.materials.new("m").node_tree.nodes.new("ShaderNodeMix").outputs.new("NodeSocketFloat", "x")
    except RuntimeError:
        return "done"

open(sys.argv[-1], "a").close()
answer = told()
open(sys.argv[-1], "w").write(json.dumps(answer))
"""


def test_what_is_told_is_so_in_blender(tmp_path: Path) -> None:
    assert told_by_blender(_TOLD_TO_DO, tmp_path, []) == "done"
