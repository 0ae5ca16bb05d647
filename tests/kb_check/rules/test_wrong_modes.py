"""Operators are found in modes in which Blender refuses them, and what runs is left alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_CODE = """\
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.object.select_all(action="DESELECT")
bpy.ops.mesh.primitive_cube_add()
bpy.ops.mesh.subdivide()
bpy.ops.uv.smart_project()
bpy.ops.curve.subdivide()
bpy.ops.object.mode_set(mode="POSE")
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.mesh.subdivide()
bpy.ops.mesh.primitive_uv_sphere_add()
bpy.ops.mesh.bevel(offset=0.1)
bpy.ops.uv.smart_project()
bpy.ops.object.shade_smooth()
bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.transform_apply()
bpy.ops.object.origin_set()
bpy.ops.object.modifier_apply(modifier="Bevel")
bpy.ops.curve.primitive_bezier_circle_add()
bpy.ops.mesh.primitive_cube_add()
bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.object.shade_smooth()
bpy.ops.object.transform_apply()
bpy.ops.object.armature_add()
bpy.ops.armature.select_all()
bpy.ops.pose.select_all()
bpy.ops.object.editmode_toggle()
bpy.ops.armature.select_all()
bpy.ops.pose.select_all()
bpy.ops.object.mode_set(mode="POSE")
bpy.ops.armature.select_all()
bpy.ops.pose.select_all()
bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.object.mode_set(mode="SCULPT")
bpy.ops.object.camera_add()
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.object.editmode_toggle()
bpy.ops.object.light_add()
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.object.text_add(enter_editmode=True)
bpy.ops.font.text_insert(text="a")
bpy.ops.object.shade_flat()
bpy.ops.object.editmode_toggle()
bpy.ops.font.text_insert(text="a")
bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
bpy.ops.object.convert(target="CURVE")
bpy.ops.object.delete()
"""
_SOUND: dict[str, str] = {
    "helpers": """\
import bpy
def enter():
    bpy.ops.object.mode_set(mode="EDIT")
def leave():
    bpy.ops.object.mode_set(mode="OBJECT")
for size in (1, 2):
    bpy.ops.mesh.primitive_cube_add(size=size)
    enter()
    bpy.ops.mesh.subdivide(number_cuts=2)
    leave()
    bpy.ops.object.shade_smooth()
""",
    "returns_in_try": """\
import bpy
def cut(count):
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        if not count:
            return False
        bpy.ops.mesh.subdivide(number_cuts=count)
        return True
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.mesh.primitive_cube_add()
cut(2)
bpy.ops.object.shade_smooth()
cut(0)
bpy.ops.object.select_all(action="DESELECT")
""",
    "manager": """\
import bpy
from contextlib import contextmanager
@contextmanager
def edit_mode(obj):
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        yield obj
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.object.select_all(action="DESELECT")
bpy.ops.mesh.primitive_cube_add()
with edit_mode(bpy.context.object):
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.bevel(offset=0.1)
bpy.ops.object.shade_flat()
""",
    "asked_before": """\
import bpy
def clear():
    if bpy.context.object and bpy.context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
def select(obj):
    in_edit = obj.mode == "EDIT"
    if in_edit:
        bpy.ops.mesh.select_all(action="SELECT")
    else:
        bpy.ops.object.select_all(action="SELECT")
clear()
bpy.ops.mesh.primitive_cube_add()
select(bpy.context.object)
bpy.ops.object.mode_set(mode="EDIT")
select(bpy.context.object)
clear()
""",
    "flag": """\
import bpy
def model(detail, edit=False):
    bpy.ops.object.select_all(action="DESELECT")
    bpy.ops.mesh.primitive_cylinder_add(vertices=detail, enter_editmode=edit)
    if edit:
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.inset(thickness=0.1)
        bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.shade_smooth()
model(12)
model(8, True)
model(6)
""",
    "loop": """\
import bpy
for place in range(3):
    bpy.ops.mesh.primitive_cube_add(location=(place * 3, 0, 0))
meshes = [ob for ob in bpy.context.scene.objects if ob.type == "MESH"]
bpy.ops.object.select_all(action="DESELECT")
for ob in meshes:
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.normals_make_consistent(inside=False)
    if ob is meshes[-1]:
        break
    bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.mesh.remove_doubles(threshold=0.001)
