"""Calls of what is no function, and arguments that bmesh and mathutils refuse."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_build.symbols.paths import last_name
from kb_check.calls.sites import callee_of

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_LINES = """\
import bpy, bmesh
from mathutils import Color, Euler, Matrix, Quaternion, Vector
bm = bmesh.new()
bmesh.ops.create_cube(bm, size='a')
bmesh.ops.create_cube(bm, size=True)
bmesh.ops.create_cube(bm, size=1, calc_uvs=1)
bmesh.ops.delete(bm, geom=[], context=1)
bmesh.ops.delete(bm, geom=[], context='VERTS')
bmesh.ops.triangulate(bm, faces=bm.faces[:], quad_method=0)
bmesh.ops.bevel(bm, geom=[], segments=1.5)
bmesh.ops.bevel(bm, geom=[], segments=True)
bmesh.ops.bevel(bm, geom=[], segments=1, clamp_overlap='a')
bmesh.ops.bevel(bm, geom=[], segments=1, clamp_overlap=1, offset=1)
Vector(1, 2, 3)
v = Vector((1, 2, 3))
Vector()
Euler(1, 2, 3)
Euler((1, 2, 3), 'XYZ')
Color(1, 2, 3)
Quaternion(1, 2, 3, 4)
Quaternion((1, 0, 0), 1.0)
Matrix((1, 0), (0, 1))
Matrix(((1, 0), (0, 1)))
v.length()
v.length
v.xy()
bm.verts()
bm.verts.new()
bpy.context.object.data()
bpy.context.object.name()
bpy.data.objects['Cube'].location()
bpy.data.objects()
bpy.context.scene.frame_current()
bpy.context.scene.frame_set(1)
bpy.data.objects['Cube'].modifiers.new('a', 'SUBSURF').levels()
bpy.app.version()
"""
_RULES = ["refused-call", "positional-argument", "wrong-type"]
# A module's member: its kind is not known.
_LEFT = {36}


def test_what_is_found_is_what_blender_refuses(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _LINES.splitlines()
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check(_LINES, rules=_RULES)
    assert [one.span.line for one in found] == [at for at in refused if at not in _LEFT]
    assert len(refused) == 20


def test_a_call_of_a_property_is_mended(rule_checker: Checker) -> None:
    (found,) = rule_checker.check("import mathutils\nmathutils.Vector().length()\n", rules=["refused-call"])
    assert found.fix is not None
    assert found.fix.sure
    assert [edit.text for edit in found.fix.edits] == [""]


_RESULTS = """\
import bpy, bmesh
bm = bmesh.new()
cube = bmesh.ops.create_cube(bm, size=1)
cube['verts']
cube['faces']
result = bmesh.ops.extrude_face_region(bm, geom=bm.faces[:])
result['geom']
result['verts']
result.get('verts')
bmesh.ops.extrude_discrete_faces(bm, faces=bm.faces[:])['faces']
bmesh.ops.extrude_discrete_faces(bm, faces=bm.faces[:])['geom']
own = bmesh.ops.create_cube(bm)
own['mine'] = 1
own['mine']
try:
    cube['edges']
except KeyError:
    pass
"""


def test_keys_that_results_of_bmesh_lack_are_found(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _RESULTS.splitlines()[:14]
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check(_RESULTS, rules=["not-subscriptable"])
    assert [one.span.line for one in found] == refused == [5, 8, 11]


_OUTPUTS = """
import json, sys
import bpy
rows = []
for cls, name in json.loads(sys.argv[-1]):
    function = getattr(bpy.types, cls).bl_rna.functions.get(name)
    rows.append(function is None or any(parameter.is_output for parameter in function.parameters))
