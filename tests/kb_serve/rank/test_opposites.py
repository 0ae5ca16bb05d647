"""Who imports is not told of exporters first."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.rank.opposites import opposites_last
from kb_serve.rank.ranked_id import RankedId

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

EXPORTER, IMPORTER = "bpy.ops.export_scene.fbx", "bpy.ops.import_scene.fbx"


@pytest.mark.parametrize(
    ("question", "order"),
    [
        ("importing an fbx", [IMPORTER, EXPORTER]),
        ("export fbx", [EXPORTER, IMPORTER]),
        ("import what was exported", [EXPORTER, IMPORTER]),
        ("fbx", [EXPORTER, IMPORTER]),
    ],
)
def test_what_does_the_opposite_comes_last(question: str, order: list[str]) -> None:
    found = [RankedId(path, 0.8, "found") for path in (EXPORTER, IMPORTER)]
    assert [row.id for row in opposites_last(found, question)] == order


def test_what_was_named_stays() -> None:
    rows = [RankedId(EXPORTER, 1.0, "exact"), RankedId(IMPORTER, 0.8, "found")]
    assert opposites_last(rows, "import") == rows


def test_a_setting_of_both_is_told_of_the_one_that_is_asked_for(kb: KnowledgeBase) -> None:
    assert kb.query("fbx import axis forward").hits[0].id in {IMPORTER, "bpy.ops.wm.fbx_import"}
    assert kb.query("fbx export axis forward").hits[0].id == EXPORTER
