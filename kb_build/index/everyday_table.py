"""The table of everyday words, and what the documentation calls what they mean."""

from __future__ import annotations

from functools import cache
from importlib.resources import files


def everyday_lines() -> list[str]:
    """The lines of the table, ``word: term, term``; none where the package came without it."""
    return _table().splitlines()


def first_term(word: str) -> str:
    """The most likely of the terms of an everyday word, as it is written; "" for other words."""
    _, is_known, behind = f"\n{_table()}".partition(f"\n{word}: ")
    return behind.partition("\n")[0].partition(",")[0].strip() if is_known else ""


@cache
def _table() -> str:
    source = files("corpora") / "words" / "everyday_words.txt"
    return source.read_text(encoding="utf-8") if source.is_file() else ""
