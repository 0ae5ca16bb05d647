"""What a class has instead of a name that it lacks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.by_words.operator_words import OperatorWords
from kb_serve.recognise.by_words.said_otherwise import labelled, operators_on

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

TYPES = "bpy.types."


@pytest.mark.parametrize(
    ("owner", "name", "found"),
    [
        ("TextCurve", "text", ["TextCurve.body"]),
        ("Camera", "focal_length", ["Camera.lens"]),
        ("Light", "power", ["PointLight.energy", "SpotLight.energy", "AreaLight.energy"]),
        ("Object", "nothing_such", []),
    ],
)
def test_a_member_is_found_by_what_its_button_says(
    owner: str, name: str, found: list[str], reader: BaseReader
) -> None:
    assert labelled(TYPES + owner, name, reader) == [TYPES + path for path in found]


def test_operators_of_the_class_do_what_it_lacks_a_function_for(reader: BaseReader) -> None:
    operators = OperatorWords(reader)
    baking = operators_on("bpy.types.PointCache", "bake", operators, reader)
    assert baking[:2] == ["bpy.ops.ptcache.bake_all", "bpy.ops.ptcache.bake"]  # the second needs an override
    assert operators_on("bpy.types.Object", "duplicate", operators, reader)[0] == "bpy.ops.object.duplicate"
    assert operators_on("bpy.types.PointCache", "unwrap", operators, reader) == []


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("scene.rigidbody_world.point_cache.bake()", "bpy.ops.ptcache.bake_all"),
        ("obj.duplicate()", "bpy.ops.object.duplicate"),
        ("light.power = 100", "bpy.types.PointLight.energy"),
        ("TextCurve.text", "bpy.types.TextCurve.body"),
        ("mat.color", "bpy.types.Material.diffuse_color"),
    ],
)
def test_it_opens_the_answer_and_is_named_above_it(kb: KnowledgeBase, query: str, first: str) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == first
    assert f"Closest: `{first}`" in answer.notes[0]


def test_an_assigned_name_is_no_operator(kb: KnowledgeBase) -> None:
    assert not any(hit.id == "bpy.ops.object.duplicate" for hit in kb.query("obj.duplicate = 1").hits[:1])