print(json.dumps(rows))
"""


def test_functions_that_tell_of_no_result_have_none(rule_checker: Checker) -> None:
    names: list[tuple[str, str]] = []
    for (path,) in rule_checker.names.reader.rows("SELECT path FROM symbols WHERE kind = 'function'"):
        symbol = rule_checker.api.symbols.symbol(path)
        if symbol and symbol.parameters and not symbol.returns and callee_of(symbol).is_rna:
            names.append((last_name(symbol.owner), symbol.name))
    done = subprocess.run(
        [sys.executable, "-c", _OUTPUTS, json.dumps(names)], capture_output=True, check=True
    )
    gives = json.loads(done.stdout.splitlines()[-1])
    assert len(names) > 500
    assert [name for name, answer in zip(names, gives, strict=True) if answer] == []


_BUILT: list[str] = [
    "import bpy",
    "name = bpy.context.scene.name",
    "path = f'/nowhere/{name}'",
    "bpy.ops.wm.obj_export(f'{name}.obj')",
    "bpy.ops.wm.obj_export('%s.obj' % name)",
    "bpy.ops.wm.obj_export(name + '/a.obj')",
    "bpy.ops.wm.obj_export(path)",
    "import os",
    "bpy.ops.wm.obj_export(os.path.join(path, name))",
    "bpy.ops.wm.obj_export('{}.obj'.format(name))",
    "bpy.ops.wm.obj_export(bpy.path.abspath(path))",
    "how = bpy.app.binary_path and 'INVOKE' or 'EXEC'",
    "bpy.ops.object.select_all(f'{how}_DEFAULT', action='SELECT')",
    "bpy.ops.object.select_all('%s_DEFAULT' % how, action='SELECT')",
    "bpy.ops.object.select_all(how + '_DEFAULT', action='SELECT')",
]


def test_a_text_that_is_put_together_is_no_execution_context(rule_checker: Checker, tmp_path: Path) -> None:
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, _BUILT), 1) if error]
    found = rule_checker.check("\n".join(_BUILT), rules=["positional-argument"])
    assert [one.span.line for one in found] == refused == [4, 5, 6, 7, 9, 10, 11]


def test_a_number_by_place_is_taken_for_a_truth_value(rule_checker: Checker, tmp_path: Path) -> None:
    calls = ["4", "-1", "1", "True", "'EXEC_DEFAULT', 1", "'EXEC_DEFAULT', 4"]
    code = ["import bpy", *(f"bpy.ops.mesh.primitive_cube_add({call})" for call in calls)]
    found = rule_checker.check("\n".join(code), rules=["positional-argument"])
    assert [one.span.line for one in found] == [2, 3, 7]
    made = [
        *code,
        "assert {tuple(ob.dimensions) for ob in bpy.context.selected_objects} == {(2.0, 2.0, 2.0)}",
    ]
    assert [error for error, *_ in run_statements(tmp_path, made) if error] == []


_STACKED = """\
import bpy
ob = bpy.data.objects.new("ob", None)
ob.keyframe_insert("location")
bag = ob.animation_data.action.layers[0].strips[0].channelbags[0]
first, second, third = bag.fcurves
assert first.modifiers.new("NOISE")
assert not first.modifiers.new("CYCLES")
assert second.modifiers.new("CYCLES")
assert not second.modifiers.new("CYCLES")
assert third.modifiers.new("CYCLES")
assert third.modifiers.new("NOISE")
"""


def test_what_must_be_first_is_refused_after_any_other(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _STACKED.splitlines()
    assert [error for error, *_ in run_statements(tmp_path, lines) if error] == []
    typed = _STACKED.replace("bag.fcurves", "bag.fcurves[0], bag.fcurves[1], bag.fcurves[2]").replace(
        "assert not ", ""
    )
    found = rule_checker.check(typed.replace("assert ", ""), rules=["refused-call"])
    assert [(one.span.line, "after another" in one.message) for one in found] == [(7, True), (9, True)]


def test_names_are_refused_where_only_places_are_taken_and_left_out_by_the_fix(rule_checker: Checker) -> None:
    code = """\
