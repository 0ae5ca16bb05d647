"""What nodes take in some kinds of trees only: values of settings, types of items, the other node of a zone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_TREES = ("ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree")
_NODES = {
    "ShaderNodeMix": ("FLOAT", "VECTOR", "RGBA", "ROTATION"),
    "GeometryNodeMenuSwitch": (
        *("FLOAT", "RGBA", "STRING", "SHADER", "ROTATION", "MATRIX", "OBJECT", "IMAGE", "GEOMETRY", "BUNDLE"),
        *("CLOSURE", "FONT", "MENU"),
    ),
}
_ITEMS = ("FLOAT", "VECTOR", "RGBA", "SHADER", "GEOMETRY", "ROTATION", "STRING", "CLOSURE", "TEXTURE")
_ZONES = ("GeometryNodeRepeat", "GeometryNodeSimulation", "GeometryNodeForeachGeometryElement", "NodeClosure")
_MATERIAL = "import bpy\nmaterial = bpy.data.materials.new('m')\n"


def _held_against_blender(check: Check, rules: tuple[str, ...], lines: list[str], folder: Path) -> set[int]:
    """The lines that Blender refuses, which are those that the rules report."""
    refused = {at for at, (error, *_) in enumerate(run_statements(folder, lines), 1) if error}
    code = "\n".join(lines)
    assert {finding.span.line for rule in rules for finding in check(rule, code)} == refused
    return refused


def test_settings_are_refused_where_the_tree_refuses_them(check: Check, tmp_path: Path) -> None:
    lines = ["import bpy"]
    for number, kind in enumerate(_TREES):
        lines.append(f"tree{number} = bpy.data.node_groups.new('tree', {kind!r})")
        for node, values in _NODES.items():
            lines.append(f"{node.lower()}{number} = tree{number}.nodes.new({node!r})")
            lines += [f"{node.lower()}{number}.data_type = {value!r}" for value in values]
    lines += [*_MATERIAL.splitlines(), "mix = material.node_tree.nodes.new('ShaderNodeMix')"]
    lines += ["mix.data_type = 'ROTATION'", "mix.data_type = 'VECTOR'"]
    refused = _held_against_blender(check, ("refused-value", "unknown-value"), lines, tmp_path)
    assert len(refused) > 12


def test_items_of_zones_are_refused_where_the_tree_refuses_them(check: Check, tmp_path: Path) -> None:
    lines = ["import bpy"]
    for number, kind in enumerate(_TREES[:2]):
        lines.append(f"tree{number} = bpy.data.node_groups.new('tree', {kind!r})")
        lines.append(f"zone{number} = tree{number}.nodes.new('GeometryNodeRepeatOutput')")
        lines += [f"zone{number}.repeat_items.new({value!r}, 'item')" for value in _ITEMS]
    assert len(_held_against_blender(check, ("refused-call",), lines, tmp_path)) > 4


def test_only_the_two_nodes_of_one_zone_are_paired(check: Check, tmp_path: Path) -> None:
    lines = ["import bpy", "tree = bpy.data.node_groups.new('tree', 'GeometryNodeTree')"]
    lines += [
        f"{zone}{end} = tree.nodes.new('{zone}{end}')" for zone in _ZONES for end in ("Input", "Output")
    ]
    lines.append("math = tree.nodes.new('ShaderNodeMath')")
    for zone in _ZONES:
        seconds = [*(f"{other}Output" for other in _ZONES), "math", f"{zone}Input"]
        lines += [f"{zone}Input.pair_with_output({second})" for second in seconds]
    refused = _held_against_blender(check, ("refused-call",), lines, tmp_path)
    assert len(refused) == len(_ZONES) * (len(_ZONES) + 1)


@pytest.mark.parametrize(
    "code",
    [
        "for tree in trees:\n    mix = tree.nodes.new('ShaderNodeMix')\n    mix.data_type = 'ROTATION'",
        "mix = material.node_tree.nodes.new('ShaderNodeMix')\nmix = tree.nodes.new('ShaderNodeMix')\n"
        "mix.data_type = 'ROTATION'",
        "def turn(mix):\n    mix.data_type = 'ROTATION'\nmix = material.node_tree.nodes.new('ShaderNodeMix')",
        "out = trees[0].nodes.new('GeometryNodeRepeatOutput')\nout.repeat_items.new('SHADER', 'a')",
        "zone = tree.nodes.new('GeometryNodeRepeatInput')\nzone.pair_with_output(tree.nodes['Repeat Output'])",
    ],
)
def test_a_tree_that_may_be_another_is_left_alone(check: Check, code: str) -> None:
    made = (
        f"{_MATERIAL}trees = bpy.data.node_groups\ntree = bpy.data.node_groups.new('t', 'GeometryNodeTree')\n"
    )
    assert not [*check("refused-value", made + code), *check("refused-call", made + code)]


def test_values_of_another_tree_are_not_offered(check: Check) -> None:
    code = f"{_MATERIAL}mix = material.node_tree.nodes.new('ShaderNodeMix')\nmix.data_type = 'COLOR'\n"
    (found,) = check("unknown-value", code)
    assert "`RGBA`" in found.message
    assert "ROTATION" not in found.message


def test_a_reroute_keeps_the_names_of_its_sockets(check: Check, tmp_path: Path) -> None:
    lines = ["import bpy"]
    for number, kind in enumerate(_TREES):
        lines.append(f"tree{number} = bpy.data.node_groups.new('tree', {kind!r})")
        lines.append(f"reroute{number} = tree{number}.nodes.new('NodeReroute')")
        lines += [f"reroute{number}.inputs[{name!r}]" for name in ("Input", "In", "Color")]
        lines += [f"reroute{number}.outputs[{name!r}]" for name in ("Output", "Out", "Input")]
    lines += ["reroute1.socket_idname = 'NodeSocketGeometry'", "reroute1.inputs['Input']"]
    assert len(_held_against_blender(check, ("unknown-socket",), lines, tmp_path)) == 4 * len(_TREES)


def test_a_socket_that_is_nearly_called_so_is_told_before_items_are_advised(check: Check) -> None:
    made = (
        "import bpy\ntree = bpy.data.node_groups.new('t', 'GeometryNodeTree')\n"
        "zone = tree.nodes.new('GeometryNodeRepeatInput')\n"
    )
    (found,) = check("unknown-socket", f"{made}zone.inputs['Iteration']\n")
    assert found.message.endswith("Closest: `Iterations`.")
    (other,) = check("unknown-socket", f"{made}zone.inputs['Thing']\n")
    assert "the `new` of its items" in other.message


def test_arrays_are_filled_with_one_sequence(check: Check, tmp_path: Path) -> None:
    lines = ["import bpy", "image = bpy.data.images.new('i', 2, 2)", "mesh = bpy.data.meshes['Cube']"]
    lines += ["image.pixels.foreach_set([0.0] * 16)", "image.pixels.foreach_set([0.0] * 16, 1)"]
    lines += ["image.pixels.foreach_get([0.0] * 16)", "image.pixels.foreach_get('pixels', [0.0] * 16)"]
    lines += ["mesh.vertices.foreach_set('co', [0.0] * 24)", "mesh.vertices.foreach_set('co', [0.0] * 24, 1)"]
    assert len(_held_against_blender(check, ("positional-argument",), lines, tmp_path)) == 3


def test_a_number_in_the_place_of_several_is_called_one(check: Check) -> None:
    (found,) = check("wrong-type", "import bpy\nbpy.data.objects['Cube'].location = 3\n")
    assert found.message.startswith("`bpy.types.Object.location` takes 3 floats, not the single number 3.")
