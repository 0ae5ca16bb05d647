"""Passes that a script asks a Render Layers node for, and no new view layer has."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

if TYPE_CHECKING:
    from pathlib import Path

    from .conftest import Check

_START = """\
import bpy
scene = bpy.context.scene
if hasattr(scene, "compositing_node_group"):
    tree = scene.compositing_node_group = bpy.data.node_groups.new("tree", "CompositorNodeTree")
else:
    scene.use_nodes = True
    tree = scene.node_tree
"""
_NODE = 'layers = tree.nodes.new("CompositorNodeRLayers")\n'
# Pass → the setting that turns it on.
_PASSES = {
    "Depth": "use_pass_z",
    "Mist": "use_pass_mist",
    "Normal": "use_pass_normal",
    "CryptoObject00": "use_pass_cryptomatte_object",
}
_ASK = """
import json, sys
found = {}
for name in json.load(open(sys.argv[-1])):
    try:
        layers.outputs[name]
        found[name] = True
    except KeyError:
        found[name] = False
open(sys.argv[-1], "w").write(json.dumps(found))
"""


def _there(before: str, folder: Path) -> dict[str, bool]:
    """Pass → whether Blender's node has it in a new file, after some statements."""
    return told_by_blender(_START + before + _NODE + _ASK, folder, [*_PASSES, "Image"])


def _turned_on() -> str:
    return "".join(f"bpy.context.view_layer.{setting} = True\n" for setting in _PASSES.values())


def test_a_pass_that_is_off_is_a_warning_and_the_picture_is_none(check: Check, tmp_path: Path) -> None:
    there = _there("", tmp_path)
    assert there == dict.fromkeys(_PASSES, False) | {"Image": True}
    for name, is_there in there.items():
        found = check("hidden-socket", f'{_START}{_NODE}layers.outputs["{name}"]\n')
        assert [one.severity for one in found] == ([] if is_there else ["warning"])
        assert all(f"view_layer.{_PASSES[name]}=True" in one.message for one in found)


def test_a_pass_that_the_script_turns_on_is_none(check: Check, tmp_path: Path) -> None:
    for name, is_there in _there(_turned_on(), tmp_path).items():
        assert is_there, name
        assert not check("hidden-socket", f'{_START}{_turned_on()}{_NODE}layers.outputs["{name}"]\n')


@pytest.mark.parametrize(
    "asked",
    [
        'if "Depth" in layers.outputs:\n    layers.outputs["Depth"]\n',
        'try:\n    layers.outputs["Depth"]\nexcept KeyError:\n    pass\n',
        'setattr(bpy.context.view_layer, name, True)\nlayers.outputs["Depth"]\n',
    ],
)
def test_where_a_script_asks_or_does_more_than_it_shows_nothing_is_said(check: Check, asked: str) -> None:
    assert not check("hidden-socket", _START + _NODE + asked)


def test_a_node_of_the_file_is_not_known_to_lack_it(check: Check) -> None:
    assert not check(
        "hidden-socket", f'{_START}layers = tree.nodes["Render Layers"]\nlayers.outputs["Depth"]\n'
    )
