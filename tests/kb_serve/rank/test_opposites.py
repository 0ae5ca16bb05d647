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


@pytest.mark.parametrize(
    ("question", "last"),
    [
        ("quaternion from axis angle", "mathutils.Quaternion.to_axis_angle"),
        ("axis angle to quaternion", "mathutils.Quaternion.to_axis_angle"),
        ("matrix from euler", "mathutils.Matrix.to_euler"),
        ("quaternion to axis angle", "mathutils.Quaternion"),
        ("matrix to euler", "mathutils.Quaternion"),
    ],
)
def test_what_converts_the_other_way_comes_last(question: str, last: str) -> None:
    paths = [
        *("mathutils.Quaternion.to_axis_angle", "mathutils.Matrix.to_euler", "bpy.types.Object.to_mesh"),
        "mathutils.Quaternion",
    ]
    ranked = opposites_last([RankedId(path, 0.8, "found") for path in paths], question)
    assert ranked[-1].id == last


def test_what_was_named_stays() -> None:
    rows = [RankedId(EXPORTER, 1.0, "exact"), RankedId(IMPORTER, 0.8, "found")]
    assert opposites_last(rows, "import") == rows


def test_a_setting_of_both_is_told_of_the_one_that_is_asked_for(kb: KnowledgeBase) -> None:
    assert kb.query("fbx import axis forward").hits[0].id in {IMPORTER, "bpy.ops.wm.fbx_import"}
    assert kb.query("fbx export axis forward").hits[0].id == EXPORTER
