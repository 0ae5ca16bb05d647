"""Render passes by the names that they had before Blender 5.0."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

from kb_check.rules.former_pass import NAMES

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

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
    former = [f"layers.outputs[{name!r}]" for name in NAMES]
    new = [f"layers.outputs[{name!r}]" for name in NAMES.values()]
    seen = run_statements(tmp_path, [*start, *former, *new])
    refused = [at for at, (error, *_) in enumerate(seen, 1) if error]
    found = rule_checker.check("\n".join([*start, *former, *new]), rules=["former-pass"])
    assert (
        [one.span.line for one in found]
        == refused
        == list(range(len(start) + 1, len(start) + len(former) + 1))
    )
    assert [one.fix.edits[0].text for one in found if one.fix] == [repr(name) for name in NAMES.values()]


def test_a_pass_of_the_script_is_its_own(rule_checker: Checker) -> None:
    code = f"{_START}aov = layer.aovs.add()\naov.name = 'AO'\nlayers.outputs['AO']\nlayers.outputs['Env']\n"
    (found,) = rule_checker.check(code, rules=["former-pass"])
    assert "'Env'" in found.message


def test_other_nodes_have_what_outputs_they_have(rule_checker: Checker) -> None:
    code = f"{_START}image = tree.nodes.new('CompositorNodeImage')\nimage.outputs['DiffCol']\n"
    assert rule_checker.check(code, rules=["former-pass"]) == []
