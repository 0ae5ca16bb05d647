"""Removed symbols are looked up on classes, on their bases, below them, and by what classes were called before."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import pytest
from other_versions import base_of

from kb_build.symbols.paths import plain_path, socket_node
from kb_serve.reader import BaseReader
from kb_serve.recognise.removed.removed_symbols import RemovedSymbolLookup

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

T = "bpy.types."


@pytest.fixture
def removed(reader: BaseReader) -> RemovedSymbolLookup:
    return RemovedSymbolLookup(reader)


def path_of(symbol: object) -> str:
    return getattr(symbol, "path", "")


def test_a_member_is_found_on_the_class_and_on_its_bases(removed: RemovedSymbolLookup) -> None:
    own = removed.of_member(f"{T}Action", "fcurves")
    assert own is not None
    assert (own.path, own.last, own.gone) == (f"{T}Action.fcurves", "4.5", "5.0")
    assert path_of(removed.of_member(f"{T}GeometryNodeTree", "inputs")) == f"{T}NodeTree.inputs"
    assert removed.of_member(f"{T}Action", "location") is None
    assert removed.of_path(f"{T}Object.location") is None


def test_a_member_is_found_below_a_class_where_only_one_lost_it(removed: RemovedSymbolLookup) -> None:
    assert path_of(removed.below(f"{T}ID", "use_shadeless")) == f"{T}Material.use_shadeless"
    assert removed.below(f"{T}Modifier", "use_shadeless") is None
    # Cameras, armatures and more had it: the variable decides.
    assert removed.below(f"{T}ID", "draw_type") is None
    assert path_of(removed.below(f"{T}ID", "draw_type", "arm")) == f"{T}Armature.draw_type"


@pytest.mark.blender
def test_what_a_base_will_have_comes_before_what_a_former_name_of_the_class_had() -> None:
    with closing(BaseReader(base_of("3.4"))) as reader:
        lookup = RemovedSymbolLookup(reader)
        assert path_of(lookup.of_member(f"{T}GeometryNodeTree", "interface")) == f"{T}NodeTree.interface"
        # Each kind of modifier will have it, and has another class until then.
        assert lookup.below(f"{T}Modifier", "use_random") is None


def test_what_moved_to_a_base_class_is_not_gone(removed: RemovedSymbolLookup) -> None:
    assert removed.of_path(f"{T}PointLight.use_shadow") is None


def test_a_class_answers_for_what_it_was_called_before(removed: RemovedSymbolLookup) -> None:
    assert path_of(removed.of_member(f"{T}Light", "use_own_layer")).startswith(f"{T}Lamp")


def test_a_spelling_finds_names_but_no_variables(removed: RemovedSymbolLookup) -> None:
    spelled = {
        text: [symbol.path for symbol in removed.spelled(text)] for text in ("action fcurves", "lamp", "Lamp")
    }
    assert f"{T}Action.fcurves" in spelled["action fcurves"]
    assert spelled["Lamp"] == [f"{T}Lamp"]
    assert spelled["lamp"] == []
    assert list(removed.spelled("lamp.type")) == []


def test_successors_exist_and_exclude_guesses(reader: BaseReader, removed: RemovedSymbolLookup) -> None:
    rows = reader.rows("SELECT DISTINCT path FROM successors JOIN removed USING (path) ORDER BY path")
    assert len(rows) > 300
    for (path,) in rows:
        symbol = removed.of_path(path)
        if symbol is None:
            assert reader.history.still_works(path)
            continue
        assert symbol.similar == ()
        assert symbol.without_successor is not bool(symbol.targets)
        for target in symbol.targets:
            assert reader.entry(plain_path(target)), target


@pytest.mark.parametrize(
    ("path", "plain", "node"),
    [
        (f"{T}Object.type:LAMP", f"{T}Object.type", ""),
        ("bpy.ops.object.add(type):LAMP", "bpy.ops.object.add", ""),
        (f'{T}N.inputs["A:B (c)"]', f'{T}N.inputs["A:B (c)"]', f"{T}N"),
        (f'{T}N.inputs["A:B (c)"]:D', f'{T}N.inputs["A:B (c)"]', f"{T}N"),
        (f"{T}Object.type", f"{T}Object.type", ""),
    ],
)
def test_paths_are_taken_apart(path: str, plain: str, node: str) -> None:
    assert (plain_path(path), socket_node(path)) == (plain, node)


def test_plain_words_are_no_removed_class(kb: KnowledgeBase) -> None:
    assert not any("VertexColors" in note for note in kb.query("vertex colors").notes)
    assert any("VertexColors" in note for note in kb.query("VertexColors").notes)


@pytest.mark.parametrize(
    ("query", "use"),
    [
        # A property with the same items tells it, which had the old one for longer.
        ("bpy.ops.object.convert(target='GPENCIL')", "`bpy.ops.object.convert(target='GREASEPENCIL')`"),
        # An argument by itself: of the function that is used most.
        ("icon='OUTLINER_OB_LAMP'", "`bpy.types.UILayout.prop(icon='OUTLINER_OB_LIGHT')`"),
        ("icon='ZOOMOUT'", "`bpy.types.UILayout.prop(icon='REMOVE')`"),
    ],
)
def test_a_lost_value_of_an_argument_is_replaced(kb: KnowledgeBase, query: str, use: str) -> None:
    (note,) = kb.query(query).notes
    assert f"Use {use}." in note


def test_a_value_that_is_taken_is_not_lost(kb: KnowledgeBase) -> None:
    assert kb.query("icon='MESH_CUBE'").notes == ()


@pytest.mark.parametrize(
    ("query", "gone"),
    [
        ("what replaced bone layers", "bpy.types.Bone.layers"),
        ("scene node tree removed in 5", "bpy.types.Scene.node_tree"),
        ("use auto smooth gone", "bpy.types.Mesh.use_auto_smooth"),  # of some class, which is not named
        ("dupli group renamed", "bpy.types.Object.dupli_group"),
        ("scene update pre replacement", "bpy.app.handlers.scene_update_pre"),  # and not scene.update
    ],
)
def test_the_words_of_a_question_about_a_change_are_a_name(kb: KnowledgeBase, query: str, gone: str) -> None:
    told = [note for note in kb.query(query).notes if "does not exist" in note]
    assert [note.startswith(f"`{gone}` ") for note in told] == [True]


@pytest.mark.parametrize(
    "query",
    ["use auto smooth", "vertex colors removed", "where are the faces removed by boolean", "bone layers"],
)
def test_what_is_there_and_what_is_no_change_is_not_gone(kb: KnowledgeBase, query: str) -> None:
    assert not any("does not exist" in note for note in kb.query(query).notes)
