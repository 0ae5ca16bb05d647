"""Names and prose in one order."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from asking import paths

from kb_serve.rank.merging import SURE, QueryRanker, Ranking
from kb_serve.rank.ranked_id import RankedId
from kb_serve.rank.search import SearchHit
from kb_serve.recognise.recognition import Recognition

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader


@pytest.fixture(scope="module")
def ranker(reader: BaseReader) -> QueryRanker:
    return QueryRanker(reader)


def test_an_exact_name_needs_no_search(ranker: QueryRanker, reader: BaseReader) -> None:
    for path in paths(reader, "operator", 30):
        ranking = ranker.rank(path)
        assert ranking.named
        assert ranking.ranked[0].id == path
        assert {row.why for row in ranking.ranked} == {"exact"}


@pytest.mark.parametrize(
    "query", ["make the cloth finer", "bake a simulation to disk", "smooth the mesh surface"]
)
def test_prose_names_nothing(ranker: QueryRanker, query: str) -> None:
    ranking = ranker.rank(query)
    assert not ranking.named
    assert ranking.ranked


@pytest.mark.parametrize(
    "query",
    [
        "why does obj.rigid_body.mass matter for falling",
        "ClothSettings.quality and how it slows the simulation",
    ],
)
def test_named_ids_come_before_search_hits(ranker: QueryRanker, query: str) -> None:
    ranking = ranker.rank(query)
    whys = [row.why for row in ranking.ranked]
    assert ranking.ranked[0].score >= SURE
    assert "found" not in whys[:1]
    assert "found" in whys


def test_no_id_is_ranked_twice_and_scores_are_shares(ranker: QueryRanker) -> None:
    for query in (
        "quality",
        "cloth",
        "obj.modifiers['Cloth'].settings.quality cloth",
        "EMITTER particles",
        "Object",
    ):
        rows = ranker.rank(query).ranked
        assert len({row.id for row in rows}) == len(rows)
        assert all(0 < row.score <= 1 for row in rows)


def test_notes_are_not_repeated(ranker: QueryRanker) -> None:
    notes = ranker.rank("action.fcurves action.fcurves action.fcurves").notes
    assert len(notes) == len(set(notes)) == 1
    assert "`bpy.types.Action.fcurves` does not exist in Blender" in notes[0]
    assert "removed in 5.0" in notes[0]


def _found(*scores: float, name: str = "{}") -> list[RankedId]:
    return [RankedId(name.format(number), score, "found") for number, score in enumerate(scores)]


def _no_page(_ref: str) -> bool:
    return False


def test_what_is_far_below_the_best_is_not_listed() -> None:
    named = RankedId("a", 0.95, "expression")
    found = _found(*(0.8 - 0.11 * number for number in range(8)))
    listed = Ranking([named, *found], Recognition(), named=True).listed(9, _no_page)
    assert [row.id for row in listed] == ["a", "0", "1", "2", "3"]
    described = Ranking(found, Recognition(), named=False).listed(8, _no_page)
    assert [row.id for row in described] == ["0", "1", "2", "3", "4"]
    assert len(Ranking(found, Recognition(), named=False).listed(2, _no_page)) == 2


def test_symbols_come_before_further_pages_if_the_first_are_pages() -> None:
    pages = _found(*(0.8 - 0.01 * number for number in range(8)), name="page/{}")
    symbols = _found(0.4, 0.3, 0.25, 0.19, name="bpy.types.{}")
    ranking = Ranking([*pages, *symbols], Recognition(), named=False)
    listed = [row.id for row in ranking.listed(8, lambda ref: ref.startswith("page/"))]
    assert listed == [*(f"page/{n}" for n in range(5)), *(f"bpy.types.{n}" for n in range(3))]
    few = [row.id for row in ranking.listed(6, lambda ref: ref.startswith("page/"))]
    assert few == [*(f"page/{n}" for n in range(5)), "bpy.types.0"]
    near = Ranking([*pages, symbols[-1]], Recognition(), named=False)
    assert [row.id for row in near.listed(8, lambda ref: ref.startswith("page/"))] == [
        row.id for row in pages
    ]


def test_a_symbol_far_below_the_best_is_listed_only_if_it_is_of_the_chapter_of_one_of_the_first() -> None:
    pages = [RankedId(f"page/{n}", 0.8, "found", chapter=n) for n in range(5)]
    near = RankedId("near", 0.5, "found", chapter=7)
    far = [RankedId(f"far.{chapter}", 0.3, "found", chapter=chapter) for chapter in (7, 2, 8, 4)]
    listed = Ranking([*pages, near, *far], Recognition(), named=False).listed(
        8, lambda ref: ref.startswith("page/")
    )
    assert [row.id for row in listed[5:]] == ["near", "far.2", "far.4"]


@pytest.mark.parametrize(
    ("found", "query", "opened"),
    [
        ("", "printed to the log from a script: self collisions", "self-collisions"),
        ("", "collisions of cloth", ""),
        ("object-collisions", "printed to the log from a script: self collisions", "object-collisions"),
    ],
)
def test_a_page_that_was_found_as_a_whole_is_opened_at_the_section_that_is_asked_for(
    ranker: QueryRanker, monkeypatch: pytest.MonkeyPatch, found: str, query: str, opened: str
) -> None:
    page = SearchHit("physics/cloth/settings/collisions", found, 1.0)
    monkeypatch.setattr(ranker.searcher, "search", lambda *_args, **_options: [page])
    (top, *_) = ranker.rank(query).ranked
    assert (top.id, top.anchor) == (page.ref, opened)


def test_what_takes_the_place_of_a_deprecated_property_comes_before_it(ranker: QueryRanker) -> None:
    ids = [row.id for row in ranker.rank("how long a strip is").ranked]
    old, new = "bpy.types.Strip.frame_final_duration", "bpy.types.Strip.duration"
    assert ids.index(new) + 1 == ids.index(old)
    assert ranker.rank(old).ranked[0].id == old  # whoever names it wants it


@pytest.mark.parametrize(
    ("query", "score", "is_first"),
    [
        ("self collisions of cloth with python", 0.9, True),
        ("self collisions of cloth, from a script", 0.9, True),
        ("self collisions of cloth with python", 0.6, False),  # clearly worse
        ("self collisions of cloth", 0.9, False),  # in the window, perhaps
    ],
)
def test_who_writes_a_script_gets_a_name_before_a_page_that_is_hardly_better(
    ranker: QueryRanker, monkeypatch: pytest.MonkeyPatch, query: str, score: float, *, is_first: bool
) -> None:
    page = SearchHit("physics/cloth/settings/collisions", "self-collisions", 1.0)
    name = SearchHit("bpy.types.ClothCollisionSettings.use_self_collision", "", score)
    found = [page, name]

    def search(*_args: object, **_options: object) -> list[SearchHit]:
        return found

    monkeypatch.setattr(ranker.searcher, "search", search)
    ranked = ranker.rank(query).ranked
    assert (ranked[0].id == name.ref) is is_first
    assert {row.id for row in ranked[:2]} == {page.ref, name.ref}
    assert [row.score for row in ranked] == sorted((row.score for row in ranked), reverse=True)


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("convert curve to mesh python", "bpy.ops.object.convert"),
        ("extrude mesh python", "bpy.ops.mesh.extrude_region_move"),
        ("remove doubles merge by distance bmesh", "bmesh.ops.remove_doubles"),
    ],
)
def test_a_node_with_the_label_of_what_is_done_is_not_the_first_for_a_script(
    ranker: QueryRanker, query: str, first: str
) -> None:
    assert ranker.rank(query).ranked[0].id == first


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("curve to mesh node", "bpy.types.GeometryNodeCurveToMesh"),
        ("curve to mesh geometry nodes python", "bpy.types.GeometryNodeCurveToMesh"),
        ("mix two shaders by python", "bpy.types.ShaderNodeMixShader"),
    ],
)
def test_a_node_that_is_asked_for_is_the_first(ranker: QueryRanker, query: str, first: str) -> None:
    assert ranker.rank(query).ranked[0].id == first
