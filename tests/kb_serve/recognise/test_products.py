"""Products that need ``@``, in code and in the message that ``*`` gives."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.code.products import WITH_AT

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("query", "right"),
    [
        ("obj.matrix_world * Vector((1, 2, 3))", "obj.matrix_world @ Vector((1, 2, 3))"),
        ("mat * vec", "mat @ vec"),
        ("rot = quat1 * quat2", "quat1 @ quat2"),
        ("co = ob.matrix_world * v.co", "ob.matrix_world @ v.co"),
    ],
)
def test_a_product_is_written_with_at(kb: KnowledgeBase, query: str, right: str) -> None:
    answer = kb.query(query)
    assert f"Write `{right}`." in answer.notes
    assert WITH_AT in answer.text


def test_the_message_of_a_wrong_product_leads_to_the_right_one(kb: KnowledgeBase) -> None:
    message = "TypeError: Element-wise multiplication: not supported between 'Matrix' and 'Vector' types"
    answer = kb.query(message)
    assert answer.notes[0] == WITH_AT
    assert answer.hits[0].id == "mathutils.Matrix"


@pytest.mark.parametrize("query", ["vec * 2.0", "a * b", "obj.location * scale", "obj.scale * 3"])
def test_other_products_are_left_alone(kb: KnowledgeBase, query: str) -> None:
    assert not [note for note in kb.query(query).notes if "@" in note]


@pytest.mark.parametrize(
    "message",
    [
        "TypeError: mathutils.Vector(): sequence index 2 expected a number, found 'str' type, ",
        "TypeError: mathutils.Quaternion(): angle must be a real number, not 'tuple'",
        "TypeError: 'Vector' object is not callable",
        "ValueError: matrix * vector: len(matrix.col) and len(vector) must be the same, except for 4x4 matrix * 3D "
        "vector.",
    ],
)
def test_other_messages_of_the_classes_are_not_answered_with_the_product(
    kb: KnowledgeBase, message: str
) -> None:
    assert WITH_AT not in kb.query(message).text


@pytest.mark.parametrize("query", ["mathutils.Vector", "multiply a matrix with a vector"])
def test_who_asks_of_the_class_or_of_products_is_told(kb: KnowledgeBase, query: str) -> None:
    assert WITH_AT in kb.query(query).notes
