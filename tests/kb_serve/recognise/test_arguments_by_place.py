"""Arguments that are given by place, in code and in messages, and the names to write instead."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

# Code that Blender refuses → what is told of it.
REFUSED = {
    "scene.frame_set(10, 0.5)": "takes `subframe` by name only: write `subframe=`. Write `scene.frame_set(10, sub",
    "scene.frame_set(1, 2, 3)": "takes 1 argument by place: `frame_set(frame, *, subframe=0)`.",
    "mesh.uv_layers.new('UV')": "`name`, `do_init` by name only: write `name=`. Write `mesh.uv_layers.new(name='UV')`.",
    "bpy.ops.object.mode_set('EDIT')": "takes its arguments by name only: `mode='EDIT'`.",
    "scene.frame_set(10.5)": "`bpy.types.Scene.frame_set(frame)` takes an int, not 10.5.",
    "blf.size(0, 20, 72)": "`blf.size` takes 2 arguments by place: `size(fontid, size, /)`.",
    "bmesh.ops.create_cube(bm, 2)": "takes `size`, `matrix`, `calc_uvs` by name only: `size=2`.",
}
TAKEN = (
    "scene.frame_set(10, subframe=0.5)",
    "bpy.ops.object.select_all('EXEC_DEFAULT', action='SELECT')",
    "mathutils.Matrix.Rotation(0.5, 4, 'X')",
    "scene.collection.objects.link(*[ob])",
    "scene.frame_set(10)",
)


def run(code: str) -> None:
    """Runs a line in this environment's Blender, which has the names that it uses."""
    import blf
    import bmesh
    import mathutils

    bpy.ops.wm.read_factory_settings()
    scene, ob = bpy.context.scene, bpy.data.objects.new("o", None)
    mesh = bpy.data.meshes.new("m")
    names = {"bpy": bpy, "scene": scene, "mesh": mesh, "ob": ob, "blf": blf, "mathutils": mathutils}
    bm = bmesh.new()
    try:
        exec(code, {**names, "bmesh": bmesh, "bm": bm})
    finally:
        bm.free()


@pytest.mark.parametrize("code", REFUSED)
def test_what_is_refused_is_told_with_the_name_to_write(kb: KnowledgeBase, code: str) -> None:
    with pytest.raises((TypeError, ValueError)):
        run(code)
    assert any(REFUSED[code] in note for note in kb.query(code).notes)


def test_a_number_that_an_operator_takes_for_something_else_is_told(kb: KnowledgeBase) -> None:
    run("bpy.ops.mesh.primitive_cube_add(5)")
    assert bpy.context.object.dimensions.x == pytest.approx(2)
    told = "`bpy.ops.mesh.primitive_cube_add` takes its arguments by name only; `5` sets none of them."
    assert told in kb.query("bpy.ops.mesh.primitive_cube_add(5)").notes


@pytest.mark.parametrize("code", TAKEN)
def test_nothing_is_told_of_what_is_taken(kb: KnowledgeBase, code: str) -> None:
    run(code)
    assert not [note for note in kb.query(code).notes if "by place" in note or "by name only" in note]


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("scene.frame_set(1, 2)", "takes `subframe` by name only, as `subframe=…`: `frame_set(frame, *, subframe=0)`."),
        ("scene.frame_set()", "`bpy.types.Scene.frame_set` needs `frame`: `frame_set(frame, *, subframe=0)`."),
        ("scene.frame_set(1, 2, 3, 4)", "`bpy.types.Scene.frame_set` takes 1 argument by place"),
        ("blf.size(0, 20, 72)", "`blf.size` takes 2 arguments: `size(fontid, size, /)`."),
    ],
)  # fmt: skip
def test_blenders_messages_are_told_in_the_same_way(kb: KnowledgeBase, code: str, told: str) -> None:
    with pytest.raises(TypeError) as refused:
        run(code)
    answer = kb.query(f"TypeError: {refused.value}")
    assert any(told in note for note in answer.notes)


def test_the_signature_shows_what_is_given_by_name_only(kb: KnowledgeBase) -> None:
    symbol = kb.symbol("bpy.types.StripsTopLevel.new_effect")
    assert symbol is not None
    assert symbol.signature == (
        "new_effect(name, type, channel, frame_start, *, length=0, input1=None, input2=None)"
    )


def test_a_point_alone_is_no_fraction(kb: KnowledgeBase) -> None:
    assert not any("whole number" in note for note in kb.query("scene.frame_set(.)").notes)
    notes = kb.query("scene.frame_set(.5)").notes
    assert any("`bpy.types.Scene.frame_set(frame)` takes an int" in note for note in notes)


def test_an_argument_is_not_meant_for_what_takes_another_type(kb: KnowledgeBase) -> None:
    notes = kb.query('layout.template_list("MY_UL", "", scene, "items", scene, "index", 3)').notes
    assert not [note for note in notes if "item_dyntip_propname=" in note and "Write" in note]
    assert not [note for note in kb.query("bm = bmesh.new(me)").notes if "use_operators=me" in note]


def test_what_takes_names_only_is_said_once(kb: KnowledgeBase) -> None:
    (note,) = kb.query("layout.split(0.3)").notes
    assert "Write `layout.split(factor=0.3)`." in note
