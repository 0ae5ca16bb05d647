"""Vectors and matrices of all sizes in all operations: found is what mathutils refuses for their sizes."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_MADE = """\
import bpy
import mathutils
from mathutils import Euler, Matrix, Quaternion, Vector
ob = bpy.data.objects['Cube']
uv = ob.data.uv_layers.new().data[0]
small = Matrix.Rotation(1, 2)
turned = Euler((1, 2, 3)).to_matrix()
moved = Matrix.Translation((1, 2, 3))
rows = Matrix(((1, 0, 0), (0, 1, 0)))
one = Vector((1, 2))
q = Quaternion((1, 0, 0, 0))
"""
_OPERANDS = (
    "small", "turned", "moved", "rows", "one", "Vector((1, 2, 3))", "Vector()", "Vector([1, 2, 3, 4, 5])",
    "ob.matrix_world", "ob.location", "uv.uv", "ob.data.vertices[0].co", "q", "ob.location.xy",
    "ob.matrix_world.to_3x3()", "ob.matrix_world.inverted()", "turned.to_4x4()", "moved.translation",
    "moved.to_translation()", "uv.uv.to_3d()",
    "turned.transposed()", "-one", "(2 * ob.location)", "Matrix.Diagonal((1, 2))", "(one + one)",
    "(turned @ ob.location)", "(moved @ moved)", "Matrix.Scale(2, 4)", "Vector((1, 2, 3, 4)).normalized()",
)  # fmt: skip
_READ = (
    "x", "z", "w", "xyz", "xy", "zzz", "translation", "dot(ob.location)", "cross(uv.uv)", "cross(ob.location)",
    "angle(uv.uv)", "project(ob.location)", "decompose()", "to_translation()", "to_euler()", "to_quaternion()",
)  # fmt: skip
_LINES = (
    "a, b = ob.location", "a, b, c = ob.location", "a, b = uv.uv", "a, b, *c = ob.location", "ob.location[3]",
    "uv.uv[-3]", "ob.location[-3]", "ob.matrix_world[4]", "turned[3]", "turned[2]", "Matrix.Identity(5)",
    "Matrix.Identity(4)", "Matrix.Scale(1, 1)", "Matrix.Rotation(1, 3, 'X')", "Matrix.Rotation(1, 5, 'X')",
    "ob.location += uv.uv.to_3d()", "ob.location += Vector((1, 2))", "ob.location -= ob.location",
)  # fmt: skip
# How mathutils says that sizes do not fit.
_OF_SIZES = (
    "dimensions", "number of columns", "len(matrix.col)", "column size", "matrix size", "unavailable on", "swizzle",
    "sequence", "out of range", "unpack", "between 2 and 4", "2x2 3x3 or 4x4", "only 3D vector rotations",
    "rows/columns", "2D or 3D",
)  # fmt: skip


def test_what_is_refused_for_its_size_is_found_and_nothing_else(check: Check, tmp_path: Path) -> None:
    made = _MADE.splitlines()
    lines = [f"{left} {sign} {right}" for left, sign, right in product(_OPERANDS, "@+-*", _OPERANDS)]
    lines += [f"({left}).{read}" for left, read in product(_OPERANDS, _READ) if left != "q"]
    lines += _LINES
    answers = run_statements(tmp_path, [*made, *lines])[len(made) :]
    refused = {
        line
        for line, (error, *_) in zip(lines, answers, strict=True)
        if any(said in error for said in _OF_SIZES)
    }
    found = check("wrong-size", "\n".join([*made, *lines]))
    assert sorted({lines[one.span.line - 1 - len(made)] for one in found} ^ refused) == []
    assert len(refused) > 200


def test_a_rotation_is_made_a_transformation(check: Check, tmp_path: Path) -> None:
    lines = ["import bpy", "from mathutils import Euler, Matrix"]
    [finding] = check(
        "wrong-size", "\n".join([*lines, "Euler().to_matrix() @ Matrix.Translation((1, 2, 3))"])
    )
    assert finding.fix
    lines.append(f"{finding.fix.edits[0].text} @ Matrix.Translation((1, 2, 3))")
    assert [error for error, *_ in run_statements(tmp_path, lines) if error] == []


@pytest.mark.parametrize(
    "code",
    [
        "for size in (3, 4):\n    Matrix.Identity(size) @ Matrix.Identity(4)",
        "v = Vector((1, 2))\nv.resize_3d()\nv.z",
        "v = Vector((1, 2))\nif input():\n    v = Vector((1, 2, 3))\nv.z",
        "def f(v):\n    return v.z\nf(Vector((1, 2)))",
        "try:\n    Vector((1, 2)).z\nexcept AttributeError:\n    pass",
        "parts = [1, 2]\nparts.append(3)\nVector(parts).z",
        "Vector((*range(3),)).z",
    ],
)
def test_what_is_not_sure_is_left_alone(check: Check, code: str) -> None:
    assert check("wrong-size", f"from mathutils import Matrix, Vector\n{code}\n") == []


_BUFFERS = """\
import bpy
import numpy as np
mesh = bpy.data.objects["Cube"].data
count = len(mesh.vertices)
short = np.zeros(count, np.float32)
listed = [0.0] * count
long = np.empty(3 * count)
grown = [0.0] * count
grown += [0.0] * 2 * count
"""


_ROWS = """\
import bpy
import numpy as np
from mathutils import Vector
mesh = bpy.data.objects["Cube"].data
corners = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0)] * 2
points = [(float(number), 0.0, 0.0) for number in range(8)]
added = []
for number in range(8): added.append((number, 0, 0))
numbers = []
for point in points: numbers.extend(point)
summed = []
for point in points: summed += point
"""


def test_buffers_of_rows_are_told_and_fixed(check: Check, tmp_path: Path) -> None:
    made = _ROWS.splitlines()
    buffers = (
        "points", "added", "numbers", "summed", "[vertex.co for vertex in mesh.vertices]", "np.array(points)",
        "[Vector(point) for point in points]", "np.asarray(points, dtype=np.float32)", "np.zeros((8, 3))",
        "[number for point in points for number in point]", "np.array(points).ravel()", "np.zeros((1, 24))[0]",
    )  # fmt: skip
    lines = [f"mesh.vertices.foreach_set('co', {buffer})" for buffer in buffers]
    lines += ["mesh.polygons.foreach_set('material_index', [(0,)] * 6)"]
    lines += ["bpy.data.images.new('i', 2, 2).pixels.foreach_set([(0.0, 0.0, 0.0, 1.0)] * 4)"]
    answers = run_statements(tmp_path, [*made, *lines])[len(made) :]
    refused = [line for line, (error, *_) in zip(lines, answers, strict=True) if error]
    found = check("wrong-size", code := "\n".join([*made, *lines]))
    assert [lines[one.span.line - len(made) - 1] for one in found] == refused
    assert 8 < len(refused) < len(lines)
    mended = apply_fixes(Source(code), found).text
    answers = run_statements(tmp_path, mended.splitlines())
    assert [error for error, *_ in answers if error] == []


def test_buffers_are_told_that_blender_finds_too_short(check: Check, tmp_path: Path) -> None:
    made = _BUFFERS.splitlines()
    buffers = (
        "short", "listed", "long", "grown", "np.zeros((count, 3))", "np.zeros((count, 3)).ravel()",
        "np.ones(count * 2)", "[0.0] * 3 * len(mesh.vertices)", "np.full(shape=count * 3, fill_value=1)",
    )  # fmt: skip
    lines = [f"mesh.vertices.foreach_{way}('co', {buffer})" for way in ("get", "set") for buffer in buffers]
    lines.append("mesh.vertices.foreach_get('select', [False] * count)")
    answers = run_statements(tmp_path, [*made, *lines])[len(made) :]
    refused = [line for line, (error, *_) in zip(lines, answers, strict=True) if error]
    told = [
        lines[found.span.line - len(made) - 1] for found in check("wrong-size", "\n".join([*made, *lines]))
    ]
    assert told == refused
    assert 6 < len(refused) < len(lines)


def test_a_tuple_that_is_annotated_with_one_item_may_have_more(check: Check) -> None:
    code = (
        "import mathutils\ndef place(size: tuple[{}]):\n    width, height = size\n    return width, height\n"
    )
    assert check("wrong-size", code.format("float")) == []
    (found,) = check("wrong-size", code.format("float, float, float"))
    assert found.severity == "warning"  # Python does not check the annotation
    (found,) = check("wrong-size", "import mathutils\nsize = (1, 2, 3)\nwidth, height = size\n")
    assert found.severity == "error"
