"""Query expansions: for a page, class or function the everyday phrases by which people search for it."""

from __future__ import annotations

from importlib.resources import files


def load_query_expansions() -> dict[str, str]:
    """Page slug or symbol path → phrases, separated by semicolons; {} where the package came without the table."""
    source = files("corpora").joinpath("words", "query_expansions.txt")
    if not source.is_file():
        return {}
    lines = source.read_text(encoding="utf-8").splitlines()
    rows = (line.partition(": ") for line in lines if not line.startswith("#"))
    return {topic: phrases for topic, _, phrases in rows if phrases}
