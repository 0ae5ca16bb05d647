"""Plain words: what is found, and that the order follows from what was said."""

from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING

import numpy as np
import pytest
from asking import SEED, of_data

from kb_build.index.analysis import STOP_WORDS, stem, terms, words
from kb_build.index.query_expansions import load_query_expansions
from kb_serve.rank.search import Searcher, best_first
from kb_serve.rank.weights import WEIGHTS

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader


@pytest.fixture(scope="module")
def searcher(reader: BaseReader) -> Searcher:
    return Searcher(reader)


def test_a_description_finds_its_own_symbol(reader: BaseReader, searcher: Searcher) -> None:
    found, asked = 0, 0
    for path in of_data(reader, "property", 400):
        symbol = reader.symbol(path)
        assert symbol is not None
        said = terms(symbol.description)
        if len(set(said)) < 7:
            continue
        asked += 1
        twins = {
            row[0]
            for row in reader.rows(
                "SELECT path FROM symbols WHERE line LIKE ?", f"%{symbol.description[:60]}%"
            )
        }
        found += bool({path, *twins} & {row.ref for row in searcher.search(symbol.description, 5)})
    assert asked > 50
    assert found >= 0.8 * asked  # beside what people ask for in such words


def test_phrases_find_their_symbol_in_any_word_order(reader: BaseReader, searcher: Searcher) -> None:
    chance, found, asked = random.Random(SEED), 0, 0
    rows = [
        (path, row)
        for path, row in load_query_expansions().items()
        if path.startswith("bpy.types.") and reader.entry(path)
    ]
    for path, row in chance.sample(rows, 300):
        said = [word for word in words(chance.choice(row.split(";"))) if word not in STOP_WORDS]
        if len(said) < 3:
            continue
        asked += 1
        chance.shuffle(said)
        found += path in [row.ref for row in searcher.search(" ".join(said), 5)]
    assert asked > 100
    assert found >= 0.85 * asked


def test_a_query_that_is_a_phrase_gains_by_it(searcher: Searcher, monkeypatch: pytest.MonkeyPatch) -> None:
    path = "bpy.types.ClothSettings.use_pressure"
    query = load_query_expansions()[path].partition(";")[0]

    def lead() -> float:
        """The score of what is asked for, by the best of the others."""
        scores = {row.ref: row.score for row in searcher.search(query, 20)}
        return scores.pop(path) / max(scores.values())

    whole = lead()
    monkeypatch.setitem(WEIGHTS, "asked", 0.0)
    assert whole > lead()


def test_a_question_finds_the_page_that_answers_it(searcher: Searcher) -> None:
    found = [row.ref for row in searcher.search("the gap between two parts of one cloth", 10)]
    assert "physics/cloth/settings/collisions" in found


def test_scores_fall_and_no_id_comes_twice(searcher: Searcher) -> None:
    for query in ("cloth", "bake the simulation", "render image size", "bone constraint target"):
        found = searcher.search(query, 100)
        assert len({row.ref for row in found}) == len(found)
        assert all(row.score > 0 for row in found)
        assert len(found) <= 100


@pytest.mark.parametrize("limit", [1, 3, 6, 8, 20, 50])
def test_the_limit_holds_and_the_beginning_is_the_same(searcher: Searcher, limit: int) -> None:
    assert searcher.search("cloth collision", limit) == searcher.search("cloth collision", 60)[:limit]


def test_order_case_and_small_words_do_not_matter(searcher: Searcher) -> None:
    one = [row.ref for row in searcher.search("self collision distance of cloth", 20)]
    assert one == [
        row.ref for row in searcher.search("How does the CLOTH have its self-collision distance?", 20)
    ]


@pytest.mark.parametrize("query", ["", " ", "the of and", "qqqqxxxx", "!!!", "🎨", "\x00", ", . ; :"])
def test_queries_without_words_find_nothing(searcher: Searcher, query: str) -> None:
    assert searcher.search(query) == []


@pytest.mark.parametrize(
    ("written", "meant"), [("colision", "collision"), ("rendr", "render"), ("simualtion", "simulation")]
)
def test_an_unknown_word_is_read_as_one_of_the_corpus(searcher: Searcher, written: str, meant: str) -> None:
    assert stem(searcher.words.correction(written)) == stem(meant)
    assert {row.ref for row in searcher.search(f"cloth {written}", 10)} & {
        row.ref for row in searcher.search(f"cloth {meant}", 10)
    }


