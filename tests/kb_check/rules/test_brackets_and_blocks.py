"""Fixes keep the brackets around what they write beside; what stands in other blocks than a body counts as well."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from conftest import Check

_START = "import bpy, bmesh\nob = bpy.data.objects['Cube']\nmat = bpy.data.materials['A']\n"


@pytest.mark.parametrize(
    ("rule", "code", "fixed"),
    [
        (
            "wrong-type",
            "mat.diffuse_color = (0.8, 0.8, (0.1 + 0.2))",
            "mat.diffuse_color = (0.8, 0.8, (0.1 + 0.2), 1.0)",
        ),
        (
            "wrong-type",
            "mat.diffuse_color = ((0.8), (0.8), ((0.1)  # )\n))",
            "mat.diffuse_color = ((0.8), (0.8), ((0.1)  # )\n), 1.0)",
        ),
        ("wrong-type", "mat.specular_color = 1, (0.1), (0.2), (1.0)", "mat.specular_color = 1, (0.1), (0.2)"),
        ("positional-argument", 'ob.shape_key_add(("Smile"))', 'ob.shape_key_add(name=("Smile"))'),
        ("positional-argument", 'ob.shape_key_add (  ("A"))', 'ob.shape_key_add (  name=("A"))'),
        ("positional-argument", '(ob.shape_key_add)("A")', '(ob.shape_key_add)(name="A")'),
    ],
)
def test_brackets_stay_around_what_they_are_around(check: Check, rule: str, code: str, fixed: str) -> None:
    found = check(rule, _START + code)
    assert apply_fixes(Source(_START + code), found).text == _START + fixed


def test_two_numbers_given_to_what_sets_one_are_not_two_arguments(check: Check) -> None:
    (finding,) = check("read-only", f"{_START}ob.select_set = True, False")
    assert finding.fix is None


_EXTRUDED = 'bmesh.ops.extrude_face_region(bmesh.new(), geom=[])["verts"]'


@pytest.mark.parametrize(
    ("code", "count"),
    [
        (f"with bpy.context.temp_override(object=ob):\n    {_EXTRUDED}", 1),
        (f"try:\n    {_EXTRUDED}\nfinally:\n    print(1)", 1),
        (f"try:\n    {_EXTRUDED}\nexcept KeyError:\n    pass", 0),
        (f"try:\n    {_EXTRUDED}\nexcept* KeyError:\n    pass", 0),
        (f"with suppress(KeyError):\n    {_EXTRUDED}", 0),
    ],
)
def test_what_catches_an_error_of_a_key_is_told_from_what_does_not(
    check: Check, code: str, count: int
) -> None:
    assert len(check("not-subscriptable", _START + code)) == count


@pytest.mark.parametrize(
    "run",
    [
        "main()",
        "if not ob:\n    pass\nelse:\n    main()",
        "try:\n    import numpy\nexcept ImportError:\n    numpy = None\nelse:\n    main()",
        "match ob.name:\n    case 'A':\n        main()",
    ],
)
def test_a_call_in_any_block_runs_a_script(check: Check, run: str) -> None:
    code = f"{_START}def main():\n    bpy.ops.view3d.view_all()\n{run}\n"
    assert [finding.rule for finding in check("needs-context", code)] == ["needs-context"]


def test_nothing_runs_a_script_that_only_defines(check: Check) -> None:
    code = f"{_START}def main():\n    bpy.ops.view3d.view_all()\nclass A:\n    main = print()\n"
    assert check("needs-context", code) == []


@pytest.mark.parametrize(
    ("body", "count"),
    [
        ("with open(p):\n            return {'FINISHED'}\n        print(1)", 0),
        (
            "if p:\n            return {'FINISHED'}\n        else:\n            return {'CANCELLED'}\n        print(1)",
            0,
        ),
        ("if p:\n            return {'FINISHED'}\n        print(1)", 1),
    ],
)
def test_an_end_behind_what_always_returns_is_not_come_to(check: Check, body: str, count: int) -> None:
    head = "class A(bpy.types.Operator):\n    bl_idname = 'a.b'\n    bl_label = 'A'\n"
    code = f"{_START}p = ''\n{head}    def execute(self, context):\n        {body}\n"
    assert len(check("callback-result", code)) == count


def test_a_truth_value_that_is_written_as_not_is_one(check: Check) -> None:
    call = "bpy.ops.mesh.primitive_cube_add('EXEC_DEFAULT', {})"
    assert check("positional-argument", _START + call.format("not 0")) == []
    assert len(check("positional-argument", _START + call.format("-2"))) == 1


def test_a_comparison_may_begin_with_the_text(check: Check) -> None:
    code = """
    import bpy
    class A(bpy.types.PropertyGroup):
        kind: bpy.props.EnumProperty(items=[("FIRST", "", ""), ("SECOND", "", "")])
        def f(self):
            return {}
    """
    found = [
        check("own-property", code.format(one)) for one in ('self.kind == "BEST"', '"BEST" == self.kind')
    ]
    assert [len(one) for one in found] == [1, 1]
