"""Properties are reported that a registered class does not have, and no others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from classes_in_blender import found_parts, parts_of, refused_parts

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
    ],
)
def test_what_is_no_lost_property_is_left_alone(check: Check, code: str) -> None:
    assert not check("lost-property", f"import bpy\nfrom bpy.props import IntProperty\n{code}\n")
