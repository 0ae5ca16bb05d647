"""What calls took once and Blender refuses now: shaders by their former names, dictionaries with a context."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_check.checker import Checker


@pytest.mark.parametrize(
    ("former", "name"),
    [
        ("2D_UNIFORM_COLOR", "UNIFORM_COLOR"),
        ("3D_SMOOTH_COLOR", "SMOOTH_COLOR"),
        ("2D_IMAGE", "IMAGE"),
        ("3D_POLYLINE_FLAT_COLOR", "POLYLINE_FLAT_COLOR"),
    ],
)
def test_a_shader_has_another_name(rule_checker: Checker, former: str, name: str) -> None:
    (found,) = rule_checker.check(f"import gpu\ngpu.shader.from_builtin('{former}')\n")
    assert (found.rule, found.severity) == ("unknown-value", "error")
    assert found.fix is not None
    assert (found.fix.sure, found.fix.edits[0].text) == (True, f"'{name}'")
    assert rule_checker.check(f"import gpu\ngpu.shader.from_builtin(shader_name='{name}')\n") == []


def test_shaders_are_those_that_the_module_lists(rule_checker: Checker) -> None:
    listed = rule_checker.api.values_of("gpu.shader.from_builtin(shader_name)")
    assert {"FLAT_COLOR", "IMAGE_COLOR", "POINT_UNIFORM_COLOR", "POLYLINE_SMOOTH_COLOR"} <= set(listed)
    assert not any(name.startswith(("2D_", "3D_")) for name in listed)


_FILLED = {
    "in a loop": """
    given = bpy.context.copy()
    for area in bpy.context.screen.areas:
        given["area"] = area
        for step in range(3):
            bpy.ops.outliner.show_one_level(given, open=False)
""",
    "anew, in a loop": """
    given = {}
    for area in bpy.context.screen.areas:
        given["area"] = area
        bpy.ops.outliner.show_one_level(given, open=False)
""",
    "on one way": """
    given = bpy.context.copy()
    if bpy.context.area:
        given["area"] = bpy.context.area
    bpy.ops.outliner.show_one_level(given, open=False)
""",
}


@pytest.mark.parametrize("how", _FILLED)
def test_a_dictionary_that_is_filled_is_still_one(rule_checker: Checker, how: str) -> None:
    (found,) = rule_checker.check(f"import bpy\n\n\ndef f():{_FILLED[how]}")
    assert found.rule == "positional-argument"
    assert "temp_override" in found.message


def test_what_may_be_no_dictionary_is_no_finding(rule_checker: Checker) -> None:
    code = """\
import bpy


def f(how):
    given = how or {}
    bpy.ops.outliner.show_one_level(given, open=False)
"""
    assert rule_checker.check(code) == []


def test_what_is_given_by_its_place_is_left_to_the_argument_that_lacks(rule_checker: Checker) -> None:
    code = (
        "import bpy\n"
        "tree = bpy.data.node_groups.new('Films', 'CompositorNodeTree')\n"
        "node = tree.nodes.new('CompositorNodeOutputFile')\n"
        "node.file_output_items.new('Depth')\n"
        "node.file_output_items.new('Depth', 'Depth')\n"
    )
    found = [(finding.span.line, finding.rule) for finding in rule_checker.check(code)]
    assert found == [(4, "missing-argument"), (5, "unknown-value")]
