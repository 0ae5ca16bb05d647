"""Values of many lengths and kinds for arrays, whole numbers and custom properties: what Blender refuses is found."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_MADE = """\
import bpy
import colorsys
import json
import math
from mathutils import Color, Euler, Matrix, Quaternion, Vector
ob = bpy.data.objects['Cube']
scene = bpy.context.scene
light = bpy.data.lights['Light']
action = bpy.data.actions.new('Turn')
pair = (1, 2)
triple = [1.0, 2.0, 3.0]
half = scene.frame_end / 2
class Own: pass
def add(): return 1
"""
_ROWS = (
    "(1, 2)", "(1, 2, 3)", "[1, 2, 3, 4]", "pair", "triple", "[0] * 3", "[0.0] * 4", "(0,) * 2 + (1,)",
    "[*ob.location]", "[*ob.location, 1]", "(*ob.color,)", "list(ob.location)", "list(ob.location) + [1]",
    "tuple(ob.location[:2])", "ob.color[:3]", "ob.color[:]", "ob.location.xy", "ob.location", "ob.color",
    "ob.rotation_quaternion", "ob.rotation_euler", "ob.matrix_world[3]", "ob.matrix_world.col[3]",
    "ob.matrix_world.to_3x3()[0]", "ob.matrix_world.translation", "colorsys.hsv_to_rgb(1, 1, 1)",
    "colorsys.hsv_to_rgb(1, 1, 1) + (1,)", "(*colorsys.rgb_to_hls(1, 1, 1), 1)", "range(3)",
    "Vector((1, 2, 3, 4))", "Color()",
)  # fmt: skip
_TAKERS = (
    "ob.location = {}", "ob.color = {}", "ob.rotation_quaternion = {}", "light.color = {}", "ob.location[:] = {}",
    "ob.location[:2] = {}", "ob.location.xy = {}", "ob.location.xyz = {}", "ob.color[:] = {}", "ob.color[:3] = {}",
    "ob.rotation_euler[:] = {}", "ob.matrix_world[0] = {}", "a, b, c = {}", "a, b = {}", "a, b, c, d = {}",
)  # fmt: skip
_ITERATORS = (
    "(i for i in triple)",
    "map(float, triple)",
    "reversed(triple)",
    "zip(pair)",
)  # without a length
_LINES = (
    "scene.frame_start, scene.frame_end = action.frame_range", "scene.frame_start, scene.frame_end = map(int, pair)",
    "scene.frame_start, scene.frame_end = pair", "scene.frame_start, scene.frame_end = ob.location.xy",
    "scene.frame_start, ob.location.x = ob.location.xy", "ob.name, ob.pass_index = pair",
    "scene.render.resolution_x /= 2", "scene.render.resolution_x //= 2", "scene.render.resolution_x *= 2",
    "scene.render.resolution_x *= 0.5", "scene.frame_end += 1.5", "scene.frame_end -= 1", "ob.location.x /= 2",
    "scene.frame_end %= 7.5", "scene.frame_end += ob.location.x", "scene.frame_end += scene.frame_start",
    "scene.frame_end = half", "scene.frame_end = int(half)", "scene.frame_end = math.pi / 2",
    "range(half)", "range(int(half))", "range(ob.location.x)", "range(0, scene.frame_end, scene.frame_step)",
    "range(*pair)", "range(scene.render.fps_base)", "range(len(triple) / 2)", "range(ob.scale[0])",
    "triple[ob.location.x]", "triple[0]", "pair[half]", "triple[half:]", "'x' * half", "'x' * scene.frame_step",
    "triple * ob.scale.x", "2 * triple", "half * 'x'", "ob.location.x = None", "ob.location.x = 'a'",
    "sum(v.co for v in ob.data.vertices)", "sum([v.co for v in ob.data.vertices], Vector())",
    "sum([ob.location, ob.scale])", "sum(v.co.x for v in ob.data.vertices)", "sum(ob.location)",
    "sum([Color(), Color()])", "ob.data.vertices['x']", "bpy.context.object.data.vertices['x']",
    "ob.data.vertices.foreach_set('select', ['a'] * 8)", "ob.data.vertices.foreach_set('select', [True] * 8)",
)  # fmt: skip
_JSON = [
    f"json.dumps({value})"
    for value in (
        "ob.location", "list(ob.location)", "{'a': ob.location}", "[ob.location]", "[*ob.location]", "ob", "ob.name",
        "(1, ob.color)", "tuple(ob.color)", "ob.matrix_world", "ob, default=str", "ob.location.x",
        "{'a': {'b': ob.data}}", "ob['kept'] if 'kept' in ob else 1", "scene.frame_current",
        "[list(row) for row in ob.matrix_world]",
    )
]  # fmt: skip
_KEPT = (
    "{1, 2}", "{n for n in pair}", "(n for n in pair)", "map(int, pair)", "range(3)", "lambda: 1", "Own", "len",
    "add", "add()", "bpy.types.Object", "Matrix()", "Vector()", "[1, 'a']", "['a', 'b']", "(1, 'a')", "[None]",
    "[1, None]", "[]", "{}", "[[1, 2], [3, 4]]", "[(1, 2), (3, 4)]", "[{'a': 1}]", "[{'a': 1}, 2]", "[True, 1]",
    "[1, 2.5]", "b'x'", "None", "ob", "[ob]", "ob.location", "bpy.ops.object.delete", "'a'", "str(pair)", "set()",
)  # fmt: skip
_OF_LAYERS = """\
import bmesh
bm = bmesh.new()
bmesh.ops.create_cube(bm, size=1)
color = bm.loops.layers.color.new('a')
float_color = bm.loops.layers.float_color.new('b')
vector = bm.verts.layers.float_vector.new('c')
shape = bm.verts.layers.shape.new('d')
bm.faces.ensure_lookup_table()
face = bm.faces[0]
loop, vert = face.loops[0], face.verts[0]
"""
_FILLED = [
    f"{filled} = {(1.0,) * count}"
    for filled in ("loop[color]", "loop[float_color]", "vert[vector]", "vert[shape]")
    for count in (2, 3, 4)
]
_RULES = ["wrong-type", "wrong-size", "wrong-count", "refused-product", "not-subscriptable"]


def _compare(
    checker: Checker, folder: Path, lines: list[str], made_of: str = _MADE
) -> tuple[list[str], list[str]]:
    """What is reported and works, and what Blender refuses and is not reported."""
    made = made_of.splitlines()
    answers = run_statements(folder, [*made, *lines])[len(made) :]
    found = {one.span.line - len(made) for one in checker.check("\n".join([*made, *lines]), rules=_RULES)}
    rows = list(enumerate(zip(lines, answers, strict=True), start=1))
    wrong = [line for at, (line, (error, *_)) in rows if at in found and not error]
    missed = [line for at, (line, (error, *_)) in rows if at not in found and error]
    return wrong, missed


def test_rows_of_another_length_are_found(rule_checker: Checker, tmp_path: Path) -> None:
    lines = [taker.format(row) for taker, row in product(_TAKERS, _ROWS)]
    lines += [taker.format(row) for taker, row in product(_TAKERS[:4], _ITERATORS)]
    assert _compare(rule_checker, tmp_path, lines) == ([], [])


@pytest.mark.parametrize(
    "lines", [_LINES, [f"ob['kept'] = {value}" for value in _KEPT]], ids=["ints", "custom"]
)
def test_values_of_another_kind_are_found(rule_checker: Checker, tmp_path: Path, lines: list[str]) -> None:
    assert _compare(rule_checker, tmp_path, list(lines)) == ([], [])


def test_values_of_layers_of_another_length_are_found(rule_checker: Checker, tmp_path: Path) -> None:
    assert _compare(rule_checker, tmp_path, _FILLED, _OF_LAYERS) == ([], [])


def test_what_only_an_annotation_calls_a_float_is_not_reported(check: Check) -> None:
    assert not check(
        "wrong-type", "def show(count: float):\n    for step in range(count):\n        print(step)\n"
    )


def test_what_divides_an_unknown_value_is_a_float(check: Check) -> None:
    code = """\
    import bpy

    def show(options):
        bpy.context.scene.frame_end = options.frames / 2
        bpy.context.scene.frame_end = options.frames // 2
    """
    assert [one.span.line for one in check("wrong-type", code)] == [4]


def test_a_color_that_a_function_is_given_without_alpha_is_told_how_to_get_one(check: Check) -> None:
    code = """\
    import bpy

    def paint(color):
        bpy.data.materials["Red"].diffuse_color = color

    paint((1, 0, 0))
    """
    (found,) = check("wrong-type", code)
    assert "(*color, 1.0)" in found.message
