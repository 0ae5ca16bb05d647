"""What is said to be meant by a name that a class lacks is there, in this environment's Blender."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy
import pytest

from kb_serve.recognise.elsewhere.meant_elsewhere import MEANT_ELSEWHERE

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

T = "bpy.types."


@pytest.mark.parametrize("lacked", sorted(MEANT_ELSEWHERE))
def test_the_answer_says_what_is_meant(kb: KnowledgeBase, lacked: str) -> None:
    owner, _, name = lacked.removeprefix(T).rpartition(".")
    assert kb.symbol(lacked) is None
    found = MEANT_ELSEWHERE[lacked]
    answer = kb.query(f"AttributeError: '{owner}' object has no attribute '{name}'")
    assert any(found.how in note for note in answer.notes)
    if not any("new in" in note for note in answer.notes):  # what a later Blender has, no other place has
        assert found.path in {hit.id for hit in answer.hits[:2]}  # the class is named first by some messages


@pytest.mark.blender
def test_the_ways_lead_there() -> None:
    obj = bpy.data.objects.new("o", None)
    assert obj.keyframe_insert("location", frame=3)
    ad: Any = obj.animation_data
    fcurves = ad.action.layers[0].strips[0].channelbag(ad.action_slot).fcurves
    assert fcurves[0].keyframe_points[0].co[:] == (3, 0)

    collection = bpy.data.collections.new("c")
    scene: Any = bpy.context.scene
    scene.collection.children.link(collection)
    view_layer: Any = bpy.context.view_layer
    view_layer.layer_collection.children[collection.name].exclude = True
    assert view_layer.layer_collection.children[collection.name].exclude

    grease_pencil: Any = bpy.data.grease_pencils.new("g")
    grease_pencil.layers.new("l").frames.new(1).drawing.add_strokes([2])
    assert len(grease_pencil.layers[0].frames[0].drawing.strokes[0].points) == 2

    mesh = bpy.data.objects.new("m", bpy.data.meshes.new("m"))
    array: Any = mesh.modifiers.new("a", "ARRAY")
    assert array.use_relative_offset
    assert not array.use_constant_offset
    assert len(array.relative_offset_displace) == len(array.constant_offset_displace) == 3
    assert scene.cycles.samples > 0
    assert scene.eevee.taa_render_samples > 0
