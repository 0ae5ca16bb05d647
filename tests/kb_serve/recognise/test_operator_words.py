"""An operator that Blender does not have leads to the one that has its words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.by_words.operator_words import OperatorWords

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

# As models write them → what Blender calls it.
MEANT = {
    "wm.fbx_export": "export_scene.fbx",
    "mesh.add_cube": "mesh.primitive_cube_add",
    "object.add_cube": "mesh.primitive_cube_add",
    "object.add_modifier": "object.modifier_add",
    "object.delete_all": "object.delete",
    "object.set_parent": "object.parent_set",
    "object.rotate": "transform.rotate",
    "object.move": "transform.translate",
    "camera.add": "object.camera_add",
    "material.create": "material.new",
    "scene.create": "scene.new",
    "node.new": "node.add_node",
    "wm.open_file": "wm.open_mainfile",
    "mesh.primitive_sphere_add": "mesh.primitive_uv_sphere_add",
    "purge_orphans": "outliner.orphans_purge",
    "rigidbody.add": "rigidbody.object_add",
    "physics.add_rigid_body": "rigidbody.object_add",
    "physics.bake_all": "ptcache.bake_all",
    "export.gltf": "export_scene.gltf",
    "light.add": "object.light_add",
}


@pytest.mark.parametrize("written", MEANT)
def test_the_operator_with_these_words_comes_first(kb: KnowledgeBase, written: str) -> None:
    assert kb.symbol(f"bpy.ops.{written}") is None
    answer = kb.query(f"bpy.ops.{written}()")
    assert answer.hits[0].id == f"bpy.ops.{MEANT[written]}"
    assert any("has no" in note for note in answer.notes)


def test_of_a_module_that_never_was_nothing_is_told_but_that(kb: KnowledgeBase) -> None:
    answer = kb.query("bpy.ops.nonsense.frobnicate()")
    assert any("`bpy.ops` has no `nonsense`" in note for note in answer.notes)
    assert not any("Closest" in note for note in answer.notes)


def test_of_too_many_that_are_alike_none_is_told(reader: BaseReader) -> None:
    operators = OperatorWords(reader)
    assert len([path for path in operators.beginning("extrude") if path.startswith("bpy.ops.mesh.")]) > 3
    assert operators.having("bpy.ops.mesh", "extrude") == []
    assert operators.having("bpy.types.Object", "delete") == []
    assert operators.having("bpy.ops.object", "frobnicate") == []
