"""Which classes belong to a topic, by the pages that explain them."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from kb_build.records import Link, Page, Section
from kb_build.store import Contents, write_base
from kb_serve.answer.topic_overview import Topics
from kb_serve.reader import BaseReader

if TYPE_CHECKING:
    from pathlib import Path

TYPES = "bpy.types."


def page(slug: str, title: str) -> Page:
    return Page(slug, "manual", "5.1", title, (Section("top", title, 1, "It is set in a panel."),))


def members(
    folder: Path, reader: BaseReader, slug: str, title: str, explained: dict[str, str]
) -> frozenset[str]:
    """The members of a page's topic in a base of a few classes, each with the page that explains it."""
    symbols = tuple(symbol for cls in explained if (symbol := reader.symbol(f"{TYPES}{cls}")))
    assert len(symbols) == len(explained)
    others = {other for other in explained.values() if other != slug}
    pages = (page(slug, title), *(page(other, "Other Things") for other in sorted(others)))
    links = tuple(Link(f"{TYPES}{cls}", other, "manual") for cls, other in explained.items())
    write_base(folder / "base.sqlite", Contents(symbols, pages, links, {}))
    with closing(BaseReader(folder / "base.sqlite")) as own:
        return Topics(own).members(slug)


@pytest.mark.parametrize(
    ("other", "belongs"), [("render/cycles/baking", False), ("physics/particles/baking", True)]
)
def test_a_class_of_another_part_is_not_a_topics_by_its_address_alone(
    tmp_path: Path, reader: BaseReader, other: str, *, belongs: bool
) -> None:
    explained = {"PointCache": "physics/baking", "BakeSettings": other}
    found = members(tmp_path, reader, "physics/baking", "Baking Physics Simulations", explained)
    assert f"{TYPES}PointCache" in found
    assert (f"{TYPES}BakeSettings" in found) is belongs


def test_a_panel_at_the_end_of_a_title_is_only_where_its_matter_is(
    tmp_path: Path, reader: BaseReader
) -> None:
    explained = {"ShapeKey": "animation/shape_keys/introduction"}
    slug = "animation/shape_keys/shape_keys_panel"
    assert f"{TYPES}ShapeKey" in members(tmp_path, reader, slug, "Shape Keys Panel", explained)
