"""Render passes by the names that they had before Blender 5.0."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

from kb_build.versions.successors import load_successors

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_OUTPUTS = 'bpy.types.CompositorNodeRLayers.outputs["'
_START = """\
import bpy
scene = bpy.context.scene
scene.render.engine = 'CYCLES'
layer = bpy.context.view_layer
for each in layer.bl_rna.properties.keys(): setattr(layer, each, True) if each.startswith("use_pass") else None
for each in layer.cycles.bl_rna.properties.keys(): setattr(layer.cycles, each, True) if "pass_vol" in each else None
tree = bpy.data.node_groups.new("c", "CompositorNodeTree")
layers = tree.nodes.new("CompositorNodeRLayers")
layers.scene = scene
"""


def test_former_names_are_refused_and_the_new_ones_are_there(rule_checker: Checker, tmp_path: Path) -> None:
    start = _START.splitlines()
    names = [
        row.old.removeprefix(_OUTPUTS).removesuffix('"]')
        for row in load_successors()
        if row.old.startswith(_OUTPUTS)
    ]
    assert len(names) == 17
    former = [f"layers.outputs[{name!r}]" for name in names]
    found = rule_checker.check("\n".join([*start, *former]), rules=["former-pass"])
    new = [f"layers.outputs[{one.fix.edits[0].text}]" for one in found if one.fix]
    seen = run_statements(tmp_path, [*start, *former, *new])
    refused = [at for at, (error, *_) in enumerate(seen, 1) if error]
    lines = [one.span.line for one in found]
    assert lines == refused == list(range(len(start) + 1, len(start) + len(former) + 1))
    assert len(new) == len(former)
    assert rule_checker.check("\n".join([*start, *new]), rules=["former-pass"]) == []


def test_a_pass_of_the_script_is_its_own(rule_checker: Checker) -> None:
    code = f"{_START}aov = layer.aovs.add()\naov.name = 'AO'\nlayers.outputs['AO']\nlayers.outputs['Env']\n"
    (found,) = rule_checker.check(code, rules=["former-pass"])
    assert "'Env'" in found.message


def test_other_nodes_have_what_outputs_they_have(rule_checker: Checker) -> None:
    code = f"{_START}image = tree.nodes.new('CompositorNodeImage')\nimage.outputs['DiffCol']\n"
    assert rule_checker.check(code, rules=["former-pass"]) == []


def test_outputs_that_a_view_layer_shows_are_no_finding(rule_checker: Checker) -> None:
    outputs = ("Depth", "Mist", "Diffuse Color", "CryptoObject00", "Noisy Image", "a pass of its own")
    code = f"{_START}" + "\n".join(f"layers.outputs[{name!r}]" for name in outputs)
    assert rule_checker.check(code) == []
    # Of those that are off, the warning is another rule's.
    bare = code.replace("setattr", "print")
    assert {one.rule for one in rule_checker.check(bare)} == {"hidden-socket"}
