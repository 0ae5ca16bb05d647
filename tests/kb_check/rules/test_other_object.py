"""Operators that look for a modifier on another object are found: each is run in Blender, and does nothing or works."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_build.symbols.api_names import CHANGING_MODE, OF_SELECTED

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_MODE_SET, _WITH_SUBMODE = "bpy.ops.object.mode_set", "bpy.ops.object.mode_set_with_submode"

_START = """\
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_cube_add()
cube = bpy.context.object
bpy.ops.mesh.primitive_uv_sphere_add()
ball = bpy.context.object
"""
_NEW = "hole = cube.modifiers.new('Hole', 'TRIANGULATE')\n"
_ACTIVATE = "bpy.context.view_layer.objects.active = "
_APPLY = "bpy.ops.object.modifier_apply(modifier='Hole')\n"
_BY_NAME = "bpy.ops.object.modifier_apply(modifier=hole.name)\n"
_WRONG = {
    "by its name": f"{_NEW}{_APPLY}",
    "by a name that holds it": f"{_NEW}{_BY_NAME}",
    "made active before": f"{_ACTIVATE}cube\n{_NEW}hole.show_viewport = True\n{_ACTIVATE}ball\n{_APPLY}",
    "a new object": f"{_NEW}new = bpy.data.objects.new('new', cube.data)\n"
    f"bpy.context.collection.objects.link(new)\n{_ACTIVATE}new\n{_APPLY}",
    "removed": f"{_NEW}bpy.ops.object.modifier_remove(modifier='Hole')\n",
    "in a function": f"def cut(cube):\n    bpy.ops.mesh.primitive_cone_add()\n    cone = bpy.context.object\n"
    f"    other = bpy.data.objects['Cube']\n    hole = other.modifiers.new('Hole', 'TRIANGULATE')\n    {_BY_NAME}"
    "cut(cube)\n",
}
_SOUND = {
    "active": f"{_NEW}{_ACTIVATE}cube\n{_APPLY}",
    "the last one": f"hole = ball.modifiers.new('Hole', 'TRIANGULATE')\n{_BY_NAME}",
    "of both": f"{_NEW}ball.modifiers.new('Hole', 'TRIANGULATE')\n{_APPLY}",
    "added by an operator": f"{_NEW}bpy.ops.object.modifier_add(type='TRIANGULATE')\n"
    "ball.modifiers[0].name = 'Hole'\n"
    f"{_APPLY}",
    "of a copy": f"{_NEW}twin = cube.copy()\nbpy.context.collection.objects.link(twin)\n{_ACTIVATE}twin\n"
    f"twin.data = twin.data.copy()\n{_APPLY}",
    "given in a loop": f"{_NEW}for each in (cube, ball):\n    each.modifiers.new('Hole', 'TRIANGULATE')\n{_APPLY}",
    "given by a function": "def give():\n    ball.modifiers.new('Hole', 'TRIANGULATE')\n"
    f"{_NEW}give()\n{_APPLY}",
    "made active by a function": f"def activate():\n    {_ACTIVATE}cube\n{_NEW}activate()\n{_APPLY}",
    "overridden": f"{_NEW}with bpy.context.temp_override(object=cube, active_object=cube):\n    {_APPLY}",
    "in a loop over objects": "for each in (cube, ball):\n"
    f"    hole = each.modifiers.new('Hole', 'TRIANGULATE')\n    {_ACTIVATE}each\n    {_BY_NAME}",
    "bound again": f"{_NEW}cube = ball\nhole = cube.modifiers.new('Hole', 'TRIANGULATE')\n{_BY_NAME}",
}


@pytest.mark.parametrize("name", _WRONG)
def test_what_works_on_another_object_is_found(check: Check, name: str) -> None:
    assert [finding.severity for finding in check("other-object", f"{_START}{_WRONG[name]}")] == ["warning"]


@pytest.mark.parametrize("name", _SOUND)
def test_what_works_has_no_finding(check: Check, name: str) -> None:
    assert check("other-object", f"{_START}{_SOUND[name]}") == []


def test_blender_does_nothing_or_works(tmp_path: Path) -> None:
    """The modifier that is meant is there afterwards, or it is not."""
    left = [
        f"{_START}{code}assert sum(len(one.modifiers) for one in bpy.data.objects) == 1"
        for code in _WRONG.values()
    ]
    operator = "bpy.ops.object.modifier_apply"
    works = [
        f"{_START}{code.replace(operator, 'done = ' + operator)}assert done == {{'FINISHED'}}"
        for code in _SOUND.values()
    ]
    answers = [error for error, *_ in run_statements(tmp_path, [*left, *works])]
    assert [(name, error) for name, error in zip([*_WRONG, *_SOUND], answers, strict=True) if error] == []


_ADD = "bpy.ops.rigidbody.object_add()\n"
_LINKED = "box = bpy.data.objects.new('box', cube.data)\nbpy.context.collection.objects.link(box)\n"
_EMPTY = {
    "made by data": f"{_LINKED}{_ADD}box.rigid_body.mass = 2\n",
    "another one's": f"{_ADD}bpy.ops.mesh.primitive_cone_add()\ncone = bpy.context.object\ncone.rigid_body.mass = 2\n",
    "the first one's": f"{_ADD}cube.rigid_body.mass = 2\n",
    "a joint's": f"{_LINKED}bpy.ops.rigidbody.constraint_add(type='HINGE')\nbox.rigid_body_constraint.type = 'POINT'\n",
}
_FILLED = {
    "active": f"{_LINKED}{_ACTIVATE}box\n{_ADD}box.rigid_body.mass = 2\n",
    "both": f"{_ADD}{_ACTIVATE}cube\n{_ADD}cube.rigid_body.mass = 2\nball.rigid_body.mass = 2\n",
    "a copy": f"{_ADD}twin = ball.copy()\nbpy.context.collection.objects.link(twin)\ntwin.rigid_body.mass = 2\n",
    "in a loop": f"for each in (cube, ball):\n    {_ACTIVATE}each\n    {_ADD}cube.rigid_body.mass = 2\n",
    "by a function": f"def add(ob):\n    {_ACTIVATE}ob\n    {_ADD}{_ADD}add(cube)\ncube.rigid_body.mass = 2\n",
    "all that is selected": f"{_ADD}bpy.ops.object.select_all(action='SELECT')\nbpy.ops.rigidbody.objects_add()\n"
    "cube.rigid_body.mass = 2\n",
    "asked for": f"{_ADD}if cube.rigid_body:\n    cube.rigid_body.mass = 2\n",
    "overridden": f"{_ADD}with bpy.context.temp_override(object=cube, active_object=cube):\n    {_ADD}"
    "cube.rigid_body.mass = 2\n",
}


@pytest.mark.parametrize("name", _EMPTY)
def test_what_an_operator_has_filled_on_another_object_is_found(check: Check, name: str) -> None:
    assert [finding.severity for finding in check("other-object", f"{_START}{_EMPTY[name]}")] == ["warning"]


@pytest.mark.parametrize("name", _FILLED)
def test_what_is_filled_has_no_finding(check: Check, name: str) -> None:
    assert check("other-object", f"{_START}{_FILLED[name]}") == []


def test_blender_has_none_there_or_some(tmp_path: Path) -> None:
    answers = [
        error
        for error, *_ in run_statements(
            tmp_path, [f"{_START}{code}" for code in (*_EMPTY.values(), *_FILLED.values())]
        )
    ]
    assert [name for name, error in zip([*_EMPTY, *_FILLED], answers, strict=True) if error] == [*_EMPTY]


_OVERRIDDEN = """
import bpy
def cube(name):
    mesh = bpy.data.meshes.new(name)
    mesh.materials.append(None)
    mesh.materials.append(None)
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    ob = bpy.data.objects.new(name, mesh)
    ob.location, ob.rotation_euler, ob.scale = (1, 1, 1), (1, 1, 1), (2, 2, 2)
    bpy.context.scene.collection.objects.link(ob)
    return ob
