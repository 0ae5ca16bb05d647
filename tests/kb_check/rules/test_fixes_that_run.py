"""A name is written in the place of a wrong one only where the script may run with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from kb_check.checker import Checker

_ZONE = (
    "nodes = bpy.data.node_groups.new('x', 'GeometryNodeTree').nodes\n"
    "first, last = nodes.new('GeometryNodeRepeatInput'), nodes.new('GeometryNodeRepeatOutput')\n"
)
_OPERATOR = "class X_OT_x(bpy.types.Operator):\n    bl_idname, bl_label = 'x.x', 'x'\n"


def _mended(checker: Checker, code: str) -> str:
    """The last line of a script after all its fixes."""
    source = Source(f"import bpy\n{code}")
    return apply_fixes(source, checker.check(source.text), unsafe=True).text.splitlines()[-1]


@pytest.mark.parametrize(
    ("before", "line"),
    [
        (_ZONE, "first.pair_output(last)"),
        (_OPERATOR, "bpy.utils.register_classes((X_OT_x,))"),
        ("", "bpy.context.scene.collections.link(bpy.data.collections.new('x'))"),
        ("ob = bpy.context.selected_object\n", "ob.location.x = 3"),
        ("", "bpy.context.selected_object.location.x = 3"),
    ],
)
def test_what_would_fail_is_not_written(rule_checker: Checker, before: str, line: str) -> None:
    (found,) = rule_checker.check(f"import bpy\n{before}{line}")
    assert found.severity == "error"
    assert found.fix is None


@pytest.mark.parametrize(
    "line",
    [
        "bpy.ops.mesh.primitive_uv_sphere_add(segments=8, radius=1, size=2)",
        "bpy.ops.transform.rotate(value=1, constraint_orientation='GLOBAL', orient_type='LOCAL')",
        "bpy.ops.export_scene.obj(filepath='x', use_selection=True, export_selected_objects=True)",
    ],
)
def test_no_keyword_is_written_twice(rule_checker: Checker, line: str) -> None:
    mended = _mended(rule_checker, line)
    compile(mended, "mended", "exec")
    assert mended.partition("(")[2] == line.partition("(")[2], "two values contradict each other"


@pytest.mark.parametrize(
    ("before", "line", "right"),
    [
        (_ZONE, "first.pair_with_outptu(last)", "first.pair_with_output(last)"),
        (_OPERATOR, "bpy.utils.register_clas(X_OT_x)", "bpy.utils.register_class(X_OT_x)"),
        ("", "bpy.context.scene.colection.name", "bpy.context.scene.collection.name"),
        ("", "bpy.context.selected_objcts.copy()", "bpy.context.selected_objects.copy()"),
        ("", "bpy.context.object.modifers.reomve(None)", "bpy.context.object.modifiers.reomve(None)"),
    ],
)
def test_what_may_run_is_written(rule_checker: Checker, before: str, line: str, right: str) -> None:
    assert _mended(rule_checker, before + line) == right
