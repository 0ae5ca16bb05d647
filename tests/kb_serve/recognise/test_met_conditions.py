"""Where a value is taken is told only where the code does not meet it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

_TAKEN = ("is taken", "is not taken")


@pytest.mark.parametrize(
    "code",
    [
        "c = nt.nodes.new('FunctionNodeCompare')\nc.data_type = 'INT'\nc.operation = 'GREATER_THAN'",
        "ng = bpy.data.node_groups.new('g', 'GeometryNodeTree')\n"
        "m = ng.nodes.new('GeometryNodeMenuSwitch')\nm.data_type = 'GEOMETRY'",
        "scene.view_settings.view_transform = 'AgX'\nscene.view_settings.look = 'AgX - High Contrast'",
        "scene.view_settings.look = 'AgX - High Contrast'",  # as it is in a new scene
        "scene.render.image_settings.media_type = 'VIDEO'\nscene.render.image_settings.file_format = 'FFMPEG'",
    ],
)
def test_nothing_is_told_of_what_the_code_sets(kb: KnowledgeBase, code: str) -> None:
    assert not [note for note in kb.query(code).notes if any(words in note for words in _TAKEN)]


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("scene.render.image_settings.file_format = 'FFMPEG'", "only with media_type='VIDEO'"),
        (
            "c = nt.nodes.new('FunctionNodeCompare')\nc.data_type = 'RGBA'\nc.operation = 'GREATER_THAN'",
            "not taken with data_type='RGBA'|'STRING'",
        ),
        ("obj.parent_type = 'BONE'", "only by a child of armature object"),
        (
            "node = tree.nodes.new('CompositorNodeOutputFile')\nnode.format.media_type = 'VIDEO'",
            "not taken by a CompositorNodeOutputFile",
        ),
    ],
)
def test_what_the_code_leaves_open_is_told(kb: KnowledgeBase, code: str, said: str) -> None:
    assert any(said in note for note in kb.query(code).notes)
