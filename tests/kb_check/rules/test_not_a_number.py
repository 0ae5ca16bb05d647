"""Where Python wants a number: each statement is run, and fails or does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy, math
from math import radians as rad
from mathutils import Vector, Matrix, Euler
ob = bpy.data.objects.new("o", bpy.data.meshes.new("m"))
v = Vector((1, 2, 3))
"""
_REFUSED = (
    "math.radians((90, 0, 45))",
    "rad([90, 0, 45])",
    "math.degrees(ob.rotation_euler)",
    "math.sqrt(v)",
    "math.sin('1')",
    "round(ob.location, 2)",
    "abs(v)",
    "abs(Matrix())",
    "float(ob.location)",
    "int(ob)",
    "v ** 2",
    "v // 2",
    "ob.matrix_world % 3",
    "Euler() ** 2.0",
)
_RUN = (
    "[math.radians(angle) for angle in (90, 0, 45)]",
    "math.degrees(ob.rotation_euler.z)",
    "math.sqrt(v.x)",
    "math.dist(v, v)",
    "round(ob.location.x, 2)",
    "abs(v.x)",
    "float('1.5')",
    "int(len(ob.name))",
    "v.x ** 2",
    "'%s' % v",
    "math.hypot(*v)",
    "math.floor(ob.dimensions[0])",
)


def test_what_is_no_number_is_found(check: Check, tmp_path: Path) -> None:
    errors = [error.partition(":")[0] for error, *_ in run_statements(tmp_path, [_START, *_REFUSED, *_RUN])]
    assert {*errors[1 : len(_REFUSED) + 1]} == {"TypeError", "ValueError"}
    assert errors[len(_REFUSED) + 1 :] == [""] * len(_RUN)
    found = [len(check("not-a-number", f"{_START}{code}\n")) for code in (*_REFUSED, *_RUN)]
    assert found == [1] * len(_REFUSED) + [0] * len(_RUN)


def test_what_is_meant_is_told(check: Check) -> None:
    [found] = check("not-a-number", f"{_START}math.radians((90, 0, 45))\n")
    assert found.message.endswith("Of each angle: `[math.radians(angle) for angle in (90, 0, 45)]`.")
    [found] = check("not-a-number", f"{_START}abs(v)\n")
    assert "`vector.length`" in found.message


def test_a_name_that_stands_for_another_function_is_none(check: Check) -> None:
    code = f"{_START}def rad(values):\n    return values\nrad((1, 2))\n"
    assert check("not-a-number", code) == []
    assert check("not-a-number", f"{_START}round = print\nround(v)\n") == []
    assert check("not-a-number", f"{_START}try:\n    abs(v)\nexcept TypeError:\n    pass\n") == []
