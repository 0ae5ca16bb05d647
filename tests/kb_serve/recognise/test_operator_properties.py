"""What is set on an operator's properties, and is no argument of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("query", "operator", "said"),
    [
        ('layout.operator("mesh.primitive_cube_add").radius = 2', "mesh.primitive_cube_add", "(size=…)"),
        ("layout.operator(\"object.select_all\").mode = 'SELECT'", "object.select_all", "closest: `action`"),
        ('op = layout.operator("wm.call_menu")\nop.menu_name = "A"', "wm.call_menu", "closest: `name`"),
        (
            "AttributeError: 'WM_OT_call_menu' object has no attribute 'menu'",
            "wm.call_menu",
            "It takes `name`.",
        ),
        (
            "AttributeError: 'OBJECT_OT_delete' object has no attribute 'confirmed'",
            "object.delete",
            "`confirm`",
        ),
    ],
)
def test_it_is_answered_as_the_argument_of_a_call(
    kb: KnowledgeBase, query: str, operator: str, said: str
) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == f"bpy.ops.{operator}"
    assert any(said in note for note in answer.notes)
    assert not [note for note in answer.notes if "never had it" in note or "annotation" in note]


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("AttributeError: 'OBJECT_OT_my' object has no attribute 'reports'", "Operator.report"),
        ("AttributeError: 'MyPanel' object has no attribute 'layouts'", "Panel.layout"),
    ],
)
def test_a_member_of_blenders_class_is_meant_by_one_of_the_scripts_own(
    kb: KnowledgeBase, query: str, first: str
) -> None:
    assert kb.query(query).hits[0].id == f"bpy.types.{first}"


def test_what_only_instances_have_is_told_as_such(kb: KnowledgeBase) -> None:
    answer = kb.query("AttributeError: type object 'LayerObjects' has no attribute 'active'")
    assert answer.hits[0].id == "bpy.types.LayerObjects.active"
    assert answer.notes == (
        "Instances of `bpy.types.LayerObjects` have `active`, the class has not. For `bpy.msgbus` the key is a pair: "
        '`(bpy.types.LayerObjects, "active")`.',
    )


def test_an_instance_without_the_makers_init_is_told_apart_from_removed_data(kb: KnowledgeBase) -> None:
    (note,) = kb.query("ReferenceError: StructRNA of type OT2 has been removed").notes
    assert "super().__init__(*args, **kwargs)" in note
    (note,) = kb.query("ReferenceError: StructRNA of type Object has been removed").notes
    assert "look it up again" in note
