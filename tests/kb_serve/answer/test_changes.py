"""What a version changed, for who asks for it as a whole."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("question", "version"),
    [
        ("what's new in the 5.1 Python API", "5.1"),
        ("breaking changes in Blender 5.0", "5.0"),
        ("what changed between 4.5 and 5.0", "5.0"),
        ("removed in 4.5", "4.5"),
    ],
)
def test_the_names_that_went_and_came_are_listed(kb: KnowledgeBase, question: str, version: str) -> None:
    text = kb.query(question).text
    assert f"**Gone in Blender {version}**" in text
    assert f"**New in Blender {version}**" in text
    assert f"simworlds migrate PATH --to {version}" in text


def test_what_went_has_what_takes_its_place(kb: KnowledgeBase) -> None:
    answer = kb.query("what changed in 5.0")
    assert "`Scene.node_tree` → `Scene.compositing_node_group`" in answer.text
    assert "bpy.types.Scene.compositing_node_group" in [hit.id for hit in answer.hits]


def test_what_came_is_told_by_its_whole_name(kb: KnowledgeBase) -> None:
    assert "`Strip.content_start` float" in kb.query("new in 5.1").text


@pytest.mark.parametrize(
    "question",
    ["new material in 5.1", "cloth changes in 5.0", "new in 9.9", "5.1", "what changed", "4.2 5.0"],
)
def test_other_questions_are_none_about_a_version(kb: KnowledgeBase, question: str) -> None:
    assert "**Gone in Blender" not in kb.query(question).text
