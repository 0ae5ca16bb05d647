"""The table of everyday words, and what the documentation calls what they mean."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping


def everyday_lines() -> list[str]:
    """The lines of the table, ``word: term, term``; none where the package came without it."""
    source = files("corpora").joinpath("words", "everyday_words.txt")
    return source.read_text(encoding="utf-8").splitlines() if source.is_file() else []


@cache
def load_first_terms() -> Mapping[str, str]:
    """Everyday word → the most likely of its terms, both as they are written."""
    rows = (line.partition(": ") for line in everyday_lines() if not line.startswith("#"))
    return {word: told.partition(",")[0].strip() for word, _, told in rows}
