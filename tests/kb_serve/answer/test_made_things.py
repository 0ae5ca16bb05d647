"""What a function makes with the value that a question asks for."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from kb_serve.answer.ways.made_things import made_with

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

MADE = [
    ("PoseBoneConstraints.new", "type", "'IK'", "KinematicConstraint"),
    ("ObjectModifiers.new", "type", "'CLOTH'", "ClothModifier"),
    ("BlendDataLights.new", "type", "'SUN'", "SunLight"),
    ("BlendDataCurves.new", "type", "'FONT'", "TextCurve"),
]


@pytest.mark.parametrize(("function", "argument", "value", "cls"), MADE)
def test_the_class_is_told_with_its_settings(
    reader: BaseReader, function: str, argument: str, value: str, cls: str
) -> None:
    symbol = reader.symbol(f"bpy.types.{function}")
    assert symbol is not None
    (block,) = made_with(symbol, {argument: frozenset({value})}, reader)
    assert block.text.startswith(f"**Made with `{argument}={value}`**: `bpy.types.{cls}`\n- `")


def test_blender_makes_just_these() -> None:
    code = """
import bpy
bpy.ops.object.armature_add()
made = [
    bpy.context.object.pose.bones[0].constraints.new('IK'),
    bpy.data.objects.new("a", bpy.data.meshes.new("a")).modifiers.new("a", 'CLOTH'),
    bpy.data.lights.new("a", 'SUN'),
    bpy.data.curves.new("a", 'FONT'),
]
print(*(type(one).__name__ for one in made))
"""
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=True
    )
    assert found.stdout.splitlines()[-1].split() == [cls for *_, cls in MADE]


def test_the_answer_names_the_chain_of_an_ik_constraint_and_one_value_of_many(kb: KnowledgeBase) -> None:
    text = kb.query("add an IK constraint to a pose bone").text
    assert "- `chain_count` int" in text
    assert "- `'IK'` Inverse Kinematics" in text
    assert "- `'TRACK_TO'`" not in text
    text = kb.query("make keyframes linear").text
    assert text.index("- `'LINEAR'` Linear") < text.index("- others: `'CONSTANT'`")


def test_an_argument_is_told_once(kb: KnowledgeBase) -> None:
    text = kb.query("how to bevel edges with bmesh").text
    assert text.count("- `affect` (") == 1
    assert text.index("**Asked for**") < text.index("**Other parameters**")
