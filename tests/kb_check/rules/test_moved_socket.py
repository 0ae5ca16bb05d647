"""Sockets by their places: the rule says what this Blender has there, as a node of its own tells."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy
tree = bpy.data.node_groups.new("t", "ShaderNodeTree")
nodes = tree.nodes
principled = nodes.new("ShaderNodeBsdfPrincipled")
voronoi = nodes.new("ShaderNodeTexVoronoi")
mix = nodes.new("ShaderNodeMixShader")
"""


@pytest.mark.parametrize(
    ("asked", "was"),
    [
        ("principled.inputs[9]", "'Subsurface Scale' in 4.2, 'Roughness' in 3.4"),
        ("principled.inputs[1]", "'Subsurface' in 3.4"),
        ("voronoi.inputs[5]", "'Randomness' in 3.4"),
    ],
)
def test_what_stood_there_is_told(asked: str, was: str, check: Check, tmp_path: Path) -> None:
    (found,) = check("moved-socket", f"{_START}print({asked})\n")
    ((error, _, name),) = run_statements(tmp_path, [_START], {0: f"{asked}.name"})
    assert not error
    assert f"is {name} in Blender" in found.message
    assert f"it was {was}." in found.message


@pytest.mark.parametrize(
    "asked",
    [
        "principled.inputs[0]",  # the same in all
        "principled.inputs['Roughness']",
        "mix.inputs[0]",  # only its name is another
        "principled.inputs[-1]",
        "principled.inputs[99]",
        "[node for node in nodes][0].inputs[9]",
        "nodes[9]",
    ],
)
def test_what_has_not_moved_has_no_finding(asked: str, check: Check) -> None:
    assert check("moved-socket", f"{_START}print({asked})\n") == []


def test_code_for_another_blender_has_none(check: Check) -> None:
    code = f"{_START}if bpy.app.version < (4, 0, 0):\n    print(principled.inputs[9])\n"
    assert check("moved-socket", code) == []
