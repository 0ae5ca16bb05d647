"""Values of enumerations that are asked for alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    "value", ["N_SPHERE_RADIUS", "GREASE_PENCIL_THICKNESS", "VERTEX_WEIGHT_EDIT", "PASS_THROUGH"]
)
def test_a_value_that_something_takes_or_returns_is_not_denied(kb: KnowledgeBase, value: str) -> None:
    answer = kb.query(value)
    assert not any("Nothing is called" in note for note in answer.notes)
    assert value in answer.text


def test_a_value_that_nothing_takes_is_denied(kb: KnowledgeBase) -> None:
    assert any("Nothing is called" in note for note in kb.query("GREASE_PENCIL_THICKNESSES_OF").notes)
