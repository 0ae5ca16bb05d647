"""Orders of registration: Blender refuses those that are found, and takes the others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

pytestmark = pytest.mark.blender

_CLASSES: str = """\
import bpy
class Part(bpy.types.PropertyGroup):
    size: bpy.props.FloatProperty()
class Settings(bpy.types.PropertyGroup):
    parts: bpy.props.CollectionProperty(type=Part)
class OBJECT_OT_grow(bpy.types.Operator):
    bl_idname = "object.grow"
    bl_label = "Grow"
    parts: bpy.props.CollectionProperty(type=Part)
class TEST_PT_above(bpy.types.Panel):
    bl_label, bl_space_type, bl_region_type = "A", "VIEW_3D", "UI"
    def draw(self, context): ...
class TEST_PT_below(bpy.types.Panel):
    bl_label, bl_space_type, bl_region_type = "B", "VIEW_3D", "UI"
    bl_parent_id = "TEST_PT_above"
    def draw(self, context): ...
"""
_LOOP = "for cls in {}:\n    bpy.utils.register_class(cls)"
_GIVEN = "bpy.types.Scene.settings = bpy.props.PointerProperty(type=Settings)"
_ORDERS = {
    _GIVEN: True,
    f"bpy.utils.register_class(Part)\n{_GIVEN}": True,
    f"def register():\n    {_GIVEN}\nregister()": True,
    f"{_LOOP.format('bpy.types.PropertyGroup.__subclasses__()[-2:]')}\n{_GIVEN}": False,
    f"def every():\n    return [Part, Settings]\n{_LOOP.format('every()')}\n{_GIVEN}": False,
    _LOOP.format("(Settings, Part)"): True,
    _LOOP.format("(Part, Settings)"): False,
    _LOOP.format("(Settings,)"): True,
    "bpy.utils.register_class(Settings)": True,
    "bpy.utils.register_class(OBJECT_OT_grow)": False,
    "for cls in bpy.types.PropertyGroup.__subclasses__()[-2:]:\n    bpy.utils.register_class(cls)\n"
    "bpy.utils.unregister_class(Settings)\nbpy.utils.register_class(Settings)": False,
    "if True:\n    bpy.utils.register_class(Part)\nbpy.utils.register_class(Settings)": False,
    _LOOP.format("(OBJECT_OT_grow, Part)"): False,
    _LOOP.format("(TEST_PT_below, TEST_PT_above)"): True,
    _LOOP.format("(TEST_PT_above, TEST_PT_below)"): False,
    "bpy.utils.register_class(Settings)\nbpy.utils.register_class(Part)": True,
    f"bpy.utils.register_class(Part)\n{_GIVEN}\nbpy.utils.register_class(Settings)": True,
    f"{_LOOP.format('[Part, Settings]')}\n{_GIVEN}": False,
    f"classes = [Settings, Part]\n{_LOOP.format('classes')}": True,
    "register, _ = bpy.utils.register_classes_factory((Settings, Part))\nregister()": True,
}


@pytest.mark.parametrize(("order", "refused"), _ORDERS.items())
def test_what_blender_refuses_is_found(check: Check, tmp_path: Path, order: str, refused: bool) -> None:
    (answer,) = run_statements(tmp_path, [f"{_CLASSES}{order}\n"])
    assert bool(answer[0]) == refused
    found = check("registered-late", f"{_CLASSES}{order}\n")
    assert [finding.severity for finding in found] == ["error"] * refused


@pytest.mark.parametrize(
    "order",
    [
        f"classes = [Settings, Part]\nclasses.reverse()\n{_LOOP.format('classes')}",
        _LOOP.format("sorted((Settings, Part), key=str)"),
        "def first():\n    bpy.utils.register_class(Settings)\ndef second():\n    bpy.utils.register_class(Part)",
        "try:\n    bpy.utils.register_class(Settings)\nexcept ValueError:\n    pass\nbpy.utils.register_class(Part)",
    ],
)
def test_an_order_that_is_not_written_out_is_no_finding(check: Check, order: str) -> None:
    assert check("registered-late", f"{_CLASSES}{order}\n") == []


def test_another_file_may_register_what_this_one_leaves_out(rule_checker: Checker) -> None:
    code = f"{_CLASSES}bpy.utils.register_class(Settings)\n"
    read = rule_checker.read(code)
    for other, count in (
        ("import bpy\n", 1),
        ("import bpy\nfrom . import a\nbpy.utils.register_class(a.Part)\n", 0),
    ):
        package = rule_checker.package([read, rule_checker.read(other)])
        assert len(rule_checker.check(read, package, ["registered-late"])) == count
