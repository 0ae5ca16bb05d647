"""How alike names are, and which wrong ones are misspelt."""

from __future__ import annotations

import random
import time
from typing import TYPE_CHECKING

import pytest
from asking import SEED, classes, misspelt, of_data, owner_and_name

from kb_serve.recognise.chains.chains import find_chains
from kb_serve.recognise.likely.corrections import LIKELY, Corrector, is_misspelling, nearest, similarity
from kb_serve.recognise.resolver import Resolver

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.likely.corrections import Correction
    from kb_serve.recognise.resolver import ResolvedChain


@pytest.fixture(scope="module")
def corrector(reader: BaseReader) -> Corrector:
    return Corrector(reader, Resolver(reader))


def corrected(
    corrector: Corrector, reader: BaseReader, text: str
) -> tuple[ResolvedChain, list[Correction]] | None:
    (chain,) = find_chains(text)
    return corrector.corrected(chain, Resolver(reader).resolve(chain))


@pytest.mark.parametrize(
    ("written", "name", "low", "high"),
    [
        ("quality", "quality", 1, 1), ("qualitySteps", "quality_steps", 1, 1), ("Quality Steps", "quality_steps", 1, 1),
        ("qualiti", "quality", 0.8, 0.9), ("select", "select_set", 0.8, 0.9), ("set", "select_set", 0.8, 0.9),
        ("use_colision", "use_collision", 0.9, 0.99), ("x", "quality", 0, 0.2), ("", "quality", 0, 0.01),
        ("a", "b", 0, 0),
        ("frame", "frame_start", 0.8, 0.9), ("start", "restart", 0.6, LIKELY), ("🎨", "quality", 0, 0),
    ],
)  # fmt: skip
def test_names_are_alike_by_spelling_by_edits_and_by_words(
    written: str, name: str, low: float, high: float
) -> None:
    assert low <= similarity(written, name) <= high


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("colision_shape", "collision_shape"), ("lokation", "location"), ("modifier_ad", "modifier_add"),
        ("PoimtLight", "PointLight"), ("active_materials", "active_material"), ("qualitySteps", "quality_steps"),
        ("rigidbodyworld", "rigid_body_world"),
    ],
)  # fmt: skip
def test_a_slip_of_the_fingers_is_a_misspelling(written: str, name: str) -> None:
    assert is_misspelling(written, name)


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("groups", "node_groups"), ("use_limit_x", "use_limit_y"), ("frame_start", "frame_end"),
        ("select", "select_set"), ("quality", "velocity"), ("use_min_x", "use_max_x"), ("draw_type", "display_type"),
        ("unsubscribe_rna", "subscribe_rna"),
        ("shadow_min", "shadow_max"), ("collection_inputs", "collection_outputs"), ("", "x"),
    ],
)  # fmt: skip
def test_another_word_is_no_misspelling(written: str, name: str) -> None:
    assert not is_misspelling(written, name)


def test_the_nearest_come_first_and_only_the_likely_ones() -> None:
    names = ["quality", "quantity", "equality", "velocity", "use_quality"]
    found = nearest("qualiti", names)
    assert found[0][0] == "quality"
    assert all(alike >= LIKELY for _, alike in found)
    assert [alike for _, alike in found] == sorted((alike for _, alike in found), reverse=True)
    assert nearest("qualiti", names, 1) == found[:1]
    assert nearest("zzz", names) == []
    assert nearest("anything", []) == []


def test_similarity_and_nearest_agree(reader: BaseReader) -> None:
    chance, names = random.Random(SEED), list(reader.members("bpy.types.Object"))
    for _ in range(50):
        written = misspelt(chance.choice([name for name in names if len(name) > 6]), chance)
        for name, alike in nearest(written, names):
            assert alike == similarity(written, name)


def test_thousands_of_names_are_compared_in_no_time(reader: BaseReader) -> None:
    names = list(reader.members("bpy.types"))
    assert len(names) > 3_500
    start = time.process_time()
    assert nearest("ClothSetings", names)[0][0] == "ClothSettings"
    assert time.process_time() - start < 0.5


def test_a_misspelt_class_is_found_and_a_right_one_left_alone(
    reader: BaseReader, corrector: Corrector
) -> None:
    chance = random.Random(SEED)
    for path in classes(reader, count=100):
        name = path.rpartition(".")[2]
        if len(name) >= 12 and not name.startswith("Node"):
            found = corrector.root(misspelt(name, chance))
            assert found is not None
            assert found.similarity >= 0.8
    assert corrector.root("Abc") is None
    assert corrector.root("Xyzzyplugh") is None


@pytest.mark.parametrize(
    "written",
    ["quality", "abc_def", "qwertzuiop_asdfghjkl", "", "_", "a" * 5_000, "x_" * 2_000, "🎨_🎨_🎨🎨🎨🎨"],
)
def test_a_name_without_a_similar_one_is_not_corrected(corrector: Corrector, written: str) -> None:
    assert corrector.member(written) is None


def test_two_mistakes_in_one_expression_are_both_mended(reader: BaseReader, corrector: Corrector) -> None:
    mended = corrected(corrector, reader, "bpy.context.object.rigid_bodi.colision_shape")
    assert mended is not None
    resolved, corrections = mended
    assert resolved.symbols[-1] == "bpy.types.RigidBodyObject.collision_shape"
    assert [(c.written, c.meant) for c in corrections] == [
        ("rigid_bodi", "rigid_body"),
        ("colision_shape", "collision_shape"),
    ]


def test_names_that_may_follow_include_inherited_ones(reader: BaseReader) -> None:
    names = reader.member_names("bpy.types.ClothModifier")
    assert {"settings", "show_viewport", "keyframe_insert"} <= set(names)
    assert "modifier_add" in reader.member_names("bpy.ops.object")
    assert reader.member_names("nothing") == []


def test_a_right_member_needs_no_correction(reader: BaseReader, corrector: Corrector) -> None:
    for path in of_data(reader, "property", 40):
        owner, name = owner_and_name(path)
        assert corrected(corrector, reader, f"{owner}.{name}") is None


@pytest.mark.parametrize("query", ["hide_set_viewport", "obj.hide_set_viewport(True)"])
def test_a_name_that_is_made_of_two_leads_to_both(kb: KnowledgeBase, query: str) -> None:
    answer = kb.query(query)
    assert {hit.id for hit in answer.hits[:2]} == {
        "bpy.types.Object.hide_set",
        "bpy.types.Object.hide_viewport",
    }
    assert "`bpy.types.Object.hide_set`" in answer.notes[0]
    assert "`bpy.types.Object.hide_viewport`" in answer.notes[0]


def test_a_name_with_a_word_too_many_leads_to_the_one_without(kb: KnowledgeBase) -> None:
    message = (
        "light.energy_strength = 3\nAttributeError: 'PointLight' object has no attribute 'energy_strength'"
    )
    (note,) = kb.query(message).notes
    assert note.endswith("Closest: `bpy.types.PointLight.energy`.")
