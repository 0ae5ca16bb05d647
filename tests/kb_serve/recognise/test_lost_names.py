"""Names of other versions that stand beside one another without their owners."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("query", "gone"),
    [
        ("use_auto_smooth, calc_normals_split", ["Mesh.use_auto_smooth", "Mesh.calc_normals_split"]),
        ("use_gtao use_bloom use_ssr", ["SceneEEVEE.use_gtao", "SceneEEVEE.use_bloom", "SceneEEVEE.use_ssr"]),
        ("ShaderNodeTexMusgrave and use_bloom", ["ShaderNodeTexMusgrave", "SceneEEVEE.use_bloom"]),
        ("use_bloom, export_mesh.stl", ["SceneEEVEE.use_bloom", "bpy.ops.export_mesh.stl"]),
    ],
)
def test_each_is_dated(kb: KnowledgeBase, query: str, gone: list[str]) -> None:
    notes = [note for note in kb.query(query).notes if "removed in" in note]
    assert [any(f"{path}` does not exist" in note for note in notes) for path in gone] == [True] * len(gone)
    assert not any("Nothing is called" in note for note in kb.query(query).notes)


def test_names_that_this_blender_has_are_not_lost(kb: KnowledgeBase) -> None:
    assert not any("does not exist" in note for note in kb.query("hide_render, hide_viewport").notes)
