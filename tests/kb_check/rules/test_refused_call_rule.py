"""Calls are reported that Blender refuses although they are what the signature asks for, and no others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_CODE = """\
import bpy
scene = bpy.context.scene
strips = scene.sequence_editor_create().strips
first = strips.new_effect("First", "COLOR", channel=1, frame_start=1, length=9)
second = strips.new_effect("Second", "COLOR", channel=2, frame_start=1, length=9)
strips.new_effect("Short", "TEXT", channel=3, frame_start=1)
strips.new_effect(name="Cross", type="CROSS", channel=4, frame_start=1)
strips.new_effect("Cross", "CROSS", channel=4, frame_start=1, input1=first, input2=second)
strips.new_effect("Half", "CROSS", channel=4, frame_start=1, input1=first)
strips.new_effect("Glow", "GLOW", channel=5, frame_start=1)
strips.new_effect("Glow", "GLOW", channel=5, frame_start=1, input1=first)
curve = bpy.data.curves.new("curve", "CURVE")
bezier = curve.splines.new("BEZIER")
poly = curve.splines.new(type="POLY")
bezier.points.add(3)
bezier.bezier_points.add(3)
poly.points.add(3)
poly.bezier_points.add(3)
mesh = bpy.data.meshes.new("mesh")
mesh.attributes.new("weight", "FLOAT", "CURVE")
mesh.attributes.new("weight", "FLOAT", "POINT")
action = bpy.data.actions.new("action")
layer = action.layers.new("First")
other = action.layers.new("Second")
ob = bpy.data.objects.new("object", mesh)
a = ob.modifiers.new("Cloth", "CLOTH")
b = ob.modifiers.new("Cloth", "CLOTH")
c = ob.modifiers.new("Subdivision", "SUBSURF")
d = ob.modifiers.new("Subdivision", "SUBSURF")
pencil = bpy.data.grease_pencils.new("pencil").layers.new("layer")
pencil.frames.new(1)
pencil.frames.new(2)
pencil.frames.new(1)
light = bpy.data.objects.new("light", bpy.data.lights.new("light", "SUN"))
e = light.modifiers.new("Cloth", "CLOTH")
empty = bpy.data.objects.new("empty", None)
f = empty.modifiers.new("Array", "ARRAY")
empty.vertex_groups.new(name="group")
ob.vertex_groups.new(name="group")
tree = bpy.data.materials.new("material").node_tree
noise = tree.nodes.new("ShaderNodeTexNoise")
wave = tree.nodes.new("ShaderNodeTexWave")
color = wave.outputs["Color"]
tree.links.new(noise.outputs[1], color)
tree.links.new(color, noise.inputs["Scale"])
tree.links.new(noise.inputs["Scale"], color)
tree.links.new(input=noise.inputs["Scale"], output=noise.inputs["Vector"])
g = curve.id_data and bpy.data.objects.new("curve", curve).modifiers.new("Array", "ARRAY")
"""


def test_what_is_refused_is_reported_and_nothing_else(check: Check, tmp_path: Path) -> None:
    lines: list[str] = [*_CODE.splitlines()]
    values = {place: line.partition(" = ")[0] for place, line in enumerate(lines) if line[1:4] == " = "}
    answers = run_statements(tmp_path, lines, values)
    refused = {place + 1 for place, (error, _, after) in enumerate(answers) if error or after == "None"}
    found = check("refused-call", _CODE)
    assert {finding.span.line for finding in found} == refused
    raising = {finding.span.line for finding in found if finding.severity == "error"}
    assert raising == {place + 1 for place, answer in enumerate(answers) if answer[0]}


@pytest.mark.parametrize(
    "code",
    [
        'spline.type = "POLY"\nspline.points.add(3)',
        "spline = other()\nspline.points.add(3)",
    ],
)
def test_a_spline_that_may_be_another_is_left_alone(check: Check, code: str) -> None:
    start = (
        'import bpy\ncurve = bpy.data.curves.new("curve", "CURVE")\nspline = curve.splines.new("BEZIER")\n'
    )
    assert not check("refused-call", start + code)


@pytest.mark.parametrize(
    "between", ["ob.modifiers.clear()", "ob = bpy.data.objects['other']", "if ob:\n    pass\n"]
)
def test_a_second_call_counts_only_on_the_same_thing(check: Check, between: str) -> None:
    call = 'ob.modifiers.new("Cloth", "CLOTH")'
    found = check("refused-call", f"import bpy\nob = bpy.context.object\n{call}\n{between}\n{call}\n")
    assert len(found) == between.startswith("if")


def test_a_new_file_before_it_is_no_reason_to_pass_a_second_call(check: Check) -> None:
    start = (
        "import bpy\nbpy.ops.wm.read_factory_settings(use_empty=True)\naction = bpy.data.actions.new('a')\n"
    )
    call = "action.layers.new('layer')\n"
    assert len(check("refused-call", start + call + call)) == 1
    assert not check("refused-call", start + call + "bpy.ops.wm.read_homefile()\n" + call)
    helper = "def fresh():\n    bpy.ops.wm.read_homefile()\n"
    assert not check("refused-call", start + helper + call + "fresh()\n" + call)


@pytest.mark.parametrize("active", ["bpy.context.object", "bpy.context.active_object"])
def test_the_active_object_may_be_another_behind_an_operator(check: Check, active: str) -> None:
    call = f'{active}.modifiers.new("Cloth", "CLOTH")\n'
    assert len(check("refused-call", f"import bpy\n{call}{active}.name = 'Cloth'\n{call}")) == 1
    for between in ("bpy.ops.mesh.primitive_cube_add()", "bpy.context.view_layer.objects.active = other"):
        assert not check("refused-call", f"import bpy\n{call}{between}\n{call}")


@pytest.mark.parametrize("member", ["selected_objects", "object", "view_layer", "scene"])
def test_members_of_the_context_are_values(check: Check, member: str) -> None:
    (finding,) = check("refused-call", f"import bpy\nbpy.context.{member}()\n")
    assert finding.message == f"`bpy.types.Context.{member}` is a property: it is read without `()`."
    assert finding.fix is not None


def test_functions_of_the_context_are_called(check: Check) -> None:
    code = (
        "import bpy\nbpy.context.copy()\nbpy.context.evaluated_depsgraph_get()\nbpy.context.temp_override()\n"
    )
    assert not check("refused-call", code)
