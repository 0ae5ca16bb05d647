"""Names that stand without their owners: of several the one that is likeliest meant comes first."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("new_effect() missing seq1 seq2", "bpy.types.StripsTopLevel.new_effect"),  # which scripts use
        ("new_scene strip camera", "bpy.types.StripsTopLevel.new_scene"),  # as much used, and nearer
        ("bl_options = {'REGISTER', 'UNDO'}", "bpy.types.Operator.bl_options"),  # by its values
        ("self.report({'INFO'}, 'x')", "bpy.types.Operator.report"),
    ],
)
def test_the_one_that_scripts_use_comes_first(query: str, first: str, kb: KnowledgeBase) -> None:
    assert kb.query(query).hits[0].id == first


def test_words_around_a_name_tell_more_than_use(kb: KnowledgeBase) -> None:
    assert kb.query("new_effect of a meta strip").hits[0].id == "bpy.types.StripsMeta.new_effect"


@pytest.mark.parametrize(
    "query",
    [
        "layout.operator('my.op', text='x', icon='PLAY').prop = 3",
        "row.operator('object.my_operator').filepath = 'x'",
        "self.layout.operator('my.op').prop",
    ],
)
def test_what_an_operator_of_the_script_has_is_its_own(query: str, kb: KnowledgeBase) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == "bpy.types.UILayout.operator"
    assert "the operator's own class defines" in answer.notes[0]


def test_what_an_operator_of_blenders_lacks_is_told(kb: KnowledgeBase) -> None:
    (note,) = kb.query("layout.operator('mesh.delete').typ = 'VERT'").notes
    assert note.startswith("`bpy.ops.mesh.delete` takes no `typ`; closest: `type`.")
    answer = kb.query("layout.operator('mesh.delete').type = 'VERT'")
    assert (answer.notes, answer.hits[0].id) == ((), "bpy.ops.mesh.delete")


@pytest.mark.parametrize(
    ("query", "note", "path"),
    [
        ("SpaceView3D.show_overlays", "Its `.overlay` has it", "bpy.types.View3DOverlay.show_overlays"),
        ("Scene.samples", "Its `.cycles` has it", "bpy.types.CyclesRenderSettings.samples"),
    ],
)
def test_what_a_class_lacks_is_found_on_what_it_points_to(
    query: str, note: str, path: str, kb: KnowledgeBase
) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == path
    assert any(told.startswith(note) for told in answer.notes)


@pytest.mark.parametrize(
    ("query", "said", "path"),
    [
        # A variable called as a collection that is gone; a member that is set beside its node.
        ("file_slots.new('depth')", "CompositorNodeOutputFile.file_slots` does not exist", "file_output_items"),
        ("CompositorNodeScale space = 'RENDER_SIZE'", "CompositorNodeScale.space` does not exist", 'inputs["Type"]'),
        ("bpy.data.images.open('x.png')", "Closest: `bpy.types.BlendDataImages.load`", "load"),
        ("light.specular", "Closest: `bpy.types.Light.specular_factor`.", "specular"),
        ("layer_collection.hide_render = True", "`bpy.types.LayerCollection` has no `hide_render`", "hide_render"),
    ],
)  # fmt: skip
def test_what_is_not_there_is_told(query: str, said: str, path: str, kb: KnowledgeBase) -> None:
    answer = kb.query(query)
    assert any(said in note for note in answer.notes)
    assert answer.hits[0].id.endswith(path)


def test_a_function_of_a_class_that_a_variable_is_named_after_is_found(kb: KnowledgeBase) -> None:
    assert kb.query("bvh.raycast((0, 0, 0), (0, 0, 1))").hits[0].id == "mathutils.bvhtree.BVHTree.ray_cast"