def state(ob):
    return ob.matrix_basis.copy(), len(ob.material_slots), ob.mode
other = cube("other")
ob = cube("ob")
for one in bpy.context.scene.objects:
    one.select_set(one is {active})
bpy.context.view_layer.objects.active = {active}
first = state(ob)
with bpy.context.temp_override(object=ob, active_object=ob, selected_objects=[ob], selected_editable_objects=[ob]):
    {call}()
bpy.context.view_layer.update()
assert state(ob) != first
"""


@pytest.mark.blender
@pytest.mark.parametrize("path", sorted(OF_SELECTED | CHANGING_MODE - {_MODE_SET, _WITH_SUBMODE}))
@pytest.mark.parametrize("active", ["ob", "other"])
def test_what_the_view_layer_has_counts_and_not_the_override(
    rule_checker: Checker, tmp_path: Path, path: str, active: str
) -> None:
    code = _OVERRIDDEN.format(active=active, call=path)
    ((error, *_),) = run_statements(tmp_path, [code])
    assert bool(error) is (active == "other")
    found = [one for one in rule_checker.check(code) if one.symbol == path]
    assert [one.severity for one in found] == ["warning"] * (active == "other")


def test_an_object_that_the_script_selects_may_be_overridden(check: Check) -> None:
    code = (
        "import bpy\nob = bpy.data.objects['Cube']\n{before}with bpy.context.temp_override(object=ob):\n"
        "    bpy.ops.object.location_clear()\n"
    )
    assert len(check("other-object", code.format(before=""))) == 1
    assert not check("other-object", code.format(before="ob.select_set(True)\n"))
