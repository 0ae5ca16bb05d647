"""Conditions on what a parameter holds: its default is only one of the values that it may have."""

from __future__ import annotations

from textwrap import indent
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_FUNCTION = """\
from mathutils import Vector


def place(pivot{annotation}="object", ready=True):
{body}
"""


def _found(checker: Checker, body: str, annotation: str = "") -> int:
    return len(checker.check(_FUNCTION.format(annotation=annotation, body=indent(body, "    "))))


@pytest.mark.parametrize(
    "body",
    [
        "if isinstance(pivot, (tuple, list)):\n    return Vector(pivot)",
        "if isinstance(pivot, (tuple, list)) and len(pivot) == 3:\n    return Vector(pivot)",
        "if ready and isinstance(pivot, tuple):\n    return Vector(pivot)",
        "if pivot == 'object':\n    return 1\nreturn Vector(pivot)",
        "if pivot in ('object', 'world'):\n    return 1\nelse:\n    return Vector(pivot)",
        "return Vector(pivot) if pivot != 'object' else 1",
        "if not isinstance(pivot, str):\n    return Vector(pivot)",
        "if isinstance(pivot, str):\n    return 1\nreturn Vector(pivot)",
        "if isinstance(pivot, (str, bytes)):\n    return 1\nreturn Vector(pivot)",
    ],
)
def test_what_is_not_the_default_may_be_anything(rule_checker: Checker, body: str) -> None:
    assert _found(rule_checker, body) == 0


@pytest.mark.parametrize(
    ("body", "annotation"),
    [
        ("return Vector(pivot)", ""),
        ("if pivot == 'world':\n    return 1\nreturn Vector(pivot)", ""),
        ("if pivot == 'object':\n    return Vector(pivot)", ""),
        ("if pivot == 'object':\n    return 1\nreturn Vector(pivot)", ": str"),
        ("if isinstance(pivot, list):\n    return 1\nreturn Vector(pivot)", ""),
    ],
)
def test_the_default_itself_is_refused(rule_checker: Checker, body: str, annotation: str) -> None:
    assert _found(rule_checker, body, annotation) == 1


def test_both_conditions_tell_what_an_attribute_is(rule_checker: Checker) -> None:
    code = """\
import bpy


class Holder:
    def use(self):
        if isinstance(self.data, bpy.types.Mesh) and self.data.users:
            return self.data.{name}
"""
    assert rule_checker.check(code.format(name="vertices")) == []
    (finding,) = rule_checker.check(code.format(name="zorn"))
    assert finding.symbol == "bpy.types.Mesh.zorn"


_ASKED = "import bpy\ndef use(data, kind):\n    if {test}:\n        return data.zorn\n"


@pytest.mark.parametrize(
    ("test", "known"),
    [
        ("type(data) == bpy.types.Mesh", True),
        ("type(data) is bpy.types.Mesh", True),
        ("type(data) in (bpy.types.Mesh, bpy.types.Camera)", True),
        ("type(data) != bpy.types.Mesh", False),
        ("type(data) is kind", False),
        ("kind(data) is bpy.types.Mesh", False),
    ],
)
def test_the_type_itself_is_asked_for(rule_checker: Checker, test: str, known: bool) -> None:
    assert bool(rule_checker.check(_ASKED.format(test=test))) is known


_MANAGED = """\
import bpy
from contextlib import contextmanager


class Card:
    @staticmethod
    @contextmanager
    def made():
        yield bpy.data.materials.new("card")

    def use(self):
        with self.made() as card:
            bpy.context.object.active_material = card
            card.{name}
"""


def test_with_gives_what_a_generator_yields(rule_checker: Checker) -> None:
    assert rule_checker.check(_MANAGED.format(name="diffuse_color")) == []
    (finding,) = rule_checker.check(_MANAGED.format(name="zorn"))
    assert finding.symbol == "bpy.types.Material.zorn"


_CONVERTED: list[str] = [
    "import bpy",
    'mesh = bpy.data.meshes.new("line")',
    "mesh.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])",
    'ob = bpy.data.objects.new("line", mesh)',
    "bpy.context.collection.objects.link(ob)",
    "bpy.context.view_layer.objects.active = ob",
    "ob.select_set(True)",
    "ob.data.bevel_depth = 1.0",
    'bpy.ops.object.convert(target="CURVE")',
    "ob.data.bevel_depth = 1.0",
    "bpy.context.view_layer.objects.active.data.bevel_depth = 1.0",
]


def test_an_object_has_other_data_once_it_is_converted(rule_checker: Checker, tmp_path: Path) -> None:
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, _CONVERTED), 1) if error]
    assert [one.span.line for one in rule_checker.check("\n".join(_CONVERTED))] == refused == [8]


