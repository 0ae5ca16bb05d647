"""Objects that a pointer leaves out without an error, or refuses: found where Blender has it so, and nowhere else."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_MADE = """\
import bpy
D = bpy.data
mesh_object = D.objects.new("a", D.meshes.new("a"))
empty = D.objects.new("b", None)
camera_object = D.objects.new("c", D.cameras.new("c"))
curve_object = D.objects.new("d", D.curves.new("d", "CURVE"))
text_object = D.objects.new("e", D.curves.new("e", "FONT"))
armature_object = D.objects.new("f", D.armatures.new("f"))
light_object = D.objects.new(name="g", object_data=D.lights.new("g", "SPOT"))
other_empty = D.objects.new("h", object_data=None)
boolean = mesh_object.modifiers.new("a", "BOOLEAN")
bend = mesh_object.modifiers.new("b", "CURVE")
skin = mesh_object.modifiers.new("c", "ARMATURE")
wrap = mesh_object.modifiers.new("d", "SHRINKWRAP")
mirror = mesh_object.modifiers.new("e", "MIRROR")
track = empty.constraints.new("TRACK_TO")
line = curve_object.data
"""
_OBJECTS = (
    "mesh_object", "empty", "camera_object", "curve_object", "text_object", "armature_object", "light_object",
    "other_empty",
)  # fmt: skip
_POINTERS = (
    "boolean.object", "bend.object", "skin.object", "wrap.target", "mirror.mirror_object", "track.target",
    "line.bevel_object", "mesh_object.parent",
)  # fmt: skip


def test_what_is_left_out_or_refused_is_found(rule_checker: Checker, tmp_path: Path) -> None:
    made = _MADE.splitlines()
    lines = [f"{pointer} = {given}" for pointer, given in product(_POINTERS, _OBJECTS)]
    watched = {len(made) + at: line.replace(" = ", " == ") for at, line in enumerate(lines)}
    answers = run_statements(tmp_path, [*made, *lines], watched)
    assert not any(error for error, *_ in answers[: len(made)])
    not_taken = {
        lines[at] for at, (error, _, taken) in enumerate(answers[len(made) :]) if error or taken != "True"
    }
    findings = rule_checker.check("\n".join([*made, *lines]), rules=["left-out"])
    found = {lines[one.span.line - len(made) - 1] for one in findings}
    assert found - not_taken == set()
    # A constraint of a bone takes what it belongs to, and whose one is, is not asked; nor which objects have a curve.
    assert not_taken - found == {"track.target = empty", "line.bevel_object = curve_object"}
    assert len(found) > 20


def test_a_tree_that_holds_itself_is_found(rule_checker: Checker) -> None:
    code = """\
import bpy
tree = bpy.data.node_groups.new("a", "GeometryNodeTree")
node = tree.nodes.new("GeometryNodeGroup")
node.node_tree = tree
"""
    (finding,) = rule_checker.check(code, rules=["left-out"])
    assert finding.message == (
        "`bpy.types.GeometryNodeGroup.node_tree` does not take the tree that it belongs to."
    )


def test_what_may_be_taken_is_left_alone(rule_checker: Checker) -> None:
    code = """\
import bpy
ob = bpy.context.object
for other in bpy.data.objects:
    ob.modifiers.new("a", "BOOLEAN").object = other
boolean = ob.modifiers.new("b", "BOOLEAN")
boolean.object = bpy.context.active_object
empty = bpy.data.objects.new("e", None)
empty = bpy.data.objects["Cube"]
boolean.object = empty
mirror = ob.modifiers.new("c", "MIRROR")
mirror.mirror_object = bpy.data.objects.new("m", None)
try:
    boolean.object = bpy.data.objects.new("n", None)
except TypeError:
    pass
"""
    found = [one.span.line for one in rule_checker.check(code, rules=["left-out"])]
    assert found == []


_CLOTH = """\
import bpy
mesh = bpy.data.meshes.new("a")
mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
ob = bpy.data.objects.new("a", mesh)
cloth = ob.modifiers.new("a", "CLOTH")
wave = ob.modifiers.new("b", "WAVE")
"""


def test_names_of_parts_that_are_made_later_or_never_are_found(rule_checker: Checker, tmp_path: Path) -> None:
    later = [
        'cloth.settings.vertex_group_mass = "Pin"', 'wave.uv_layer = "Map"', 'wave.vertex_group = "Pin"',
        'pin = ob.vertex_groups.new(name="Pin")', 'mesh.uv_layers.new(name="Map")',
        'cloth.settings.vertex_group_mass = "Pin" ', 'wave.uv_layer = "Map" ',
    ]  # fmt: skip
    never = ['cloth.settings.vertex_group_mass = "Pin"', 'wave.vertex_group = "None such"']
    for lines in (later, never):
        made = _CLOTH.splitlines()
        watched = {len(made) + at: line.partition(" = ")[0] for at, line in enumerate(lines)}
        answers = run_statements(tmp_path, [*made, *lines], watched)
        assert not any(error for error, *_ in answers)
        empty = {at for at, (_, _, value) in enumerate(answers[len(made) :]) if value == "''"}
        findings = rule_checker.check("\n".join([*made, *lines]), rules=["left-out"])
        assert {one.span.line - len(made) - 1 for one in findings} == empty
        assert empty


def test_names_of_parts_that_may_be_there_are_left_alone(rule_checker: Checker) -> None:
    code = """\
import bpy
ob = bpy.context.object
wave = ob.modifiers.new("a", "WAVE")
wave.vertex_group = "Group"
other = bpy.data.objects.new("b", bpy.data.meshes["Cube"])
other.modifiers.new("a", "WAVE").uv_layer = "Map"
for ob in bpy.context.selected_objects:
    ob.modifiers["Wave"].vertex_group = "Pin"
    ob.vertex_groups.new(name="Pin")
PIN = "Top"
wave.vertex_group = "Top"
ob.vertex_groups.new(name="Top")
"""
    assert rule_checker.check(code, rules=["left-out"]) == []
