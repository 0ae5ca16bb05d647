"""The signals, each with everything else equal, and what holds of all."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import numpy as np
import pytest

from kb_build.pages.page import Page, Section
from kb_build.schema import DOCUMENT_KINDS, DocumentKind
from kb_build.store import Contents, write_base
from kb_build.symbols.records import Link
from kb_serve.rank.areas import NO_AREA, area_of
from kb_serve.rank.search import Searcher
from kb_serve.rank.signals import SIGNALS, Evidence, scores_of
from kb_serve.rank.weights import WEIGHTS
from kb_serve.reader import BaseReader

if TYPE_CHECKING:
    from pathlib import Path


def evidence(
    words: str = "cloth",
    *kinds: DocumentKind,
    failed: bool = False,
    asked: tuple[float, ...] = (),
    counts: tuple[float, ...] = (),
    areas: tuple[int, ...] = (),
    symbols: tuple[float, ...] = (),
    called: tuple[float, ...] = (),
) -> Evidence:
    count = max(map(len, (kinds, asked, counts, areas, symbols, called)))
    return Evidence(
        frozenset(words.split()),
        failed,
        np.ones(count, np.float32),
        np.array(asked or [0] * count, np.float32),
        np.array(counts or [0] * count, np.float32),
        np.array(areas or [NO_AREA] * count, np.uint8),
        np.arange(count, dtype=np.int32),
        np.array([DOCUMENT_KINDS.index(kind) for kind in kinds or ["data"] * count], np.uint8),
        np.array(symbols or [0] * count, np.float32),
        np.array(called or [0] * count, np.float32),
    )


def test_every_signal_has_a_weight_and_no_weight_is_without() -> None:
    assert set(WEIGHTS) == {*SIGNALS, "chapter"}


@pytest.mark.parametrize(
    ("words", "failed", "better", "worse"),
    [
        ("bake cloth python", False, "code", "data"),
        ("bake cloth", False, "data", "node"),
        ("bake cloth", False, "data", "rarely asked"),
        ("driver with a variable in python", False, "code", "removing"),
        ("remove a variable in python", False, "removing", "data"),
        ("bake cloth", False, "rarely asked", "index"),
    ],
)
def test_what_a_unit_is_counts(words: str, failed: bool, better: DocumentKind, worse: DocumentKind) -> None:
    first, second = scores_of(evidence(words, better, worse, failed=failed)).tolist()
    assert first > second


def test_code_and_nodes_are_data_alike_where_the_query_says_nothing_of_either() -> None:
    assert len(set(scores_of(evidence("cloth", "code", "data")).tolist())) == 1
    assert len(set(scores_of(evidence("cloth node", "node", "data")).tolist())) == 1


def test_a_unit_gains_by_a_phrase_that_is_near() -> None:
    far, near = scores_of(evidence(asked=(0.2, 0.8))).tolist()
    assert near > far


def test_a_symbol_of_any_kind_gains_where_code_is_asked_for() -> None:
    page, symbol = scores_of(evidence("active object python", symbols=(0.0, 1.0))).tolist()
    assert symbol > page
    assert len(set(scores_of(evidence("active object", symbols=(0.0, 1.0))).tolist())) == 1


def test_an_operator_gains_by_a_name_that_the_query_says_but_not_in_a_message() -> None:
    other, called = scores_of(evidence(called=(0.0, 0.8))).tolist()
    assert called > other
    assert len(set(scores_of(evidence(called=(0.0, 0.8), failed=True)).tolist())) == 1


def test_a_name_is_said_only_as_a_whole_and_of_several_words(reader: BaseReader) -> None:
    searcher = Searcher(reader)
    for text, said, not_said in (
        ("export a selection to usd", "bpy.ops.wm.usd_export", "bpy.ops.wm.usd_import"),
        ("bake the smoke", "", "bpy.ops.object.bake"),
        ("voxel remesh modifier", "", "bpy.ops.object.voxel_remesh"),  # who says so means no operator
        ("voxel remesh of a mesh", "bpy.ops.object.voxel_remesh", ""),
    ):
        found = searcher.find(text)
        assert found is not None
        numbers, seen = found
        shares = [0.0] * len(numbers) if seen.called is None else seen.called.tolist()
        refs = [searcher.index.levels[0].refs[number] for number in numbers.tolist()]
        named = {ref for ref, share in zip(refs, shares, strict=True) if share}
        assert not said or said in named
        assert not not_said or not_said not in named


def test_a_unit_gains_by_what_it_counts_but_not_where_a_message_may_be_about_the_rarest() -> None:
    rare, usual = scores_of(evidence(counts=(0.0, 2.0))).tolist()
    assert usual > rare
    assert len(set(scores_of(evidence(counts=(0.0, 2.0), failed=True)).tolist())) == 1


def test_an_area_apart_comes_later_unless_the_query_speaks_of_it() -> None:
    pencil = area_of("grease_pencil/modifiers/deform/smooth")
    assert pencil != area_of("modeling/modifiers/deform/smooth") == NO_AREA
    apart, other = scores_of(evidence("smooth a mesh", areas=(pencil, NO_AREA))).tolist()
    assert other > apart
    assert len(set(scores_of(evidence("smooth a stroke", areas=(pencil, NO_AREA))).tolist())) == 1


def test_what_a_page_of_an_area_explains_is_of_it(tmp_path: Path, reader: BaseReader) -> None:
    smooth = reader.symbol("bpy.types.GreasePencilSmoothModifier")
    other = reader.symbol("bpy.types.SmoothModifier")
    assert smooth is not None
    assert other is not None
    slug = "grease_pencil/modifiers/smooth"
    pages = (Page(slug, "manual", "5.1", "Smooth", (Section("s", "Smooth", 1, "Less noise."),)),)
    links = (Link(smooth.path, slug, "manual"),)
    write_base(tmp_path / "base.sqlite", Contents((smooth, other), pages, links, {}))
    with closing(BaseReader(tmp_path / "base.sqlite")) as own:
        index = Searcher(own).index
        areas = dict(zip(index.levels[0].refs, index.areas.tolist(), strict=True))
    assert areas == {slug: area_of(slug), smooth.path: area_of(slug), other.path: NO_AREA}


def test_a_unit_gains_by_its_chapter() -> None:
    one = evidence(asked=(0.5, 0.5, 0.5))
    one.chapters[:] = [0, 1, 1]
    alone, *together = scores_of(one).tolist()
    assert together[0] == together[1] > alone


@pytest.fixture
def panes(tmp_path: Path) -> Path:
    """Of a page that only has its title, and of one that speaks of the same more weakly."""
    pages = (
        Page("glass/index", "manual", "5.1", "Glass Panes", (Section("glass", "Glass Panes", 1, ""),)),
        Page("house", "manual", "5.1", "Houses", (Section("house", "Houses", 1, "Walls, doors, glass."),)),
    )
    write_base(tmp_path / "base.sqlite", Contents((), pages, (), {}))
    return tmp_path / "base.sqlite"


def test_a_page_without_text_comes_after_the_first_with_one(
    panes: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(WEIGHTS, "index", 0.0)
    with closing(BaseReader(panes)) as reader:
        hits = Searcher(reader).search("glass panes")
        assert [hit.ref for hit in hits] == ["house", "glass/index"]
        assert hits[0].score < hits[1].score
        assert [hit.ref for hit in Searcher(reader).search("panes")] == ["glass/index"]


def test_a_section_is_found_by_its_title_unless_many_are_called_so(tmp_path: Path) -> None:
    texts = ("How panes are cut and set into frames of wood.", "Cut frames, then set panes.", "Wood is cut.")
    pages = [
        Page(
            f"page{number}",
            "manual",
            "5.1",
            f"Page {number}",
            (
                Section("top", f"Page {number}", 1, text),
                Section("cut", "Cutting Frames" if number == 2 else "Example", 2, "It is done with care."),
            ),
        )
        for number, text in enumerate((*texts, *texts))
    ]
    write_base(tmp_path / "base.sqlite", Contents((), pages, (), {}))
    with closing(BaseReader(tmp_path / "base.sqlite")) as reader:
        searcher = Searcher(reader)
        (best, *_) = searcher.search("cutting frames")
        assert (best.ref, best.anchor) == ("page2", "cut")
        asked = [
            found[1].asked.max() for text in ("cutting frames", "example") if (found := searcher.find(text))
        ]
        assert asked == [pytest.approx(1, abs=0.01), 0]
