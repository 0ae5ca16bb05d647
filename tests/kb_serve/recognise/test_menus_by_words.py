"""The menu or the header of Blender's that somebody wants to extend."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("question", "extended"),
    [
        ("add menu entry to View3D add menu", "VIEW3D_MT_add"),
        ("add an item to the object context menu", "VIEW3D_MT_object_context_menu"),
        ("add entry to File export menu", "TOPBAR_MT_file_export"),
        ("append a button to the 3D viewport header", "VIEW3D_HT_header"),
        ("extend the node editor add menu", "NODE_MT_add"),
        ("put my operator in the mesh add menu", "VIEW3D_MT_mesh_add"),
    ],
)
def test_the_class_of_the_menu_is_told(kb: KnowledgeBase, question: str, extended: str) -> None:
    answer = kb.query(question)
    assert answer.hits[0].id == f"bpy.types.{'Header' if '_HT_' in extended else 'Menu'}.append"
    assert any(f"`bpy.types.{extended}.append(draw)`" in note for note in answer.notes)


@pytest.mark.parametrize(
    "question",
    [
        "add operator to right click menu",  # of which editor nobody says
        "add a submenu",
        "how do I make a header in the text editor bold",
        "menu of recent files",
        "remove an entry from the object context menu",
        "menu switch node add enum items",
        "add an item to a menu socket of a node group",
    ],
)
def test_where_it_is_not_sure_which_none_is_told(kb: KnowledgeBase, question: str) -> None:
    assert not any(".append(draw)" in note for note in kb.query(question).notes)


def test_the_value_that_a_script_sets_comes_before_the_buttons_of_an_editor(kb: KnowledgeBase) -> None:
    hits = [hit.id for hit in kb.query("set the interpolation of all keyframes of an action to LINEAR").hits]
    assert hits[0] == "bpy.types.Keyframe.interpolation"
    assert "bpy.ops.action.interpolation_type" in hits
