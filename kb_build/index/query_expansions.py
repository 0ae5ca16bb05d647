"""Query expansions: for a page, class or function the everyday phrases by which people search for it."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kb_build.summaries.types import PageSummary


def query_expansions(summaries: Mapping[str, PageSummary]) -> dict[str, str]:
    """Page slug or symbol path → phrases, separated by semicolons: the pages' come with their summaries."""
    table = load_query_expansions()
    for slug, summary in summaries.items():
        if summary.phrases:
            table[slug] = "; ".join(summary.phrases)
    return table


def load_query_expansions() -> dict[str, str]:
    """The table of phrases for symbols; {} where the package came without it."""
    source = files("corpora").joinpath("words", "query_expansions.txt")
    if not source.is_file():
        return {}
    lines = source.read_text(encoding="utf-8").splitlines()
    rows = (line.partition(": ") for line in lines if not line.startswith("#"))
    return {topic: phrases for topic, _, phrases in rows if phrases}
