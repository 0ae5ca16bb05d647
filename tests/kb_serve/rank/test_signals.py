"""The signals, each with everything else equal, and what holds of all."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import numpy as np
import pytest

from kb_build.records import Page, Section
from kb_build.schema import DOCUMENT_KINDS, DocumentKind
from kb_build.store import Contents, write_base
from kb_serve.rank.search import Searcher
from kb_serve.rank.signals import SIGNALS, Evidence, scores_of
from kb_serve.rank.weights import WEIGHTS
from kb_serve.reader import BaseReader

if TYPE_CHECKING:
    from pathlib import Path


def evidence(
    words: str = "cloth", *kinds: DocumentKind, failed: bool = False, asked: tuple[float, ...] = ()
) -> Evidence:
    count = len(kinds) or len(asked)
    return Evidence(
        frozenset(words.split()),
        failed,
        np.ones(count, np.float32),
        np.array(asked or [0] * count, np.float32),
        np.arange(count, dtype=np.int32),
        np.array([DOCUMENT_KINDS.index(kind) for kind in kinds or ["data"] * count], np.uint8),
    )


def test_every_signal_has_a_weight_and_no_weight_is_without() -> None:
    assert set(WEIGHTS) == {*SIGNALS, "chapter"}


@pytest.mark.parametrize(
    ("words", "failed", "better", "worse"),
    [
        ("bake cloth python", False, "code", "data"),
        ("bake cloth", True, "code", "data"),
        ("bake cloth", False, "data", "node"),
        ("bake cloth", False, "data", "rarely asked"),
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


def test_a_unit_gains_by_its_chapter() -> None:
    one = evidence(asked=(0.5, 0.5, 0.5))
    one.chapters[:] = [0, 1, 1]
    alone, *together = scores_of(one).tolist()
    assert together[0] == together[1] > alone


@pytest.fixture
def base(tmp_path: Path) -> Path:
    """Of a page that only has its title, and of one that speaks of the same more weakly."""
    pages = (
        Page("glass/index", "manual", "5.1", "Glass Panes", (Section("glass", "Glass Panes", 1, ""),)),
        Page("house", "manual", "5.1", "Houses", (Section("house", "Houses", 1, "Walls, doors, glass."),)),
    )
    write_base(tmp_path / "base.sqlite", Contents((), pages, (), {}))
    return tmp_path / "base.sqlite"


def test_a_page_without_text_comes_after_the_first_with_one(
    base: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(WEIGHTS, "index", 0.0)
    with closing(BaseReader(base)) as reader:
        hits = Searcher(reader).search("glass panes")
        assert [hit.ref for hit in hits] == ["house", "glass/index"]
        assert hits[0].score < hits[1].score
        assert [hit.ref for hit in Searcher(reader).search("panes")] == ["glass/index"]
