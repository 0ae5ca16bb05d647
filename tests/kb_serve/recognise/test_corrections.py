"""How alike names are, and which former symbols are known."""

from __future__ import annotations

import random
import time
from typing import TYPE_CHECKING

import pytest
from asking import SEED, classes, misspelt, of_data, owner_and_name

from kb_serve.recognise.chains import find_chains
from kb_serve.recognise.corrections import LIKELY, Corrector, RemovedSymbolLookup, nearest, similarity
from kb_serve.recognise.resolver import Resolver

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader


@pytest.fixture(scope="module")
def corrector(reader: BaseReader) -> Corrector:
    return Corrector(reader, Resolver(reader))


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
    start = time.perf_counter()
    assert nearest("ClothSetings", names)[0][0] == "ClothSettings"
    assert time.perf_counter() - start < 0.5


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
    mended = corrector.corrected(find_chains("bpy.context.object.rigid_bodi.colision_shape")[0])
    assert mended is not None
    resolved, corrections = mended
    assert resolved.symbols[-1] == "bpy.types.RigidBodyObject.collision_shape"
    assert [(c.written, c.meant) for c in corrections] == [
        ("rigid_bodi", "rigid_body"),
        ("colision_shape", "collision_shape"),
    ]


def test_names_that_may_follow_include_inherited_ones(corrector: Corrector) -> None:
    names = corrector.member_names("bpy.types.ClothModifier")
    assert {"settings", "show_viewport", "keyframe_insert"} <= set(names)
    assert "modifier_add" in corrector.member_names("bpy.ops.object")
    assert corrector.member_names("nothing") == []


def test_former_members_are_found_on_the_class_and_on_its_bases(reader: BaseReader) -> None:
    drifts = RemovedSymbolLookup(reader)
    own = drifts.of_member("bpy.types.Action", "fcurves")
    assert own is not None
    assert (own.path, own.last) == ("bpy.types.Action.fcurves", "4.5")
    assert drifts.of_member("bpy.types.Action", "location") is None
    assert drifts.of_path("bpy.types.Object.location") is None
    assert "bpy.types.Action.fcurves" in {removed.path for removed in drifts.spelled("action fcurves")}


def test_replacements_come_best_first_and_exist(reader: BaseReader) -> None:
    drifts, checked = RemovedSymbolLookup(reader), 0
    for (path,) in reader.rows("SELECT DISTINCT path FROM replacements ORDER BY path LIMIT 400"):
        removed = drifts.of_path(path)
        if removed is not None:
            scores = [score for _, score in removed.instead]
            assert scores == sorted(scores, reverse=True)
            for target, _ in removed.instead:
                plain = target.partition(":")[0].partition("(")[0] if '["' not in target else target
                assert reader.entry(plain), target
            checked += 1
    assert checked > 100


def test_a_right_member_needs_no_correction(reader: BaseReader, corrector: Corrector) -> None:
    for path in of_data(reader, "property", 40):
        owner, name = owner_and_name(path)
        assert corrector.corrected(find_chains(f"{owner}.{name}")[0]) is None
