"""Declarations of properties are reported that Blender refuses, and no others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_START = """\
import bpy
from bpy.props import *
Scene = bpy.types.Scene
def one(self): pass
def two(self, context): pass
def three(self, context, text): return []
def items(self, context): return []
class Plain: pass
class Plainer(Plain): pass
"""
_CALLS = """\
IntProperty(default=1)
IntProperty(default=1.5)
IntProperty(default=True)
IntProperty(default=None)
IntProperty(name=None)
IntProperty(min=0.5)
IntProperty(step=0.5)
IntProperty(min=0, max=5, default=9)
IntProperty(min=5, max=1)
IntProperty("name")
IntProperty(update=one)
IntProperty(update=two)
IntProperty(update=None)
IntProperty(update="two")
IntProperty(update=lambda self: None)
IntProperty(update=lambda self, context: None)
IntProperty(update=lambda self, context, key=1: None)
IntProperty(update=lambda *args: None)
IntProperty(update=lambda self, context, *args: None)
IntProperty(get=lambda self: 1)
IntProperty(get=lambda self, context: 1)
IntProperty(get=lambda self: 1, set=lambda self: None)
IntProperty(get=lambda self: 1, set=lambda self, value: None)
IntProperty(get_transform=lambda self, value, is_set: 1)
IntProperty(get_transform=lambda self, value: 1)
IntProperty(set_transform=lambda self, new, old, is_set: 1)
IntProperty(set_transform=lambda self, new: 1)
IntProperty(options={"HIDDEN"})
IntProperty(options="HIDDEN")
IntProperty(options=["HIDDEN"])
IntProperty(options=set())
IntProperty(options=None)
FloatProperty(default=1)
FloatProperty(default=None)
FloatProperty(precision=2)
FloatProperty(precision=2.0)
FloatProperty(step=0.1)
FloatProperty(min=0, max=1, default=2)
BoolProperty(default=1)
BoolProperty(default=2)
BoolProperty(default=0.0)
BoolProperty(default="on")
BoolProperty(default=None)
StringProperty(default="text")
StringProperty(default=None)
StringProperty(maxlen=2, default="abcdef")
StringProperty(maxlen=2.0)
StringProperty(search=two)
StringProperty(search=three)
StringProperty(search=None)
EnumProperty()
EnumProperty(items=[("A", "First", "")])
EnumProperty(items=[("A", "First")])
EnumProperty(items=[("A", "First", "", 1)])
EnumProperty(items=[("A", "First", "", True)])
EnumProperty(items=[("A", "First", "", "MESH_CUBE", 1)])
EnumProperty(items=[("A", "First", "", "MESH_CUBE")])
EnumProperty(items=[("A", "First", "", 3, 1)])
EnumProperty(items=[("A", "First", "", 1, "MESH_CUBE")])
EnumProperty(items=[("A", "First", None)])
EnumProperty(items=[("A", 1, "")])
EnumProperty(items=[["A", "First", ""]])
EnumProperty(items=["A", "B"])
EnumProperty(items=[None, ("A", "First", "")])
EnumProperty(items=[("", "Heading", ""), ("A", "First", "")])
EnumProperty(items=(("A", "First", ""),), default="A")
EnumProperty(items=(("A", "First", ""),), default="B")
EnumProperty(items=(("A", "First", ""),), default=None)
EnumProperty(items=[], default="A")
EnumProperty(items=[("A", "First", "")], default={"A"})
EnumProperty(items=[("A", "First", "")], options={"ENUM_FLAG"}, default={"A"})
EnumProperty(items=[("A", "First", "")], options={"ENUM_FLAG"}, default=set())
EnumProperty(items=[("A", "First", "")], options={"ENUM_FLAG"}, default={"B"})
EnumProperty(items=[("A", "First", "")], options={"ENUM_FLAG"}, default="A")
EnumProperty(items=items)
EnumProperty(items=items, default=0)
EnumProperty(items=items, default="A")
EnumProperty(items=one)
EnumProperty(items=lambda self, context: [], default=None)
PointerProperty()
PointerProperty(type=bpy.types.Object)
PointerProperty(type=bpy.types.ID)
PointerProperty(type=bpy.types.PropertyGroup)
PointerProperty(type=bpy.types.Node)
PointerProperty(type=bpy.types.Bone)
PointerProperty(type=bpy.types.Object, poll=lambda self, object: True)
PointerProperty(type=bpy.types.Object, poll=lambda self: True)
PointerProperty(type=bpy.types.Object, poll=None)
PointerProperty(type="Object")
CollectionProperty()
CollectionProperty(type=bpy.types.PropertyGroup)
CollectionProperty(type=bpy.types.OperatorFileListElement)
CollectionProperty(type=bpy.types.Object)
CollectionProperty(type="Object")
FloatVectorProperty()
FloatVectorProperty(default=(1, 1, 1))
FloatVectorProperty(default=(1, 1, 1, 1))
FloatVectorProperty(default=[1, 1])
FloatVectorProperty(default=1.0)
FloatVectorProperty(size=4)
FloatVectorProperty(size=4, default=(1, 1, 1, 1))
FloatVectorProperty(size=4, default=(1, 1, 1))
FloatVectorProperty(size=1, default=(1,))
FloatVectorProperty(size=0)
FloatVectorProperty(size=32)
FloatVectorProperty(size=33)
FloatVectorProperty(size=3.0)
FloatVectorProperty(size=(2, 2))
FloatVectorProperty(size=(2, 2), default=((1, 1), (1, 1)))
FloatVectorProperty(subtype="COLOR", size=4, default=(1, 1, 1))
FloatVectorProperty(subtype="XYZ", default="abc")
FloatVectorProperty(min=0, max=1, default=(2, 2, 2))
BoolVectorProperty(size=2, default=(True, False))
BoolVectorProperty(size=3, default=(True, False))
IntVectorProperty(size=2, default=(1, 2))
IntVectorProperty(min=0.5)
PointerProperty(type=Plain)
CollectionProperty(type=Plainer)
"""
# What is a warning: Blender takes it.
_TAKEN = 3


def test_what_is_refused_is_reported_and_nothing_else(check: Check, tmp_path: Path) -> None:
    calls = [f"Scene.test_{place} = {call}" for place, call in enumerate(_CALLS.splitlines())]
    answers = run_statements(tmp_path, [_START, *calls])
    refused = {call for call, (error, _, _) in zip(calls, answers[1:], strict=True) if error}
    found = check("refused-property", _START + "\n".join(calls))
    first = len(_START.splitlines()) + 1
    errors = {calls[finding.span.line - first] for finding in found if finding.severity == "error"}
    assert errors == refused
    assert sum(finding.severity == "warning" for finding in found) == _TAKEN


def test_names_that_a_class_has_itself_are_refused(
    rule_checker: Checker, check: Check, tmp_path: Path
) -> None:
    api = rule_checker.api
    names = {
        cls: [*api.own(cls)]
        for cls in (
            "bpy.types.Object",
            "bpy.types.Scene",
            "bpy.types.Mesh",
            "bpy.types.ID",
            "bpy.types.Modifier",
        )
    }
    lines = ["import bpy"]
    lines += [f"{cls}.{name} = bpy.props.IntProperty()" for cls, own in names.items() for name in own]
    lines += ["bpy.types.Mesh.tag = bpy.props.IntProperty()", "bpy.types.Mesh.mine = bpy.props.IntProperty()"]
    answers = run_statements(tmp_path, lines)
    refused = [line for line, (error, *_) in zip(lines, answers, strict=True) if error]
    assert [lines[one.span.line - 1] for one in check("refused-property", "\n".join(lines))] == refused
    assert len(refused) > 100


@pytest.mark.parametrize("kind", ["int", "str"])
@pytest.mark.parametrize("name", ["PointerProperty", "CollectionProperty"])
def test_classes_of_python_that_end_blender_are_found(check: Check, name: str, kind: str) -> None:
    assert len(check("refused-property", f"import bpy\nx = bpy.props.{name}(type={kind})\n")) == 1


@pytest.mark.parametrize(
    "call",
    [
        "IntProperty(update=other)",
        "EnumProperty(items=choices, default='A')",
        "PointerProperty(type=Group)",
        "CollectionProperty(type=Group)",
        "IntProperty(**options)",
        "EnumProperty(items=[(one, two, ''), *more], default='A')",
    ],
)
def test_what_is_computed_is_left_alone(check: Check, call: str) -> None:
    start = "import bpy\nfrom other import other, choices, options, one, two, more\n"
    code = f"{start}class Group(bpy.types.PropertyGroup):\n    pass\nx = bpy.props.{call}\n"
    assert not check("refused-property", code)


def test_a_class_that_went_is_told_of_by_its_own_rule(check: Check) -> None:
    code = "import bpy\nx = bpy.props.CollectionProperty(type=bpy.types.AssetHandle)\n"
    assert not check("refused-property", code)
    assert len(check("unknown-name", code)) == 1
