"""What people ask for when they mean a topic: phrases in everyday words, one line a page, class or function."""

from __future__ import annotations

from importlib.resources import files


def load_uses() -> dict[str, str]:
    """Page slug or symbol path → phrases, separated by semicolons; {} where the package came without the table."""
    source = files("corpora").joinpath("words", "uses.txt")
    if not source.is_file():
        return {}
    lines = source.read_text(encoding="utf-8").splitlines()
    rows = (line.partition(": ") for line in lines if not line.startswith("#"))
    return {topic: phrases for topic, _, phrases in rows if phrases}
