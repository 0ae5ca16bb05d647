"""Classes of a script's own: what is said of them is what Blender wants when they are registered."""

from __future__ import annotations

import re
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

_REGISTER = """\
import bpy
class MyPanel(bpy.types.Panel):
    bl_label, bl_space_type, bl_region_type = "x", "VIEW_3D", "UI"
    def draw(self, context): ...
class MyTree(bpy.types.NodeTree):
    bl_label, bl_icon = "x", "NODETREE"
class MyOperator(bpy.types.Operator):
    bl_idname, bl_label = "object.my_operator", "x"
    @classmethod
    def poll(cls, context): ...
    def execute(self, context): return {given}
for cls in (MyPanel, MyTree, MyOperator):
    bpy.utils.register_class(cls)
MyOperator.poll = classmethod(lambda cls, context: True)
print(bpy.ops.object.my_operator())
"""


@pytest.mark.parametrize(
    ("cls", "names"),
    [
        ("Panel", "`draw`, `bl_label`, `bl_space_type`, `bl_region_type`"), ("NodeTree", "`bl_label`, `bl_icon`"),
        ("Operator", "`bl_label`"), ("Menu", "`draw`, `bl_label`"),
    ],
)  # fmt: skip
def test_what_a_class_must_have_is_told(kb: KnowledgeBase, cls: str, names: str) -> None:
    assert f"A class of your own must have {names}: Blender does not register it" in kb.query(cls).text


def test_a_function_that_blender_calls_names_what_its_class_must_have(kb: KnowledgeBase) -> None:
    assert (
        "Such a class must have `bl_label`, `bl_space_type`, `bl_region_type`:" in kb.query("Panel.draw").text
    )
    assert (
        "Such a class must have `bl_label`, `bl_file_extensions`:" in kb.query("FileHandler.poll_drop").text
    )
    assert "must have" not in kb.query("Operator.report").text


def test_what_is_told_is_enough_for_blender() -> None:
    def run(given: str) -> subprocess.CompletedProcess[str]:
        code = _REGISTER.replace("{given}", given)
        return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)

    assert "{'FINISHED'}" in run("{'FINISHED'}").stdout
    assert "expected a set" in run("None").stderr


def test_a_function_that_blender_calls_is_shown_as_its_definition(kb: KnowledgeBase) -> None:
    text = kb.query("Operator.poll").text
    assert re.search(r"@classmethod\n\s+def poll\(cls, context\):", text)
    assert "static" not in text
    assert "default" not in text
    assert "has to define it" in kb.query("Panel.draw").text


def test_what_takes_sets_says_so(kb: KnowledgeBase) -> None:
    assert "- `type` (set[enum], required)" in kb.query("Operator.report").text
    assert "- `result` (set[enum], required)" in kb.query("Operator.execute").text


@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("PointerProperty", "bpy.props.PointerProperty(*, type, "),
        ("EnumProperty", "bpy.props.EnumProperty(*, items, "),
        ("RemoveProperty", "bpy.props.RemoveProperty(cls, *, attr)"),
        ("SpaceView3D.draw_handler_add", "draw_handler_add(callback, args, region_type, draw_type, /)"),
    ],
)
def test_how_arguments_are_given_was_asked(kb: KnowledgeBase, name: str, call: str) -> None:
    assert call in kb.query(name).text
