"""Query expansions: for a page, class or function the everyday phrases by which people search for it.

They are written once, for symbols of the version in which these have their present names.
"""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Mapping

    from kb_build.summaries.types import PageSummary
    from kb_build.versions.removed_symbols import RemovedSymbols

# By people who do not know Blender's words, and by those who do.
_FILES = ("query_expansions.txt", "plain_questions.txt")


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


def placed_expansions(
    table: Mapping[str, str], known: Container[str], removed_symbols: Callable[[], RemovedSymbols]
) -> dict[str, str]:
    """The phrases for the symbols that a version knows: those of one that it lacks are said of what it has in its
    place. ``removed_symbols`` is called only if it lacks one, as it may still be computed.
    """
    lacking = [path for path in table if path not in known]
    placed = {path: phrases for path, phrases in table.items() if path in known}
    instead: dict[str, str] = {}
    if lacking:
        for path, position, successor, *_ in removed_symbols().successors:
            if not position:
                instead[path] = successor
    for path in lacking:
        other = instead.get(path, "")
        if other in known:
            placed[other] = f"{placed[other]}; {table[path]}" if other in placed else table[path]
    return placed


def query_expansions(summaries: Mapping[str, PageSummary]) -> dict[str, str]:
    """All phrases as they were written: page slug or symbol path → phrases, separated by semicolons."""
    return load_query_expansions() | page_expansions(summaries)


def page_expansions(summaries: Mapping[str, PageSummary]) -> dict[str, str]:
    """Page slug → phrases, separated by semicolons: they come with the summaries."""
    return {slug: "; ".join(summary.phrases) for slug, summary in summaries.items() if summary.phrases}