import bmesh
bm = bmesh.new()
vert = bm.verts.new((0, 0, 0))
vert.select_set(select=True)
vert.hide_set(False)
bm.from_mesh(mesh=None)
"""
    (found,) = rule_checker.check(code, rules=["positional-argument"])
    assert (found.span.line, "`select` by place only" in found.message) == (4, True)
    assert found.fix is not None
    assert [edit.text for edit in found.fix.edits] == ["True"]


_NAMELESS = """\
import bpy, aud, bmesh, gpu
bm = bmesh.new()
layer = bm.verts.layers.deform.verify()
verts = [bm.verts.new((x, x * x, 0)) for x in range(3)]
weights = verts[0][layer]
plays = aud.PlaybackManager(aud.Device())
scene = bpy.context.scene
scene["group"] = {"a": 1}
"""
# With names that are refused, and as they are taken.
_FIRST_PLACES = {
    "bm.verts.new(co=(0, 0, 0))": "bm.verts.new((0, 0, 0), source=None)",
    "bm.edges.new(verts=verts[:2])": "bm.edges.new(verts[:2])",
    "bm.faces.new(verts=verts)": "bm.faces.new(verts)",
    "weights.get(key=0)": "weights.get(0)",
    "bpy.utils.flip_name(name='A.L')": "bpy.utils.flip_name('A.L', strip_digits=False)",
    "gpu.types.GPUStageInterfaceInfo(name='x')": "gpu.types.GPUStageInterfaceInfo('x')",
    "plays.addCategory(volume=1.0)": "plays.addCategory(1.0)",
    "aud.Sound.sine(frequency=440)": "aud.Sound.sine(440)",
    "scene['group'].get('z', default=3)": "scene['group'].get('z', 3)",
}


def test_first_arguments_that_take_no_names_are_refused_with_them(check: Check, tmp_path: Path) -> None:
    lines = [*_NAMELESS.splitlines(), *_FIRST_PLACES, *_FIRST_PLACES.values()]
    errors = [error.partition(":")[0] for error, *_ in run_statements(tmp_path, lines)]
    found = {found.span.line - 1 for found in check("positional-argument", "\n".join(lines))}
    refused = {place for place, error in enumerate(errors) if error == "TypeError"}
    assert [lines[place] for place in sorted(refused)] == [*_FIRST_PLACES]
    assert [lines[place] for place in sorted(found)] == [*_FIRST_PLACES]


@pytest.mark.parametrize(
    ("given", "edits"),
    [
        ("name='A.L', strip_digits=True", ["'A.L'"]),
        ("strip_digits=True, name='A.L'", None),
    ],
)
def test_names_that_are_taken_are_kept_by_the_fix(check: Check, given: str, edits: list[str] | None) -> None:
    (found,) = check("positional-argument", f"import bpy\nbpy.utils.flip_name({given})\n")
    assert (None if found.fix is None else [edit.text for edit in found.fix.edits]) == edits


def test_what_became_something_else_is_no_group_of_custom_properties(check: Check) -> None:
    code = "import bpy\nscene = bpy.context.scene\nscene['g'] = {{}}\n{}\nscene['g'].get('z', default=3)\n"
    changes = ("scene['g'] = made()", "scene[name] = made()", "scene = made()")
    assert [len(check("positional-argument", code.format(change))) for change in ("", *changes)] == [
        1,
        0,
        0,
        0,
    ]


def test_one_item_of_several_becomes_a_set_by_the_fix(rule_checker: Checker) -> None:
    code = "import bpy\nbpy.context.object.animation_data.drivers[0].keyframe_points.insert(3, 1.0, 'FAST')\n"
    (found,) = rule_checker.check(code, rules=["positional-argument"])
    assert found.fix is not None
    assert [edit.text for edit in found.fix.edits] == ["options={'FAST'}"]


def test_a_function_of_a_module_takes_what_it_calls_self(rule_checker: Checker) -> None:
    code = "import nodeitems_utils\ndef draw(self, context):\n    nodeitems_utils.draw_node_categories_menu({})\n"
    assert rule_checker.check(code.format("self, context")) == []
    (found,) = rule_checker.check(code.format("self, context, 1"), rules=["positional-argument"])
    assert found.span.line == 3


def test_what_is_no_such_thing_gets_no_name(rule_checker: Checker) -> None:
    code = "import bpy\nbpy.context.object.animation_data.nla_tracks.new('Walk')\n"
    (found,) = rule_checker.check(code, rules=["positional-argument"])
    assert (found.fix, "`prev` by name only" in found.message) == (None, True)
