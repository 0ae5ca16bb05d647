"""What code begins with is not searched as a word where it tells nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.chains.variables import is_short_form

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    "query", ["obj.make_local()", "obj.parent_vertices", "obj.parent_bone = 'Bone'", "obj.location"]
)
def test_a_variable_is_not_the_file_format_of_its_name(query: str, kb: KnowledgeBase) -> None:
    assert [hit.id for hit in kb.query(query).hits if "obj" in hit.id.rpartition(".")[2].split("_")] == []


def test_a_function_of_pythons_is_no_word(kb: KnowledgeBase) -> None:
    assert [hit.id for hit in kb.query("len(image.pixels)").hits if "camera" in hit.id] == []


def test_a_question_about_the_format_is_searched_whole(kb: KnowledgeBase) -> None:
    assert kb.query("export selected as obj").hits[0].id == "bpy.ops.wm.obj_export"


@pytest.mark.parametrize(
    ("name", "is_short"),
    [
        ("obj", True),
        ("mat", True),
        ("cam", True),
        ("light", False),
        ("sun", False),
        ("view_layer", False),
        ("x", False),
    ],
)
def test_a_short_form_has_no_word_of_its_class(name: str, *, is_short: bool) -> None:
    assert is_short_form(name) is is_short
