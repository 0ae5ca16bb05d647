"""What the manual says of a symbol stands in the base as answers show it."""

from __future__ import annotations

from kb_build.index.label_names import LabelName
from kb_build.index.passage_texts import passage_rows
from kb_build.index.passages import Passage
from kb_build.pages.page import Page, Section

TEXT = "**Quality**\n  Higher is better.\n  - **High** Slow.\n\n**Mass**\n  In kilograms."
PAGE = Page(
    "physics/cloth",
    "manual",
    "5.1",
    "Cloth",
    (Section("cloth", "Cloth", 1, "Bends and folds."), Section("settings", "Settings", 2, TEXT)),
)


def test_a_passage_has_its_headings_and_the_names_beside_its_labels() -> None:
    passages = {"a.quality": Passage(PAGE.slug, 1, 0), "a": Passage(PAGE.slug, 0, -1)}
    labels = [LabelName(PAGE.slug, 1, 2, "`'HIGH'`"), LabelName(PAGE.slug, 0, 0, "`Cloth`")]
    assert [*passage_rows(passages, [PAGE], labels)] == [
        (
            "a.quality",
            PAGE.slug,
            1,
            0,
            "Cloth › Settings",
            "Higher is better.\n- **High** `'HIGH'` · Slow.",
        ),
        ("a", PAGE.slug, 0, -1, "Cloth", "Bends and folds. · `Cloth`"),
    ]
