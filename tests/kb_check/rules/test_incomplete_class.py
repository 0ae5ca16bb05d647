"""Classes are reported that Blender refuses for what they lack, and no others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from classes_in_blender import found_parts, parts_of, refused_parts

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_CLASSES = """\
class X(Operator):
    bl_idname = "test._x_"

class X(Operator):
    bl_label = "label"

class X(Operator):
    bl_idname: str = "test._x_"
    bl_label: str = "label"

class X(Operator):
    bl_idname = "test._x_"
    bl_label: StringProperty(default="label")

class X(Macro):
    bl_label = "label"

class X(Macro):
    bl_idname = "test._x_"
    bl_label = "label"

class X(Panel):
    bl_label = "label"
    bl_region_type = "UI"
    def draw(self, context): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "VIEW_3D"
    def draw(self, context): pass

class X(Panel):
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    def draw(self, context): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"

class MixinX:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    def draw(self, context): pass
class X(MixinX, Panel):
    bl_label = "label"

class MixinX:
    bl_space_type = "VIEW_3D"
    def draw(self, context): pass
class X(MixinX, Panel):
    bl_label = "label"

class X(Panel):
    bl_label = "label"
    bl_space_type = "VIEW_3D"
    bl_region_type = "TOOLS"
    bl_category = "Tools"
    def draw(self, context): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Tools"
    def draw(self, context): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "VIEW_3D"
    bl_region_type = "TOOLS"
    bl_category = ""
    def draw(self, context): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_category = "Tools"
    def draw(self, context): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "CLIP_EDITOR"
    bl_region_type = "TOOLS"
    bl_category = "Tools"
    def draw(self, context): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "CLIP_EDITOR"
    bl_region_type = "UI"
    bl_category = "Tools"
    def draw(self, context): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "CLIP_EDITOR"
    bl_region_type = "TOOLS"
    bl_category = ""
    def draw(self, context): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "CLIP_EDITOR"
    bl_region_type = "HEADER"
    bl_category = "Tools"
    def draw(self, context): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "SEQUENCE_EDITOR"
    bl_region_type = "HEADER"
    bl_category = "Tools"
    def draw(self, context): pass

class MixinX:
    bl_space_type = "VIEW_3D"
    bl_region_type = "TOOLS"
    bl_label = "label"
    def draw(self, context): pass
class X(MixinX, Panel):
    bl_category = "Tools"

class MixinX:
    bl_space_type = "VIEW_3D"
    bl_region_type = "TOOLS"
    bl_category = "Tools"
    bl_label = "label"
    def draw(self, context): pass
class X(MixinX, Panel):
    bl_region_type = "UI"

class X(Menu):
    bl_label = "label"

class X(Menu):
    bl_label = "label"
    draw = Menu.draw_preset

class X(Menu):
    def draw(self, context): pass

class X(Header):
    def draw(self, context): pass

class X(Header):
    bl_space_type = "VIEW_3D"

class X(Header):
    bl_space_type = "VIEW_3D"
    def draw(self, context): pass

class X(UIList):
    pass

class X(RenderEngine):
    bl_idname = "X"

class X(RenderEngine):
    bl_label = "label"

class X(NodeTree):
    bl_label = "label"

class X(NodeTree):
    bl_label = "label"
    bl_icon = "NODETREE"

class X(NodeTree):
    bl_icon = "NODETREE"

class X(Node):
    pass

class X(Node):
    bl_label = "label"

class X(NodeSocket):
    bl_label = "label"

class X(NodeSocket):
    def draw(self, context, layout, node, text): pass

class X(GizmoGroup):
    bl_label = "label"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"

class X(GizmoGroup):
    bl_label = "label"
    bl_region_type = "WINDOW"
    def setup(self, context): pass

class X(GizmoGroup):
    bl_label = "label"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    def setup(self, context): pass

class X(FileHandler):
    bl_label = "label"

class X(FileHandler):
    bl_label = "label"
    bl_file_extensions = ".test"

class X(AddonPreferences):
    pass

class X(PropertyGroup):
    pass
"""

_LACKING = 'import bpy\nclass Grow(bpy.types.Operator):\n    bl_idname = "test.grow"\n'


def test_what_blender_demands_is_reported_and_nothing_else(check: Check, tmp_path: Path) -> None:
    parts = parts_of(_CLASSES)
    refused = refused_parts(tmp_path, parts)
    assert found_parts(check, "incomplete-class", parts) == refused
    assert 10 < len(refused) < len(parts)


@pytest.mark.parametrize(
    "behind",
    [
        "bpy.utils.register_class(Grow)",
        "classes = (Grow,)\nfor cls in classes:\n    bpy.utils.register_class(cls)",
        "classes = [Grow]\nregister, unregister = bpy.utils.register_classes_factory(classes)",
        "for cls in (Grow,):\n    bpy.utils.register_class(cls)",
    ],
)
def test_a_class_counts_as_registered_out_of_a_list_too(check: Check, behind: str) -> None:
    assert [finding.span.line for finding in check("incomplete-class", f"{_LACKING}\n{behind}\n")] == [2]


@pytest.mark.parametrize(
    "behind",
    [
        "",
        "bases = (Grow,)\nbpy.utils.register_class(other)",
        'Grow.bl_label = "Grow"\nbpy.utils.register_class(Grow)',
        'setattr(Grow, "bl_" + "label", "Grow")\nbpy.utils.register_class(Grow)',
        'class Full(Grow):\n    bl_label = "Full"\nbpy.utils.register_class(Full)',
    ],
)
def test_what_may_be_complete_when_it_is_registered_is_left_alone(check: Check, behind: str) -> None:
    assert not check("incomplete-class", f"{_LACKING}\n{behind}\n")