bpy.ops.object.editmode_toggle()
bpy.ops.object.shade_flat()
""",
    "operator": """\
import bpy
class Cutter(bpy.types.Operator):
    bl_idname = "mesh.cutter_of_test"
    bl_label = "Cutter"
    stay: bpy.props.BoolProperty()
    @classmethod
    def poll(cls, context):
        return context.object is not None
    def execute(self, context):
        before = context.object.mode
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.subdivide()
        if not self.stay:
            bpy.ops.object.mode_set(mode=before)
        return {"FINISHED"}
bpy.utils.register_class(Cutter)
bpy.ops.object.select_all(action="DESELECT")
bpy.ops.mesh.primitive_cube_add()
bpy.ops.mesh.cutter_of_test()
bpy.ops.object.shade_smooth()
bpy.ops.mesh.cutter_of_test(stay=True)
bpy.ops.mesh.bevel()
""",
    "handed_on": """\
import bpy
def in_edit(function, *given):
    bpy.ops.object.mode_set(mode="EDIT")
    function(*given)
    bpy.ops.object.mode_set(mode="OBJECT")
def bevel(offset):
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.bevel(offset=offset)
bpy.ops.object.select_all(action="DESELECT")
bpy.ops.mesh.primitive_cube_add()
in_edit(bevel, 0.2)
in_edit(lambda: bpy.ops.mesh.subdivide())
bpy.ops.object.shade_smooth()
steps = {"edit": lambda: bpy.ops.object.mode_set(mode="EDIT"), "cut": bpy.ops.mesh.subdivide}
steps["edit"]()
steps["cut"]()
bpy.ops.mesh.bevel()
""",
    "steps": """\
import bpy
def steps():
    bpy.ops.object.mode_set(mode="EDIT")
    yield "cut"
    bpy.ops.object.shade_smooth()
bpy.ops.mesh.primitive_cube_add()
for step in steps():
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
""",
    "caught": """\
import bpy
bpy.ops.object.select_all(action="DESELECT")
bpy.ops.mesh.primitive_cube_add()
try:
    bpy.ops.mesh.subdivide()
except RuntimeError as error:
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide()
if bpy.ops.object.mode_set.poll():
    bpy.ops.object.mode_set(mode="OBJECT")
if bpy.ops.mesh.bevel.poll():
    bpy.ops.mesh.bevel()
bpy.ops.object.select_all(action="SELECT")
""",
    "match": """\
import bpy
def work():
    match bpy.context.mode:
        case "EDIT_MESH":
            bpy.ops.mesh.subdivide()
        case "OBJECT":
            bpy.ops.object.select_all(action="SELECT")
def toggle(want):
    if bpy.context.object.mode == want:
        return
    bpy.ops.object.mode_set(mode=want)
bpy.ops.object.select_all(action="DESELECT")
bpy.ops.mesh.primitive_cube_add()
work()
toggle("EDIT")
work()
while bpy.context.object.mode == "EDIT":
    bpy.ops.object.editmode_toggle()
bpy.ops.object.shade_flat()
""",
    "kinds": """\
import bpy
bpy.ops.mesh.primitive_cube_add()
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.curve.primitive_bezier_circle_add()
bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.curve.subdivide()
bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.object.convert(target="MESH")
bpy.ops.object.mode_set(mode="SCULPT")
bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.object.text_add()
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.font.text_insert(text="a")
bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.object.convert(target="CURVE")
bpy.ops.object.duplicate()
bpy.ops.object.join()
""",
    "early_return": """\
import bpy
def smooth_selected():
    ob = bpy.context.object
    editing = ob.mode == "EDIT"
    if not editing:
        bpy.ops.object.shade_smooth()
        return
    bpy.ops.mesh.faces_shade_smooth()
