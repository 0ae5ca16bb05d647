"""Every class of nodes in every kind of tree: reported are those that the tree refuses, and no others."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_build.index.analysis import words
from kb_build.symbols.paths import last_name

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_TREES = ("ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree", "TextureNodeTree")
_CLASSES = """
import json
import bpy
kinds = [getattr(bpy.types, name) for name in dir(bpy.types)]
nodes = [kind.__name__ for kind in kinds if isinstance(kind, type) and issubclass(kind, bpy.types.Node)]
print(json.dumps(nodes))
"""


def test_nodes_that_a_tree_refuses_are_reported_and_no_others(check: Check, tmp_path: Path) -> None:
    listed = subprocess.run([sys.executable, "-c", _CLASSES], capture_output=True, check=True, text=True)
    names = json.loads(listed.stdout.splitlines()[-1])
    lines = [
        "import bpy",
        *(f"{kind.lower()} = bpy.data.node_groups.new('tree', '{kind}')" for kind in _TREES),
    ]
    lines += [f"{kind.lower()}.nodes.new('{name}')" for kind in _TREES for name in names]
    answers = run_statements(tmp_path, lines)
    refused = {place for place, (error, *_) in enumerate(answers, 1) if error}
    assert len(refused) > len(names)
    assert {finding.span.line for finding in check("unknown-node", "\n".join(lines))} == refused


def test_a_label_is_reported_and_mended(rule_checker: Checker, check: Check, tmp_path: Path) -> None:
    api = rule_checker.api
    nodes = [symbol for cls in api.descendants("bpy.types.Node") if (symbol := api.symbols.symbol(cls))]
    pairs = sorted({(tree, symbol.label) for symbol in nodes for tree in symbol.trees if tree in _TREES})
    made = [
        "import bpy",
        *(f"{kind.lower()} = bpy.data.node_groups.new('tree', '{kind}')" for kind in _TREES),
    ]
    lines = [*made, *(f"{tree.lower()}.nodes.new({label!r})" for tree, label in pairs)]
    answers = run_statements(tmp_path, lines)
    refused = {place for place, (error, *_) in enumerate(answers, 1) if error}
    assert len(refused) == len(pairs)
    found = check("unknown-node", "\n".join(lines))
    assert {finding.span.line for finding in found} == refused
    fixes = {finding.span.line: finding.fix.edits[0].text for finding in found if finding.fix}
    assert len(fixes) > 0.9 * len(found)
    mended = [
        *made,
        *(f"{pairs[line - 1 - len(made)][0].lower()}.nodes.new({text})" for line, text in fixes.items()),
    ]
    assert [error for error, *_ in run_statements(tmp_path, mended) if error] == []


def test_a_name_of_the_same_words_is_reported(rule_checker: Checker, check: Check, tmp_path: Path) -> None:
    api = rule_checker.api
    nodes = [symbol for cls in api.descendants("bpy.types.Node") if (symbol := api.symbols.symbol(cls))]
    lines = [
        "import bpy",
        *(f"{kind.lower()} = bpy.data.node_groups.new('tree', '{kind}')" for kind in _TREES),
    ]
    for symbol in nodes:
        for tree in sorted({*symbol.trees} & {*_TREES}):
            behind = last_name(symbol.path).removeprefix(tree.removesuffix("Tree"))
            snake = "_".join(words(behind)).upper()
            said = (f"Node{behind.removeprefix('Node')}", snake, symbol.path)
            lines += [f"{tree.lower()}.nodes.new({name!r})" for name in said]
    answers = run_statements(tmp_path, lines)
    refused = {place for place, (error, *_) in enumerate(answers, 1) if error}
    assert len(refused) > 2 * len(nodes)
    assert {finding.span.line for finding in check("unknown-node", "\n".join(lines))} == refused


def test_a_label_that_the_script_calls_a_node_of_its_own_is_left_alone(check: Check) -> None:
    code = "import bpy\nclass Math(bpy.types.Node):\n    pass\n\ndef add(tree):\n    tree.nodes.new('Math')\n"
    assert not check("unknown-node", code)


def test_the_node_that_the_tree_has_instead_is_named(check: Check) -> None:
    code = "import bpy\ntree = bpy.data.node_groups.new('tree', 'CompositorNodeTree')\n"
    (found,) = check("unknown-node", code + "tree.nodes.new('CompositorNodeGamma')\n")
    assert found.instead == ("bpy.types.ShaderNodeGamma",)


def test_a_former_name_that_works_still_is_left_alone(
    rule_checker: Checker, check: Check, tmp_path: Path
) -> None:
    former = rule_checker.names.reader.rows("SELECT path FROM still_works WHERE path LIKE 'bpy.types.%Node%'")
    names = [last_name(path) for (path,) in former if path.count(".") == 2]
    assert "ShaderNodeBsdfGlossy" in names
    lines = ["import bpy", "tree = bpy.data.node_groups.new('tree', 'ShaderNodeTree')"]
    lines += [f"tree.nodes.new('{name}')" for name in names if name.startswith("ShaderNode")]
    assert [error for error, *_ in run_statements(tmp_path, lines) if error] == []
    assert check("unknown-node", "\n".join(lines)) == []


def test_a_tree_of_another_kind_is_left_alone(check: Check) -> None:
    code = "import bpy\ndef fill(tree):\n    tree.nodes.new('ShaderNodeMath')\n    tree.nodes.new('GeometryNodeBake')\n"
    assert not check("unknown-node", code)


def test_keywords_of_what_takes_nothing_are_reported(check: Check, tmp_path: Path) -> None:
    lines = [
        "import bpy",
        "ob = bpy.data.objects.new('object', None)",
        "ob.asset_mark(catalog='x')",
        "ob.asset_mark()",
        "ob.update_tag(refresh={'OBJECT'})",
        "mesh = bpy.data.meshes.new('mesh')",
        "mesh.calc_loop_triangles(split=True)",
        "mesh.update(calc_edges=True)",
    ]
    refused = {place for place, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error}
    assert {finding.span.line for finding in check("unknown-keyword", "\n".join(lines))} == refused == {3, 7}


@pytest.mark.parametrize(
    ("code", "is_reported"),
    [
        ('def build(nodes):\n    nodes.new("ShaderNodeTexMusgrave")', True),
        ('def build(nodes):\n    return nodes.new(type="ShaderNodeSeparateRGB")', True),
        ('def build(tree):\n    tree.nodes.new("ShaderNodeSeparateRGB")', True),
        ('def build(nodes):\n    nodes.new("ShaderNodeTexNoise")', False),
        ('def build(nodes):\n    nodes.new("GraphNodeOfAnAddon")', False),
        ('def build(nodes):\n    nodes.append(nodes.new("ShaderNodeTexMusgrave"))', False),
        (
            'def build(nodes):\n    try:\n        nodes.new("ShaderNodeTexMusgrave")\n    except RuntimeError:\n'
            '        nodes.new("ShaderNodeTexNoise")',
            False,
        ),
        ('def build(nodes: "Graph"):\n    nodes.new("ShaderNodeTexMusgrave")', False),
    ],
)
def test_a_former_node_is_reported_for_a_parameter_called_nodes(
    check: Check, code: str, *, is_reported: bool
) -> None:
    assert bool(check("unknown-node", f"import bpy\n{code}\n")) is is_reported
