"""Properties are reported that a registered class does not have, and no others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from classes_in_blender import found_parts, parts_of, refused_parts
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_CLASSES = """\
class X(PropertyGroup):
    count: IntProperty()

class X(PropertyGroup):
    count = IntProperty()

class X(PropertyGroup):
    count: int = IntProperty()

class X(PropertyGroup):
    count: IntProperty

class X(PropertyGroup):
    count: IntProperty() = IntProperty()

class X(PropertyGroup):
    count: bpy.props.IntProperty()
    _count: IntProperty()

class X(AddonPreferences):
    count: IntProperty()

class X(UIList):
    count: IntProperty()

class X(UIList):
    count = IntProperty()

class X(Node):
    bl_label = "label"
    count: IntProperty()

class X(NodeTree):
    bl_label = "label"
    bl_icon = "NODETREE"
    count: IntProperty()

class X(NodeSocket):
    count: IntProperty()
    def draw(self, context, layout, node, text): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    count: IntProperty()
    def draw(self, context): pass

class X(Menu):
    bl_label = "label"
    count: IntProperty()
    def draw(self, context): pass

class X(Header):
    bl_space_type = "VIEW_3D"
    count: IntProperty()
    def draw(self, context): pass

class X(RenderEngine):
    bl_label = "label"
    count: IntProperty()

class X(FileHandler):
    bl_label = "label"
    bl_file_extensions = ".test"
    count: IntProperty()
"""


def test_what_is_lost_is_reported_and_nothing_else(check: Check, tmp_path: Path) -> None:
    parts = parts_of(_CLASSES)
    lost = refused_parts(tmp_path, parts, watched="'count' in X.bl_rna.properties")
    found = found_parts(check, "lost-property", parts) | found_parts(
        check, "lost-property", parts, severity="warning"
    )
    assert found == lost
    assert 8 < len(lost) < len(parts)


@pytest.mark.parametrize(
    "code",
    [
        "class Plain:\n    count = IntProperty()",
        "class Group(bpy.types.PropertyGroup):\n    count = 3\n    size: int",
        "class Group(bpy.types.PropertyGroup):\n    count = IntProperty()\n"
        "Group.__annotations__ = {'count': Group.count}",
        "class Group(bpy.types.PropertyGroup):\n    count = IntProperty()\n"
        "Group.__dict__['__annotations__']['count'] = Group.count",
    ],
)
def test_what_is_no_lost_property_is_left_alone(check: Check, code: str) -> None:
    assert not check("lost-property", f"import bpy\nfrom bpy.props import IntProperty\n{code}\n")


_LATER = {
    "Settings.count = bpy.props.IntProperty()\nbpy.utils.register_class(Settings)": True,
    "class Other:\n    Settings.count = bpy.props.IntProperty()\nbpy.utils.register_class(Settings)": True,
    "bpy.utils.register_class(Settings)\nSettings.count = bpy.props.IntProperty()": False,
    "def register():\n    bpy.utils.register_class(Settings)\n    Settings.count = bpy.props.IntProperty()\n"
    "register()": False,
    "Settings.__annotations__['count'] = bpy.props.IntProperty()\nbpy.utils.register_class(Settings)": False,
    "Settings.count = 1\nSettings.count: bpy.props.IntProperty()\nbpy.utils.register_class(Settings)": False,
}  # fmt: skip
_GROUP = "import bpy\nclass Settings(bpy.types.PropertyGroup):\n    other: bpy.props.IntProperty()\n"
_USE = "\nbpy.types.Scene.mine = bpy.props.PointerProperty(type=Settings)\nbpy.context.scene.mine.count + 1"


@pytest.mark.parametrize("code", _LATER)
def test_what_is_given_to_a_class_before_it_is_registered_is_lost(
    check: Check, tmp_path: Path, code: str
) -> None:
    (row,) = run_statements(tmp_path, [_GROUP + code + _USE])
    is_lost = _LATER[code]
    assert ("_PropertyDeferred" in row[0]) is is_lost
    assert [finding.span.line for finding in check("lost-property", _GROUP + code)] == (
        [4 + code.startswith("class")] * is_lost
    )