bpy.ops.object.select_all(action="DESELECT")
bpy.ops.mesh.primitive_uv_sphere_add()
smooth_selected()
""",
}


def test_what_is_refused_is_found_and_nothing_else(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, list[str](_CODE.splitlines()))
    found = check("wrong-mode", _CODE)
    assert {finding.span.line for finding in found} == {
        place for place, (error, *_) in enumerate(answers, 1) if error
    }
    assert {finding.severity for finding in found} == {"error"}


def test_scripts_that_blender_runs_have_no_finding(check: Check, tmp_path: Path) -> None:
    fresh = "import bpy\nbpy.ops.wm.read_factory_settings(use_empty=True)\n"
    scripts: list[str] = [fresh + code for code in _SOUND.values()]
    answers = run_statements(tmp_path, scripts)
    assert [name for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []
    assert [(name, found) for name, code in _SOUND.items() if (found := check("wrong-mode", code))] == []


@pytest.mark.parametrize(
    ("code", "severity"),
    [
        ("bpy.ops.mesh.primitive_cube_add()\nbpy.ops.mesh.subdivide()", "note"),
        ("bpy.context.object.mode\nbpy.ops.mesh.subdivide()", ""),
        ("exec(code)\nbpy.ops.mesh.subdivide()", ""),
        ("bpy.ops.object.select_all()\nwith bpy.context.temp_override():\n    bpy.ops.mesh.subdivide()", ""),
        ("bpy.ops.object.select_all()\nbpy.ops.mesh.subdivide()", "error"),
        ("bpy.ops.object.select_all()\nexec(code)\nbpy.ops.mesh.subdivide()", ""),
        ("bpy.ops.wm.read_factory_settings(app_template='Sculpting')\nbpy.ops.sculpt.brush_stroke()", ""),
    ],
)
def test_only_what_is_certain_is_an_error(check: Check, code: str, severity: str) -> None:
    found = check("wrong-mode", f"import bpy\n{code}\n")
    assert [finding.severity for finding in found] == [severity] * bool(severity)


def test_a_mode_that_objects_of_no_type_have_is_an_error(check: Check, tmp_path: Path) -> None:
    made = [
        "import bpy",
        "ob = bpy.data.objects.new('pencil', bpy.data.grease_pencils.new('pencil'))",
        "bpy.context.scene.collection.objects.link(ob)",
        "bpy.context.view_layer.objects.active = ob",
    ]
    modes = ("EDIT_GPENCIL", "EDIT", "PAINT_GREASE_PENCIL", "SCULPT_GREASE_PENCIL", "OBJECT")
    lines = [f"bpy.ops.object.mode_set(mode={mode!r})" for mode in modes]
    answers = run_statements(tmp_path, [*made, *lines])[len(made) :]
    refused = [line for line, (error, *_) in zip(lines, answers, strict=True) if error]
    assert refused == lines[:1]
    for before in (made, made[:1]):
        found = check("wrong-mode", "\n".join([*before, *lines]))
        assert [finding.span.line for finding in found] == [len(before) + 1]
        assert "write 'EDIT'" in found[0].message


def test_the_message_says_what_to_call_before(check: Check) -> None:
    found = check("wrong-mode", "import bpy\nbpy.ops.object.select_all()\nbpy.ops.mesh.subdivide()\n")
    assert found[0].message == (
        "`bpy.ops.mesh.subdivide` runs only in Edit Mode, and the active object is in Object Mode here: "
        "`bpy.ops.object.mode_set(mode='EDIT')` comes before."
    )


_OVERRIDDEN = """
import bpy
def cube(name):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    ob = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(ob)
    return ob
other = cube("other")
ob = cube("ob")
bpy.context.view_layer.objects.active = {active}
with bpy.context.temp_override({given}):
    bpy.ops.object.{call}
assert ob.mode == "EDIT", ob.mode
"""


@pytest.mark.parametrize("call", ["mode_set(mode='EDIT')", "editmode_toggle()"])
@pytest.mark.parametrize(
    ("active", "given", "is_found"),
    [
        ("other", "active_object=ob", True),
        ("other", "object=ob, active_object=ob, selected_objects=[ob]", True),
        ("ob", "object=ob", False),
        ("ob", "active_object=other", True),
        ("ob", "selected_objects=[]", False),
    ],
)
def test_what_changes_the_mode_changes_that_of_the_active_object(
    rule_checker: Checker, tmp_path: Path, active: str, given: str, call: str, *, is_found: bool
) -> None:
    code = _OVERRIDDEN.format(active=active, given=given, call=call)
    ((error, *_),) = run_statements(tmp_path, [code])
    # Whatever is given for the call, the object that was active is the one that changes.
    assert bool(error) is (active == "other")
    found = [one for one in rule_checker.check(code) if one.rule == "wrong-mode"]
    assert [one.severity for one in found] == ["warning"] * is_found
