"""What the data of another type of object has by a name that an object's data lacks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

T = "bpy.types."


@pytest.mark.parametrize(
    ("query", "first", "test"),
    [
        ("AttributeError: 'Camera' object has no attribute 'vertices'", "Mesh.vertices", "obj.type == 'MESH'"),
        ("cam.data.vertices", "Mesh.vertices", "obj.type == 'MESH'"),
        ("AttributeError: 'Mesh' object has no attribute 'edit_bones'", "Armature.edit_bones", "== 'ARMATURE'"),
        ("AttributeError: 'Camera' object has no attribute 'shape_keys'", "Mesh.shape_keys", "obj.type in ('MESH', "),
    ],
)  # fmt: skip
def test_what_another_type_has_is_told_with_the_test(
    kb: KnowledgeBase, query: str, first: str, test: str
) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == T + first
    assert [note for note in answer.notes if test in note]
    assert not [note for note in answer.notes if "Closest" in note]


@pytest.mark.parametrize(
    ("query", "first"),
    [
        # What its own data has for it, by other words or some of the same.
        ("AttributeError: 'PointLight' object has no attribute 'intensity'", "PointLight.energy"),
        ("AttributeError: 'Camera' object has no attribute 'focal_length'", "Camera.lens"),
        ("AttributeError: 'Mesh' object has no attribute 'layers'", "Mesh.uv_layers"),
        ("AttributeError: 'SpotLight' object has no attribute 'angle'", "SpotLight.spot_size"),
        # The object itself.
        ("AttributeError: 'Camera' object has no attribute 'color'", "Object.color"),
    ],
)
def test_what_the_very_data_has_comes_first(kb: KnowledgeBase, query: str, first: str) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == T + first
    assert not [note for note in answer.notes if "Objects of another type" in note]
