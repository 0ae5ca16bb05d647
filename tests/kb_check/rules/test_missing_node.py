"""Nodes by names that none has are found: each script is run, and fails or does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy
mat = bpy.data.materials.new("M")
nodes = mat.node_tree.nodes
"""
_CLEAR = "nodes.clear()\n"
_BSDF = "nodes['Principled BSDF']"
_WRONG = {
    "of a new material": "mat.node_tree.nodes['Diffuse BSDF']",
    "by names of parts": "tree = mat.node_tree\nown = tree.nodes\nown['Principled']",
    "of a new world": "world = bpy.data.worlds.new('W')\nworld.node_tree.nodes['Sky Texture']",
    "of a new light": "sun = bpy.data.lights.new('S', 'SUN')\nsun.node_tree.nodes['Principled BSDF']",
    "beside what is made": "nodes.new('ShaderNodeMath')\nnodes['Mix']",
    "cleared": f"{_CLEAR}{_BSDF}",
    "cleared by the tree": "mat.node_tree.nodes.clear()\nout = mat.node_tree.nodes['Material Output']",
    "cleared by another name": f"{_CLEAR}mat.node_tree.nodes['Principled BSDF']",
    "cleared by the tree's name": f"tree = mat.node_tree\ntree.nodes.clear()\n{_BSDF}",
    "removed one by one": f"for node in nodes:\n    nodes.remove(node)\n{_BSDF}",
    "removed one by one, of a list": f"for node in list(mat.node_tree.nodes):\n    nodes.remove(node)\n{_BSDF}",
    "cleared, others made": f"{_CLEAR}out = nodes.new('ShaderNodeOutputMaterial')\nout.mute = True\n{_BSDF}",
}
_SOUND = {
    "there at first": f"{_BSDF}\nnodes['Material Output']",
    "made": "nodes.new('ShaderNodeMath')\nnodes.new('ShaderNodeMath')\nnodes['Math'], nodes['Math.001']",
    "named": "nodes.new('ShaderNodeMath').name = 'Sum'\nnodes['Sum']",
    "named by another name": "word = 'Sum'\nnodes.new('ShaderNodeMath').name = word\nnodes['Sum']",
    "of a kind that is computed": "for kind in ('Math', 'Mix'):\n    nodes.new('ShaderNode' + kind)\nnodes['Mix']",
    "of a copy": "twin = mat.copy()\nnodes['Material Output'].name = 'End'\nmat.copy().node_tree.nodes['End']",
    "of any material": "[n for n in bpy.data.materials[0].node_tree.nodes][0].name = 'x'\n"
    "bpy.data.materials[0].node_tree.nodes['x']",
    "cleared, made again": f"{_CLEAR}nodes.new('ShaderNodeBsdfPrincipled')\n{_BSDF}",
    "cleared, made by a helper": f"def make():\n    nodes.new('ShaderNodeBsdfPrincipled')\n{_CLEAR}make()\n{_BSDF}",
    "cleared, named": f"{_CLEAR}nodes.new('ShaderNodeMath').name = 'Sum'\nnodes['Sum']",
    "cleared in a condition": f"if not nodes:\n    {_CLEAR}{_BSDF}",
    "bound again": f"{_CLEAR}nodes = bpy.data.materials.new('N').node_tree.nodes\n{_BSDF}",
    "cleared by another name, made again": f"{_CLEAR}mat.node_tree.nodes.new('ShaderNodeBsdfPrincipled')\n{_BSDF}",
    "another material by the same name": "mat = bpy.data.materials.new('M')\nnodes.clear()\n"
    "mat.node_tree.nodes['Principled BSDF']",
    "some removed": f"for node in list(nodes):\n    if node.type == 'MIX':\n        nodes.remove(node)\n{_BSDF}",
    "others removed": f"for node in list(bpy.data.materials.new('N').node_tree.nodes):\n    print(node)\n{_BSDF}",
    "others cleared": "other = bpy.data.materials.new('N')\nother.node_tree.nodes.clear()\n" + _BSDF,
    "caught": f"{_CLEAR}try:\n    {_BSDF}\nexcept KeyError:\n    pass",
    "asked": f"{_CLEAR}print(nodes.get('Principled BSDF'), 'Principled BSDF' in nodes)",
}


def test_what_no_node_is_called_is_found(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _WRONG.values()])
    errors = {name: error.partition(":")[0] for name, (error, *_) in zip(_WRONG, answers, strict=True)}
    assert errors == dict.fromkeys(_WRONG, "KeyError")
    found = {name: check("missing-node", f"{_START}{code}") for name, code in _WRONG.items()}
    assert [name for name, findings in found.items() if len(findings) != 1] == []


def test_what_runs_has_no_finding(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _SOUND.values()])
    assert [(name, error) for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []
    assert [name for name, code in _SOUND.items() if check("missing-node", f"{_START}{code}")] == []
