"""Compares two readings of the same documentation."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.pages.page import Page

_TOKEN = re.compile(r"\w+")


@dataclass(frozen=True, slots=True)
class PageDifference:
    """One shared page that is not read alike. ``similarity`` of the texts' tokens, 0 to 1; ``lost`` and
    ``added`` are tokens that only the first or only the second reading has."""

    slug: str
    outline_agrees: bool
    outlines: tuple[tuple[str, ...], tuple[str, ...]]
    similarity: float
    lost: tuple[str, ...]
    added: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ReaderComparison:
    """Two readings side by side. Shares and similarities lie between 0 and 1; they are 1 when nothing is
    shared, so look at ``shared`` first."""

    shared: tuple[str, ...]
    only_first: tuple[str, ...]
    only_second: tuple[str, ...]
    outline_share: float
    """Share of shared pages whose title and sequence of section titles and levels agree."""
    similarity: float
    """Mean over the shared pages."""
    identical: int
    """Shared pages whose text is equal, white space folded."""
    same_children: int
    same_breadcrumbs: int
    same_links: int
    same_anchors: int
    differences: tuple[PageDifference, ...]
    """Least similar first; pages with equal outlines and tokens are left out."""


def compare(first: Sequence[Page], second: Sequence[Page]) -> ReaderComparison:
    """Compare pages by slug."""
    left = {page.slug: page for page in first}
    right = {page.slug: page for page in second}
    shared = sorted(left.keys() & right.keys())
    pairs = [(left[slug], right[slug]) for slug in shared]
    rows = [_difference(a, b) for a, b in pairs]
    return ReaderComparison(
        shared=tuple(shared),
        only_first=tuple(sorted(left.keys() - right.keys())),
        only_second=tuple(sorted(right.keys() - left.keys())),
        outline_share=sum(row.outline_agrees for row in rows) / len(rows) if rows else 1.0,
        similarity=sum(row.similarity for row in rows) / len(rows) if rows else 1.0,
        identical=sum(a.content_hash == b.content_hash for a, b in pairs),
        same_children=sum(a.children == b.children for a, b in pairs),
        same_breadcrumbs=sum(a.breadcrumbs == b.breadcrumbs for a, b in pairs),
        same_links=sum(a.links == b.links for a, b in pairs),
        same_anchors=sum([s.anchor for s in a.sections] == [s.anchor for s in b.sections] for a, b in pairs),
        differences=tuple(
            sorted(
                (row for row in rows if not row.outline_agrees or row.similarity < 1),
                key=lambda row: (row.similarity, row.slug),
            )
        ),
    )


def _difference(a: Page, b: Page) -> PageDifference:
    first, second = _tokens(a), _tokens(b)
    common = (first & second).total()
    size = first.total() + second.total()
    outlines = (_outline(a), _outline(b))
    return PageDifference(
        slug=a.slug,
        outline_agrees=outlines[0] == outlines[1],
        outlines=outlines,
        similarity=2 * common / size if size else 1.0,
        lost=tuple((first - second).elements()),
        added=tuple((second - first).elements()),
    )


def _outline(page: Page) -> tuple[str, ...]:
    return (page.title, *(f"{'#' * section.level} {section.title}" for section in page.sections))


def _tokens(page: Page) -> Counter[str]:
    return Counter(_TOKEN.findall(page.text.lower()))
