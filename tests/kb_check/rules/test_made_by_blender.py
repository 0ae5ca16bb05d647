"""Instances of Blender's classes that scripts try to make, and classes that are given otherwise than as classes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_START = """\
import bpy
class Grow(bpy.types.Operator):
    bl_idname, bl_label = 'wm.grow', 'Grow'
class Settings(bpy.types.PropertyGroup):
    level: bpy.props.IntProperty()
class Plain:
    pass
class Made(bpy.types.PropertyGroup):
    def __new__(cls):
        return None
"""
_LINES = [
    "bpy.utils.register_class(Grow())",
    "bpy.utils.register_class('Grow')",
    "bpy.utils.register_class([Grow, Settings])",
    "bpy.utils.register_class(Grow)",
    "for cls in (Settings,): bpy.utils.register_class(cls())",
    "for cls in (Settings,): bpy.utils.register_class(cls)",
    "bpy.utils.unregister_class(Grow())",
    "bpy.utils.unregister_class('Grow')",
    "settings = Settings()",
    "settings = Settings(level=3)",
    "ob = bpy.types.Object()",
    "ob = bpy.types.Object('Name')",
    "ob = bpy.types.Object(bpy.data.objects[0])",
    "plain = Plain()",
    "bpy.utils.register_class(Plain)",
    "for cls in (Plain,): bpy.utils.register_class(cls)",
    "made = Made()",
    "bpy.utils.unregister_class(Grow)",
]


def test_classes_are_given_and_not_called(rule_checker: Checker, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [_START, *_LINES])
    refused = [line for line, (error, *_) in zip(_LINES, answers[1:], strict=True) if error]
    assert len(refused) > 8
    above = len(_START.splitlines())
    code = "\n".join([*_START.splitlines(), *_LINES])
    found = rule_checker.check(code, rules=["refused-call", "wrong-type"])
    assert [_LINES[finding.span.line - 1 - above] for finding in found] == refused
    fixed = [edit.text for finding in found if finding.fix for edit in finding.fix.edits]
    assert fixed == [""] * 3  # the brackets go
