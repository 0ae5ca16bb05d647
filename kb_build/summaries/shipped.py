"""Summaries and phrases that ship with SimWorlds: a language model wrote them once, so that a build needs no key.

They are found by the slug and content of a page: one that has changed since has none. corpora/summaries/README.md says
who wrote them, and under which licence.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING

from kb_build.summaries.prompt import PROMPT_VERSION
from kb_build.summaries.types import PageSummary, summary_key

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.pages.page import Page


@dataclass(frozen=True, slots=True)
class ShippedSummary:
    """A line of a file in corpora/summaries: what was written for a page when its ``content_hash`` was this."""

    slug: str
    content_hash: str
    model: str
    summary: str
    phrases: tuple[str, ...]

    def to_line(self) -> str:
        """The line, without its end."""
        row = [self.slug, self.content_hash, self.model, self.summary, list(self.phrases)]
        return json.dumps(row, ensure_ascii=False, separators=(",", ":"))

    @classmethod
    def from_line(cls, line: str) -> ShippedSummary:
        """What ``to_line`` wrote."""
        slug, content_hash, model, summary, phrases = json.loads(line)
        return cls(slug, content_hash, model, summary, tuple(phrases))


def file_name(version: str, slug: str) -> str:
    """The file of a page of a version's (``5.1``) documentation, made with the present prompt."""
    letters = "a-l" if slug < "m" else "m-z"
    return f"{version}.{letters}.{PROMPT_VERSION}.jsonl"


def shipped_summaries(pages: Iterable[Page]) -> dict[str, PageSummary]:
    """slug → what ships for the page's very content; pages without are absent."""
    wanted = {(page.slug, page.content_hash) for page in pages}
    found: dict[str, PageSummary] = {}
    for file in files("corpora").joinpath("summaries").iterdir():
        if not file.name.endswith(f".{PROMPT_VERSION}.jsonl"):
            continue
        for line in file.read_text(encoding="utf-8").splitlines():
            row = ShippedSummary.from_line(line)
            if (row.slug, row.content_hash) in wanted:
                key = summary_key(row.content_hash, PROMPT_VERSION, row.model)
                found[row.slug] = PageSummary(
                    key, row.summary, "claude", row.model, PROMPT_VERSION, row.phrases
                )
    return found
