"""What ships of summaries and phrases: found by content, and sound."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files

import pytest
from fake_messages_api import FakeMessagesAPI
from test_summaries_claude import good, options

from kb_build.pages.page import Page, Section
from kb_build.summaries.methods import summarise
from kb_build.summaries.prompt import PROMPT_VERSION
from kb_build.summaries.replies import sound_phrases
from kb_build.summaries.shipped import ShippedSummary, file_name, shipped_summaries
from kb_build.summaries.store import MAX_TEXT, SummaryStore

TEXT = (
    "Cloth simulation is one of the hardest aspects of CG, because it is a deceptively simple real-world item. "
    * 3
)
PAGE = Page("physics/cloth", "manual", "5.1", "Cloth", (Section("", "Cloth", 1, TEXT),))
OTHER = replace(PAGE, slug="physics/fluid", title="Fluid", sections=(Section("", "Fluid", 1, TEXT),))


def rows() -> list[ShippedSummary]:
    names = [file_name("5.1", slug) for slug in ("animation", "physics")]
    texts = [files("corpora").joinpath("summaries", name).read_text(encoding="utf-8") for name in names]
    return [ShippedSummary.from_line(line) for text in texts for line in text.splitlines()]


@pytest.fixture
def shipped(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    (tmp_path / "summaries").mkdir()
    row = ShippedSummary(PAGE.slug, PAGE.content_hash, "a-model", "What cloth is.", ("flag in the wind",))
    (tmp_path / "summaries" / file_name("5.1", PAGE.slug)).write_text(row.to_line() + "\n")
    monkeypatch.setattr("kb_build.summaries.shipped.files", lambda _: tmp_path)


def test_every_line_is_a_sound_summary() -> None:
    lines = rows()
    assert len(lines) > 2_000
    assert len({row.slug for row in lines}) == len(lines)
    for row in lines:
        assert 0 < len(row.summary) <= MAX_TEXT, row.slug
        assert row.summary.isprintable(), row.slug
        assert len(row.content_hash) == 64, row.slug
        assert all(sound_phrases([phrase]) == (phrase,) for phrase in row.phrases), row.slug


@pytest.mark.usefixtures("shipped")
def test_a_page_that_has_changed_has_nothing_shipped() -> None:
    found = shipped_summaries([PAGE, OTHER])
    assert {slug: summary.phrases for slug, summary in found.items()} == {PAGE.slug: ("flag in the wind",)}
    assert found[PAGE.slug].prompt_version == PROMPT_VERSION
    changed = replace(PAGE, sections=(Section("", "Cloth", 1, TEXT + "More."),))
    assert shipped_summaries([changed]) == {}


@pytest.mark.usefixtures("shipped")
def test_other_pages_get_sentences_of_their_own() -> None:
    run = summarise([PAGE, OTHER])
    assert (run.report.made, run.report.reused) == (1, 1)
    assert {slug: summary.method for slug, summary in run.by_slug.items()} == {
        PAGE.slug: "claude",
        OTHER.slug: "extractive",
    }


@pytest.mark.usefixtures("shipped")
def test_claude_is_asked_only_for_what_does_not_ship(tmp_path) -> None:
    with FakeMessagesAPI(good) as api:
        run = summarise(
            [PAGE, OTHER],
            method="claude",
            store=SummaryStore(tmp_path / "store.sqlite"),
            options=options(api),
        )
        (batch,) = api.batches.values()
    assert len(batch.requests) == 1
    assert run.by_slug[PAGE.slug].text == "What cloth is."
    assert run.by_slug[OTHER.slug].text == "Fluid settings."
