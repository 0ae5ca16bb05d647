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


@pytest.mark.parametrize(
    ("question", "gone", "instead"),
    [
        ("composite node", "CompositorNodeComposite", "NodeGroupOutput"),
        ("velvet bsdf node", "ShaderNodeBsdfVelvet", "ShaderNodeBsdfSheen"),
    ],
)
def test_a_node_that_is_gone_is_known_by_what_people_call_it(
    kb: KnowledgeBase, question: str, gone: str, instead: str
) -> None:
    answer = kb.query(question)
    assert any(note.startswith(f"`bpy.types.{gone}` does not exist") for note in answer.notes)
    assert answer.hits[0].id == f"bpy.types.{instead}"


@pytest.mark.parametrize("question", ["math node", "glossy bsdf node", "geometry nodes modifier input"])
def test_a_node_that_is_there_is_not_lost(kb: KnowledgeBase, question: str) -> None:
    assert not any("does not exist" in note for note in kb.query(question).notes)
