"""Parts that new things do not have until something makes them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_LINES = """\
import bpy
mesh = bpy.data.meshes.new('m')
ob = bpy.data.objects.new('o', mesh)
scene = bpy.data.scenes.new('s')
ob.animation_data.action = None
ob.soft_body.mass = 1
ob.collision.damping = 1
scene.rigidbody_world.enabled = True
scene.render.fps = 25
"""
_FILLED = {
    "ob.animation_data_create()\n": 5,
    "ob.modifiers.new('x', 'SOFT_BODY')\n": 6,
    "ob.modifiers.new('x', 'COLLISION')\n": 7,
    "bpy.ops.rigidbody.world_add()\n": 8,
}


def test_what_new_things_lack_is_found(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _LINES.splitlines()
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    assert (
        [one.span.line for one in rule_checker.check(_LINES, rules=["empty-pointer"])]
        == refused
        == [5, 6, 7, 8]
    )


def test_what_the_script_has_filled_before_is_not(rule_checker: Checker) -> None:
    made, read = _LINES.splitlines(keepends=True)[:4], _LINES.splitlines(keepends=True)[4:]
    for call, line in _FILLED.items():
        found = rule_checker.check("".join([*made, call, *read]), rules=["empty-pointer"])
        assert line + 1 not in {one.span.line for one in found}, call
        found = rule_checker.check(_LINES + call, rules=["empty-pointer"])
        assert line in {one.span.line for one in found}, call
    kinds = ["kind = input()\n", "ob.modifiers.new('x', kind)\n"]
    computed = "".join([*made, *kinds, *read])
    assert {one.span.line for one in rule_checker.check(computed, rules=["empty-pointer"])} == {7, 10}


def test_what_functions_fill_may_be_filled_before(rule_checker: Checker) -> None:
    read = "".join(f"    {line}\n" for line in _LINES.splitlines()[1:])
    fill = "def fill(ob):\n    ob.animation_data_create()\n"
    found = rule_checker.check(f"import bpy\ndef read():\n{read}{fill}", rules=["empty-pointer"])
    assert 6 not in {one.span.line for one in found}


def test_the_order_on_one_line_counts(rule_checker: Checker) -> None:
    made = "import bpy\nob = bpy.data.objects.new('a', None); m = ob.modifiers.new('f', 'FLUID'); "
    fill, read = "m.fluid_type = 'DOMAIN'; ", "m.domain_settings.domain_type = 'GAS'; "
    assert rule_checker.check(made + fill + read, rules=["empty-pointer"]) == []
    assert rule_checker.check(made + read + fill, rules=["empty-pointer"])


_TWO_OBJECTS = """\
import bpy
bpy.ops.mesh.primitive_grid_add()
flag = bpy.context.active_object
bpy.ops.object.effector_add(type='WIND')
bpy.context.active_object.field.strength = 200
flag.field.strength = 2
"""


def test_an_effector_beside_a_mesh_has_its_field(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _TWO_OBJECTS.splitlines()
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check(_TWO_OBJECTS, rules=["empty-pointer"])
    assert [one.span.line for one in found] == refused == [6]
