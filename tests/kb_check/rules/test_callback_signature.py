"""Functions are reported that Blender counts the arguments of and refuses, and no others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from classes_in_blender import found_parts, parts_of, refused_parts

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_OPERATOR = """\
class X(Operator):
    bl_idname = "test._x_"
    bl_label = "label"
"""
_FUNCTIONS = """\
def execute(self): return {"FINISHED"}

def execute(self, context): return {"FINISHED"}

def execute(self, context, event): return {"FINISHED"}

def execute(self, context, event=None): return {"FINISHED"}

def execute(self, context, *args, **kwargs): return {"FINISHED"}

def execute(self, *args): return {"FINISHED"}

def execute(self, context, *, key=1): return {"FINISHED"}

def execute(self, context, /): return {"FINISHED"}

def execute(): return {"FINISHED"}

def invoke(self, context): return {"FINISHED"}

def invoke(self, context, event): return {"FINISHED"}

def modal(self, context): return {"FINISHED"}

def draw(self): pass

def cancel(self): pass

def check(self): pass

def check(self, context): pass

def poll(self, context): return True

def poll(context): return True

@classmethod
def poll(cls, context): return True

@classmethod
def poll(cls): return True

@staticmethod
def poll(context): return True

@classmethod
def description(cls, context): return ""

@classmethod
def description(cls, context, properties): return ""

@classmethod
def execute(cls, context): return {"FINISHED"}

@staticmethod
def execute(context): return {"FINISHED"}

@staticmethod
def execute(self, context): return {"FINISHED"}

def helper(self): pass
"""
_OTHERS = """\
class X(UIList):
    def draw_item(self, a, b, c, d, e): pass

class X(UIList):
    def draw_item(self, a, b, c, d, e, f): pass

class X(UIList):
    def draw_item(self, a, b, c, d, e, f, g, h, i): pass

class X(UIList):
    def draw_item(self, a, b, c, d, e, f, g, h, i, j): pass

class X(UIList):
    def filter_items(self, context): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    def draw(self): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    def draw(self, context): pass
    def draw_header(self): pass

class X(Panel):
    bl_label = "label"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    def draw(self, context): pass
    def draw_header(self, context): pass

class MixinX:
    def draw(self): pass
class X(MixinX, Menu):
    bl_label = "label"

class X(RenderEngine):
    bl_label = "label"
    def update(self): pass

class X(RenderEngine):
    bl_label = "label"
    def render(self, depsgraph): pass
    def tag_redraw(self, one, two): pass

class X(Node):
    bl_label = "label"
    def init(self): pass

class X(Node):
    bl_label = "label"
    def draw_buttons(self, context, layout): pass
    def copy(self, node): pass
    def free(self): pass

class X(NodeSocket):
    def draw(self, context, layout, node): pass
"""

# Base → what makes an instance of a class.
_MADE_BY_BLENDER = {
    "NodeTree": "bpy.data.node_groups.new('X', 'X')",
    "Node": "class TreeX(NodeTree):\n    bl_label = 'tree'\n    bl_icon = 'NODETREE'\n"
    "bpy.utils.register_class(TreeX)\nbpy.data.node_groups.new('X', 'TreeX').nodes.new('X')",
    "PropertyGroup": "bpy.types.Scene.groupX = bpy.props.PointerProperty(type=X)\nbpy.context.scene.groupX.name",
    "AddonPreferences": "addonX = bpy.context.preferences.addons.new()\naddonX.module = 'X'\n"
    "addonX.preferences.bl_idname",
}


def test_what_is_refused_is_reported_and_nothing_else(check: Check, tmp_path: Path) -> None:
    functions = _FUNCTIONS.strip().split("\n\n")
    classes = [_OPERATOR + "    " + function.replace("\n", "\n    ") for function in functions]
    parts = parts_of("\n\n".join([*classes, _OTHERS.strip()]))
    refused = refused_parts(tmp_path, parts)
    assert found_parts(check, "callback-signature", parts) == refused
    assert 20 < len(refused) < len(parts)


def test_an_operator_whose_init_takes_nothing_cannot_run(check: Check, tmp_path: Path) -> None:
    lines = ["self", "self, *args, **kwargs", "self, context", "self, *args"]
    body = '    def execute(self, context): return {"FINISHED"}\n'
    classes = [
        f"{_OPERATOR}    def __init__({line}): super().__init__({line[6:] if '*' in line else ''})\n{body}"
        for line in lines
    ]
    parts = parts_of("\n\n".join(part.strip("\n") for part in classes))
    refused = refused_parts(tmp_path, parts, "bpy.ops.test._x_()")
    found = found_parts(check, "callback-signature", parts)
    assert found <= refused
    assert parts[0] in found
    assert parts[1] not in refused


def test_an_init_that_takes_nothing_makes_no_instance(check: Check, tmp_path: Path) -> None:
    inits = ("(self): pass", "(self, *args, **kwargs): super().__init__(*args, **kwargs)")
    heads = "bl_idname = 'X'", "bl_label = 'label'", "bl_icon = 'NODETREE'"
    classes = [
        "\n    ".join((f"class X({base}):", *heads, f"def __init__{init}"))
        for init in inits
        for base in _MADE_BY_BLENDER
    ]
    making = [*_MADE_BY_BLENDER.values()] * len(inits)
    parts = [
        part + made.replace("X", f"X{place}") + "\n"
        for place, (part, made) in enumerate(zip(parts_of("\n\n".join(classes)), making, strict=True))
    ]
    refused = refused_parts(tmp_path, parts)
    assert found_parts(check, "callback-signature", parts) == refused == {*parts[: len(_MADE_BY_BLENDER)]}


def test_functions_of_unknown_decorators_are_left_alone(check: Check) -> None:
    code = (
        f"import bpy\nfrom bpy.types import Operator\n{_OPERATOR}    @wrapped\n    def execute(self): pass\n"
    )
    assert not check("callback-signature", code)