_TREES: list[str] = [
    "import bpy",
    "def add(tree: bpy.types.NodeTree):"
    " tree.interface.new_socket(name='a', in_out='INPUT', socket_type='NodeSocketGeometry')",
    "add(bpy.data.node_groups.new('a', 'GeometryNodeTree'))",
]


def test_a_tree_of_any_kind_may_be_one_that_takes_it(rule_checker: Checker, tmp_path: Path) -> None:
    assert not any(error for error, *_ in run_statements(tmp_path, _TREES))
    assert rule_checker.check("\n".join(_TREES)) == []
    shaders = "\n".join(_TREES[:2]).replace("types.NodeTree", "types.ShaderNodeTree")
    (finding,) = rule_checker.check(shaders)
    assert finding.rule == "refused-value"


_KEPT: list[str] = [
    "import bpy",
    "bpy.types.kept_server.start",
    "bpy.types.kept_server = bpy.context.scene",
    "bpy.types.kept_server.name",
    "bpy.types.lost_server.name",
]


def test_what_is_assigned_to_the_module_of_types_is_there(rule_checker: Checker, tmp_path: Path) -> None:
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, _KEPT), 1) if error]
    assert refused == [2, 5]
    assert [one.span.line for one in rule_checker.check("\n".join(_KEPT))] == [5]


_AREAS = """
import bpy
for area in bpy.context.screen.areas:
    if area.type == 'VIEW_3D':
        area.spaces.active.cursor_location = (0, 0, 0)
        area.spaces.active.region_3d.view_perspective = 'CAMERA'
        area.spaces.active.image
    elif area.type in {'IMAGE_EDITOR', 'NODE_EDITOR'}:
        area.spaces.active.image
    area.spaces.active.image
    if area.type != 'NODE_EDITOR':
        continue
    area.spaces.active.tree_typ
"""


def test_the_type_of_an_area_tells_its_active_space(rule_checker: Checker) -> None:
    found = {one.span.line: one.message for one in rule_checker.check(_AREAS)}
    assert list(found) == [5, 7, 13]
    assert [
        cls in found[line] for line, cls in ((5, "SpaceView3D"), (7, "SpaceView3D"), (13, "SpaceNodeEditor"))
    ]


_NODES = """\
import bpy
material = bpy.data.materials.new("material")
nodes = material.node_tree.nodes
ramp = nodes.new("ShaderNodeValToRGB")
shader = next(node for node in nodes if node.type == 'BSDF_PRINCIPLED')
shader.inputs["Specular"].default_value = 0.5
shader.inputs["Roughness"].default_value = 0.5
[node.inputs["Specular"] for node in nodes if node.type == 'BSDF_PRINCIPLED']
[node for node in nodes if node.type == 'BSDF_PRINCIPLED'][0].inputs["Emission"]
[node.color_ramp for node in nodes if node.type == 'VALTORGB']
[node.inputs["Surface"] for node in nodes if node.type == 'OUTPUT_MATERIAL']
"""


def test_the_type_of_a_node_tells_its_class(rule_checker: Checker, tmp_path: Path) -> None:
    lines: list[str] = [*_NODES.splitlines()]
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    assert [one.span.line for one in rule_checker.check(_NODES)] == refused == [6, 8, 9]


def test_the_name_of_a_class_is_no_type_of_a_node(rule_checker: Checker) -> None:
    code = """
import bpy
for node in bpy.context.object.active_material.node_tree.nodes:
    if node.type == 'ShaderNodeEmission':
        print(node.name)
    if node.bl_idname == 'ShaderNodeEmission' or node.type == 'EMISSION':
        print(node.name)
"""
    (found,) = rule_checker.check(code)
    assert (found.rule, found.span.line) == ("never-true", 4)
    assert "'EMISSION'" in found.message


_MATCHED = """\
import bpy
ob = bpy.data.objects['Cube']
ob.modifiers.new('bevel', 'BEVEL')
ob.modifiers.new('subsurf', 'SUBSURF')
ob.modifiers.new('solidify', 'SOLIDIFY')
for mod in ob.modifiers:
    match mod.type:
        case 'BEVEL':
            mod.width = .1
        case 'SUBSURF' if mod.levels:
            mod.levels = 2
        case other:
            mod.thickness = .1
"""


def test_each_case_of_a_match_is_read_with_its_own_type_alone(rule_checker: Checker, tmp_path: Path) -> None:
    assert not any(error for error, *_ in run_statements(tmp_path, [_MATCHED]))
    assert rule_checker.check(_MATCHED) == []
    wrong = _MATCHED.replace("mod.levels = 2", "mod.width = 2")
    assert [one.symbol for one in rule_checker.check(wrong)] == ["bpy.types.SubsurfModifier.width"]