def test_a_class_in_small_letters_is_read_as_its_words(searcher: Searcher) -> None:
    asked = [concept.word for concept in searcher.words.concepts("viewlayer active object")]
    assert sorted(asked) == ["active", "layer", "object", "view"]
    assert [concept.word for concept in searcher.words.concepts("material thickness")] == [
        "material",
        "thickness",
    ]


@pytest.mark.parametrize("word", ["", "abc", "x1y2z3", "zzzzzzzz", "a b", "é" * 9])
def test_a_word_without_a_similar_one_is_not_corrected(searcher: Searcher, word: str) -> None:
    assert searcher.words.correction(word) == ""


def test_rare_words_tell_more(searcher: Searcher, reader: BaseReader) -> None:
    assert searcher.index.idf(stem("cloth")) > searcher.index.idf(stem("object")) > 0
    assert searcher.index.idf("qqqqxxxx") == 0
    stems = [row[0] for row in reader.rows("SELECT stem FROM vocabulary LIMIT 500")]
    assert all(math.isfinite(searcher.index.idf(term)) for term in stems)


def test_a_query_is_its_distinct_words_without_the_framing_ones(searcher: Searcher) -> None:
    words = [
        concept.word
        for concept in searcher.words.concepts("How do I bake the cloth, the cloths and the bake?")
    ]
    assert words == ["bake", "cloth"]
    assert not STOP_WORDS & set(words)


def test_any_words_in_any_number_are_searched(searcher: Searcher, reader: BaseReader) -> None:
    chance, words = random.Random(SEED), [row[0] for row in reader.rows("SELECT word FROM vocabulary")]
    for size in (1, 2, 5, 20, 60, 400):
        assert isinstance(searcher.search(" ".join(chance.choices(words, k=size))), list)


@pytest.mark.parametrize(
    ("about", "cls"), [("a rigid body", "RigidBodyObject"), ("the world of rigid bodies", "RigidBodyWorld")]
)
def test_words_around_a_query_tell_which_of_the_same_is_meant(
    searcher: Searcher, about: str, cls: str
) -> None:
    refs = [hit.ref for hit in searcher.search("is it enabled", 5, about=about)]
    assert any(ref.startswith(f"bpy.types.{cls}") for ref in refs)


def test_words_around_a_query_count_less_than_its_own(searcher: Searcher) -> None:
    own, around = "self collision of cloth", "motor of a rigid body constraint"
    (best, *_) = searcher.search(own)
    assert searcher.search(own, about=around)[0].ref == best.ref
    assert searcher.search(around, about=own)[0].ref == searcher.search(around)[0].ref != best.ref
    assert searcher.search(own, about=own) == searcher.search(own)


@pytest.mark.parametrize(
    ("question", "path"),
    [
        ("how do I make a glass material", "bpy.types.ShaderNodeBsdfGlass"),
        ("bake cloth cache", "bpy.ops.ptcache.bake_all"),
        ("bake rigid body simulation to keyframes", "bpy.ops.rigidbody.bake_to_keyframes"),
        ("how do I make an armature with two bones", "bpy.types.ArmatureEditBones.new"),
        ("export only selected objects to gltf", "bpy.ops.export_scene.gltf"),
        ("curve to mesh with a round bevel", "bpy.types.Curve.bevel_depth"),
        ("set world background to hdri", "bpy.types.ShaderNodeTexEnvironment"),
        ("colors for the corners of a mesh by script", "bpy.types.AttributeGroupMesh.new"),
        ("position of a simulated object in a script", "bpy.types.ID.evaluated_get"),
        ("range of a custom property", "bpy.types.bpy_struct.id_properties_ui"),
        ("export the selection to USD", "bpy.ops.wm.usd_export"),
    ],
)
def test_a_plain_wish_finds_what_does_it(kb: KnowledgeBase, question: str, path: str) -> None:
    assert path in [hit.id for hit in kb.query(question).hits[:3]]


@pytest.mark.parametrize("count", [1, 40, 499, 500, 900])
def test_best_first_keeps_equal_scores_in_their_order(count: int) -> None:
    chance = random.Random(count)
    scores = np.array([chance.choice([1e-30, 0.25, 0.5, 3.0, 1e9]) for _ in range(500)], np.float32)
    expected = sorted(range(500), key=lambda place: -scores[place])[:count]
    assert best_first(scores, count).tolist() == expected
