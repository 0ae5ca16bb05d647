"""What mathutils' values are added to, subtracted from, divided or multiplied by: found where Blender refuses it."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_MADE = """\
import bpy
from mathutils import Color, Euler, Matrix, Quaternion, Vector
ob = bpy.data.objects['Cube']
light = bpy.data.lights['Light']
vector = Vector((1, 2, 3))
color = Color((1, 2, 3))
euler = Euler((1, 2, 3))
matrix = Matrix.Identity(4)
quaternion = Quaternion((1, 2, 3, 4))
items = (1, 2, 3)
"""
_OPERANDS = (
    "vector", "color", "euler", "matrix", "quaternion", "ob.location", "ob.rotation_euler", "light.color",
    "ob.rotation_quaternion", "ob.matrix_world", "items", "(1.0, 2.0, 3.0)", "2", "1.5", "True", "'text'",
    "ob.data.vertices[0].co", "ob.data.vertices[0].normal", "ob.scale", "ob.dimensions", "ob.color",
    "ob.location.x", "ob.location[:]", "ob.bound_box[0]", "[1, 2, 3]", "tuple(vector)", "list(vector)",
    "vector.xy", "vector.normalized()", "matrix.to_translation()", "matrix.to_euler()", "matrix.col[0]", "None",
)  # fmt: skip
# As it is refused for another reason: the lengths of two vectors differ, or nothing is known of what it is.
_OTHER = "vectors must have the same dimensions"


def test_sums_that_blender_refuses_are_found(rule_checker: Checker, tmp_path: Path) -> None:
    made = _MADE.splitlines()
    lines = [f"{left} {sign} {right}" for left, sign, right in product(_OPERANDS, "+-*/@", _OPERANDS)]
    lines += [
        f"x = {left}\nx {sign}= {right}" for left, sign, right in product(_OPERANDS[:5], "+-*/@", _OPERANDS)
    ]
    answers = run_statements(tmp_path, [*made, *lines])[len(made) :]
    code = "\n".join([*made, *(line.replace("\n", "; ") for line in lines)])
    findings = rule_checker.check(code, rules=["refused-product"])
    found = {one.span.line - len(made) for one in findings if one.severity == "error"}
    wrong = [line for at, (line, (error, *_)) in enumerate(zip(lines, answers, strict=True), 1)
             if at in found and not error]  # fmt: skip
    assert wrong == []
    math = {
        "vector", "color", "euler", "matrix", "quaternion", "items", "2", "1.5", "ob.location", "light.color",
        "ob.bound_box[0]", "ob.color",
    }  # fmt: skip
    missed = [line for at, (line, (error, *_)) in enumerate(zip(lines, answers, strict=True), 1)
              if error and at not in found and _OTHER not in error
              and {*(words := line.removeprefix("x = ").split())[:1], words[-1]} <= math
              and not {words[0], words[-1]} <= {"items", "2", "1.5", "ob.bound_box[0]", "ob.color"}]  # fmt: skip
    assert missed == []
    assert len(found) > 1_000


def test_products_of_two_transformations_by_item_are_warned_of(rule_checker: Checker, tmp_path: Path) -> None:
    """Where ``*`` gives a transformation that is not the one that ``@`` gives."""
    made = [*_MADE.splitlines(), "matrix = matrix.Rotation(1, 4, 'X')"]
    operands = (
        "vector", "matrix", "quaternion", "ob.matrix_basis", "matrix.inverted()", "2.5", "ob.location",
        "ob.rotation_quaternion",
    )  # fmt: skip
    lines = [f"x = {left} * {right}" for left, right in product(operands, operands)]
    lines += [
        f"x = {left}.copy(); x *= {right}"
        for left, right in product(("vector", "matrix", "quaternion"), operands)
    ]
    watched = {len(made) + at: "type(x).__name__, x" for at in range(len(lines))}
    answers = run_statements(tmp_path, [*made, *lines], watched)[len(made) :]
    found = {
        one.span.line - len(made): one
        for one in rule_checker.check("\n".join([*made, *lines]), rules=["refused-product"])
        if one.severity == "warning"
    }
    transforming = [
        at for at, (line, (error, _, value)) in enumerate(zip(lines, answers, strict=True), 1)
        if not error and value.startswith(("('Matrix'", "('Quaternion'")) and "2.5" not in line
    ]  # fmt: skip
    assert sorted(found) == transforming
    assert len(found) > 15
    assert all(one.fix and not one.fix.sure for at, one in found.items() if " *= " not in lines[at - 1])


_DECLARED = """\
class Group(bpy.types.PropertyGroup):
    plain: bpy.props.FloatVectorProperty()
    moved: bpy.props.FloatVectorProperty(subtype='TRANSLATION')
    counts: bpy.props.IntVectorProperty()
    rows: bpy.props.FloatVectorProperty(size=(4, 4))
bpy.utils.register_class(Group)
bpy.types.Scene.group = bpy.props.PointerProperty(type=Group)
group = bpy.context.scene.group
"""
_OF_ARRAYS = (
    "ob.location + group.plain", "ob.location += group.plain", "ob.location + group.moved",
    "ob.location += group.moved", "ob.location - group.counts", "vector * group.plain",
    "ob.location + Vector(group.plain)", "group.plain[0] + group.plain[1]", "group.counts[0] * vector",
    "matrix @ group.rows", "matrix @ Matrix(group.rows)", "group.rows[0][1] * vector",
    "ob.location = group.plain; ob.location + vector", "ob.location = ob.bound_box[0]; ob.location += vector",
    "ob.color = (1, 1, 1, 1); group.plain = ob.location; group.plain + vector",
    "group.moved = group.plain; group.moved + vector", "light.color = group.plain; light.color + vector",
)  # fmt: skip


def test_arrays_are_no_vectors_and_become_none_where_they_are_assigned(
    rule_checker: Checker, tmp_path: Path
) -> None:
    made = f"{_MADE}{_DECLARED}"
    answers = run_statements(tmp_path, [made, *_OF_ARRAYS])[1:]
    refused = {line for line, (error, *_) in zip(_OF_ARRAYS, answers, strict=True) if error}
    found = {line for line in _OF_ARRAYS if rule_checker.check(f"{made}{line}\n", rules=["refused-product"])}
    assert found == refused
    assert 4 < len(found) < len(_OF_ARRAYS)
