"""What an operator has just made is known as the active object, until something may have changed that."""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

AROUND = """
import bpy
bpy.ops.mesh.primitive_cube_add()
cube = bpy.context.object
"""
# Lines, which Blender refuses → the symbols of what is found.
REFUSED = {
    "a text's filling": (
        "bpy.ops.object.text_add()\ntxt = bpy.context.object\ntxt.data.fill_mode = 'FULL'",
        ["bpy.types.Curve.fill_mode"],
    ),
    "a text's filling, read at once": (
        "bpy.ops.object.text_add()\nbpy.context.object.data.fill_mode = 'FULL'",
        ["bpy.types.Curve.fill_mode"],
    ),
    "one of two new curves": (
        """
        first = bpy.data.curves.new("a", 'CURVE')
        first.dimensions = '3D'
        first.fill_mode = 'FULL'
        second = bpy.data.curves.new("b", 'CURVE')
        second.fill_mode = 'FULL'
        """,
        ["bpy.types.Curve.fill_mode"],
    ),
    "what its data lacks": (
        "bpy.ops.object.text_add()\ntxt = bpy.context.active_object\ntxt.data.bogus",
        ["bpy.types.TextCurve.bogus"],
    ),
    "what the data of a helper's result lacks": (
        """
        def text(body):
            bpy.ops.object.text_add()
            made = bpy.context.object
            made.data.body = body
            return made
        text("a")
        text("b").data.bogus
        """,
        ["bpy.types.TextCurve.bogus"],
    ),
}
TAKEN = {
    "a curve that an operator makes": """
        bpy.ops.curve.primitive_bezier_curve_add()
        made = bpy.context.object
        made.name = "a"
        made.data.fill_mode = 'FULL'
    """,
    "a text that is set before": """
        bpy.ops.object.text_add()
        txt = bpy.context.object
        txt.data.dimensions = '3D'
        txt.data.fill_mode = 'FULL'
    """,
    "a new curve that another name sets": """
        made = bpy.data.curves.new("a", 'CURVE')
        other = made
        other.dimensions = '3D'
        made.fill_mode = 'FULL'
    """,
    "another active object": """
        bpy.ops.object.text_add()
        bpy.context.view_layer.objects.active = cube
        bpy.context.object.data.vertices
    """,
    "what another operator makes": """
        bpy.ops.object.text_add()
        bpy.ops.mesh.primitive_cube_add()
        bpy.context.object.data.vertices
    """,
    "what a function makes": """
        def box():
            bpy.ops.mesh.primitive_cube_add()
        bpy.ops.object.text_add()
        box()
        bpy.context.object.data.vertices
    """,
    "what one way makes": """
        bpy.ops.object.text_add()
        if bpy.context.scene.frame_current:
            bpy.ops.mesh.primitive_cube_add()
        bpy.context.object.data.vertices
    """,
    "what a context overrides": """
        bpy.ops.object.text_add()
        with bpy.context.temp_override(object=cube, active_object=cube):
            bpy.context.object.data.vertices
    """,
    "what is converted": """
        bpy.ops.object.text_add()
        txt = bpy.context.object
        bpy.ops.object.convert(target='MESH')
        txt.data.vertices
    """,
}


@pytest.mark.parametrize(("lines", "symbols"), REFUSED.values(), ids=REFUSED)
def test_what_an_operator_has_made_is_known(rule_checker: Checker, lines: str, symbols: list[str]) -> None:
    findings = rule_checker.check(AROUND + dedent(lines))
    assert [finding.symbol for finding in findings if finding.severity == "error"] == symbols


@pytest.mark.parametrize("lines", TAKEN.values(), ids=TAKEN)
def test_what_may_be_another_is_not(rule_checker: Checker, lines: str) -> None:
    findings = rule_checker.check(AROUND + dedent(lines))
    assert [finding.message for finding in findings if finding.severity == "error"] == []


def test_blender_refuses_the_same(tmp_path: Path) -> None:
    lines = [*(lines for lines, _ in REFUSED.values()), *TAKEN.values()]
    done = run_statements(tmp_path, [AROUND + dedent(each) for each in lines])
    failed = {name: bool(row[0]) for name, row in zip([*REFUSED, *TAKEN], done, strict=True)}
    assert failed == {name: name in REFUSED for name in failed}
