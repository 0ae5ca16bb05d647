"""Links that Blender does not follow are found: each is made, and tells whether it is valid."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy
material = bpy.data.node_groups.new("m", "ShaderNodeTree")
emission = material.nodes.new("ShaderNodeEmission")
mix = material.nodes.new("ShaderNodeMixShader")
noise = material.nodes.new("ShaderNodeTexNoise")
volume = material.nodes.new("ShaderNodeVolumePrincipled")
output = material.nodes.new("ShaderNodeOutputMaterial")
dot = material.nodes.new("NodeReroute")
group = bpy.data.node_groups.new("g", "GeometryNodeTree")
cube = group.nodes.new("GeometryNodeMeshCube")
math = group.nodes.new("ShaderNodeMath")
move = group.nodes.new("GeometryNodeTransform")
turn = group.nodes.new("FunctionNodeRotationToEuler")
text = group.nodes.new("FunctionNodeInputString")
info = group.nodes.new("GeometryNodeObjectInfo")
"""
_INVALID = (
    ("material", 'emission.outputs["Emission"], mix.inputs[0]'),
    ("material", 'mix.inputs[0], emission.outputs["Emission"]'),
    ("material", 'emission.outputs[0], output.inputs["Displacement"]'),
    ("group", 'cube.outputs["Mesh"], math.inputs[0]'),
    ("group", 'math.outputs[0], move.inputs["Geometry"]'),
    ("group", "turn.inputs[0], cube.outputs['Mesh']"),
    ("group", "text.outputs[0], math.inputs[0]"),
    ("group", 'text.outputs[0], info.inputs["Object"]'),
)
_VALID = (
    ("material", "emission.outputs[0], mix.inputs[1]"),
    ("material", 'noise.outputs["Color"], output.inputs["Surface"]'),
    ("material", 'noise.outputs["Color"], mix.inputs[0]'),
    ("material", 'noise.outputs["Color"], volume.inputs["Color Attribute"]'),
    ("material", "emission.outputs[0], dot.inputs[0]"),
    ("group", 'math.outputs[0], move.inputs["Translation"]'),
    ("group", 'math.outputs[0], move.inputs["Rotation"]'),
    ("group", 'info.outputs["Geometry"], move.inputs["Geometry"]'),
)


def test_what_blender_does_not_follow_is_found(check: Check, tmp_path: Path) -> None:
    links = [f"link = {tree}.links.new({ends})" for tree, ends in (*_INVALID, *_VALID)]
    statements = [f"{_START}{link}\nbpy.context.view_layer.update()\nassert link.is_valid" for link in links]
    refused = [error.partition(":")[0] for error, *_ in run_statements(tmp_path, statements)]
    assert refused == ["AssertionError"] * len(_INVALID) + [""] * len(_VALID)
    found = [len(check("invalid-link", f"{_START}{link}\n")) for link in links]
    assert found == [1] * len(_INVALID) + [0] * len(_VALID)
