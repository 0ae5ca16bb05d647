"""What is computed with, read from or assigned of a method that returns None is found; Blender refuses all of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

pytestmark = pytest.mark.blender

_RULES = ["unknown-attribute", "refused-product", "wrong-type"]
_START = [
    "import bpy",
    "from mathutils import Euler, Matrix, Quaternion, Vector",
    "ob = bpy.context.object",
    "v, m, q = Vector((1, 2, 3)), Matrix(), Quaternion()",
    "d = Vector((1, 2, 3)).normalize()",
    "i = ob.matrix_world.copy().invert()",
]
_REFUSED = [
    "d.length",
    "i @ Vector((1, 0, 0))",
    "v + d",
    "ob.location = ob.location.normalize()",
    "m.transpose().determinant()",
    "q.conjugate().w",
    "(v.negate()).x",
    "ob.matrix_world @ (1, 0, 0)",
    "ob.matrix_world @ 2.0",
    "v.rotate((0, 0, 1))",
    "v.rotate(0.5)",
    "q.rotate(Vector((1, 2, 3)))",
    "bpy.ops.object.light_add(type='SPOT'); bpy.context.object.data.angle = 0.1",
]
_TAKEN = [
    "v.normalized().length",
    "ob.matrix_world.inverted() @ Vector((1, 0, 0))",
    "ob.location = ob.location.normalized()",
    "v.normalize()",
    "m.transposed().determinant()",
    "v.rotate(Euler((0, 0, 1)))",
    "v.rotate(ob.rotation_euler)",
    "v.rotate(ob.matrix_world)",
    "q.rotate(q.copy())",
    "v.normalize() is None",
    "bpy.ops.object.light_add(type='SUN'); bpy.context.object.data.angle = 0.1",
    "bpy.ops.object.light_add(type='AREA'); bpy.context.object.data.shape = 'DISK'",
]


def test_what_blender_refuses_is_found_and_nothing_else(rule_checker: Checker, tmp_path: Path) -> None:
    lines = [*_START, *_REFUSED, *_TAKEN]
    answers = run_statements(tmp_path, lines, {})
    refused = [line for line, (error, _, _) in zip(lines, answers, strict=True) if error]
    assert refused == _REFUSED
    found = rule_checker.check("\n".join(lines), rules=_RULES)
    assert [lines[finding.span.line - 1] for finding in found] == _REFUSED


def test_the_method_that_returns_another_value_is_named(rule_checker: Checker) -> None:
    code = "import mathutils\n(mathutils.Vector((1, 2, 3)).normalize()).length\nmathutils.Vector((1, 2)).negate().x\n"
    first, second = rule_checker.check(code, rules=_RULES)
    assert "`normalized()` returns another one" in first.message
    assert "another" not in second.message
