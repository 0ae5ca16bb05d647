"""Paths that functions are given to animate what they lead to: of wrong ones it is told what may be meant."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.chains.animated_paths import path_given
from kb_serve.recognise.chains.chains import find_chains

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("code", "dotted"),
    [
        ("obj.keyframe_insert('location', frame=1)", "obj.location"),
        ("obj.data.keyframe_insert(frame=1, data_path='lens')", "obj.data.lens"),
        ("obj.driver_add('location', 0)", "obj.location"),
        ("obj.keyframe_delete(path)", None),
        ("obj.keyframe_insert('[\"prop\"]')", None),
        ("obj.keyframe_insert(f'{name}')", None),
        ("obj.select_set('location')", None),
    ],
)
def test_a_path_is_an_expression_of_the_very_thing(code: str, dotted: str | None) -> None:
    (chain,) = find_chains(code)
    given = path_given(chain)
    assert (given.dotted if given else None) == dotted


@pytest.mark.parametrize(
    "query",
    [
        "obj.keyframe_insert(data_path='rotation')",
        "obj.keyframe_insert('rotation', frame=1)",
        "bpy.context.object.keyframe_insert(data_path='rotation', index=2)",
        "obj.driver_add('rotation', 2)",
    ],
)
def test_a_path_that_leads_nowhere_is_told(query: str, kb: KnowledgeBase) -> None:
    answer = kb.query(query)
    (note,) = answer.notes
    assert note.startswith("`bpy.types.Object` has no `rotation`")
    assert "Closest: `bpy.types.Object.rotation_euler`" in note
    assert answer.hits[0].id.startswith("bpy.types.bpy_struct.")


def test_a_misspelt_path_is_read_as_what_is_meant(kb: KnowledgeBase) -> None:
    answer = kb.query("obj.keyframe_insert('scales')")
    assert answer.notes == ("`scales` does not exist; read as `scale`.",)
    assert answer.hits[1].id == "bpy.types.Object.scale"


def test_a_path_that_another_blender_had_is_told(kb: KnowledgeBase) -> None:
    assert "does not exist" in kb.query("material.keyframe_insert('diffuse_intensity')").notes[0]


@pytest.mark.parametrize(
    "query",
    [
        "obj.keyframe_insert('location', frame=1)",
        "light.keyframe_insert('energy')",
        "obj.keyframe_insert('pose.bones[\"Arm\"].location')",
        "key_block.keyframe_insert('value', frame=1)",
        "node.inputs[0].keyframe_insert('default_value')",
        "x.keyframe_insert('y')",
    ],
)
def test_nothing_is_said_of_right_paths_and_of_what_is_not_known(query: str, kb: KnowledgeBase) -> None:
    assert kb.query(query).notes == ()


@pytest.mark.parametrize(
    "message",
    [
        'TypeError: bpy_struct.keyframe_insert() property "rotation" not found',
        'TypeError: bpy_struct.driver_add(): property "rotation" not found',
    ],
)
def test_the_message_of_such_a_path_names_what_is_close(message: str, kb: KnowledgeBase) -> None:
    answer = kb.query(message)
    assert answer.notes[0].startswith(
        "What is animated has no `rotation`; closest: `bpy.types.Object.rotation_euler`"
    )
    assert answer.hits[1].id == "bpy.types.Object.rotation_euler"
