"""Query expansions: for a page, class or function the everyday phrases by which people search for it."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kb_build.summaries.types import PageSummary

# By people who do not know Blender's words, and by those who do.
_FILES = ("query_expansions.txt", "plain_questions.txt")


def query_expansions(summaries: Mapping[str, PageSummary]) -> dict[str, str]:
    """Page slug or symbol path → phrases, separated by semicolons: the pages' come with their summaries."""
    table = load_query_expansions()
    for slug, summary in summaries.items():
        if summary.phrases:
            table[slug] = "; ".join(summary.phrases)
    return table


def load_query_expansions(*, plain: bool = True) -> dict[str, str]:
    """The table of phrases for symbols, with the ``plain`` questions or without; {} where there is none."""
    table: dict[str, str] = {}
    for name in _FILES if plain else _FILES[:1]:
        source = files("corpora") / "words" / name
        lines = source.read_text(encoding="utf-8").splitlines() if source.is_file() else []
        for topic, _, phrases in (line.partition(": ") for line in lines if not line.startswith("#")):
            if phrases:
                table[topic] = f"{table[topic]}; {phrases}" if topic in table else phrases
    return table
