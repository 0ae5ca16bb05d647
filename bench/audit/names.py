"""Matches names of objects with phrases, by words: case, plural, joining and numeric suffixes do not matter."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

_LIBRARY = re.compile(r"\s*\[[^\]]*\]$")  # how a linked data-block's full name ends
_CAMEL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_WORD = re.compile(r"[^\W\d_]+")
# Words that say what kind of data-block it is, not what it shows.
_NOISE = frozenset({
    "a", "an", "asset", "base", "coll", "collection", "copy", "final", "geo", "geom", "geometry", "group", "grp",
    "main", "mesh", "model", "new", "obj", "object", "root", "sim", "simulated", "simulation", "the",
})  # fmt: skip
_PLURALS = (
    ("ies", "y"), ("ves", "f"), ("sses", "ss"), ("xes", "x"), ("ches", "ch"), ("shes", "sh"), ("oes", "o"),
)  # fmt: skip
# Words after one of these say where the object is, or what it is a part of.
_BEFORE = frozenset({
    "above", "against", "at", "behind", "below", "beside", "by", "for", "from", "in", "inside", "near", "of", "on",
    "onto", "over", "to", "under", "with",
})  # fmt: skip


@cache
def words_of(name: str) -> tuple[str, ...]:
    """The words of a name, lower case, singular, without numbers and noise: ``"RedCushions.001"`` → red, cushion."""
    spaced = _CAMEL.sub(" ", _LIBRARY.sub("", name))
    words = [_singular(word.casefold()) for word in _WORD.findall(spaced)]
    return tuple(word for word in words if word not in _NOISE) or tuple(words)


def _singular(word: str) -> str:
    if len(word) <= 3:
        return word
    for ending, single in _PLURALS:
        if word.endswith(ending) and len(word) > len(ending) + 2:
            return word[: -len(ending)] + single
    return word[:-1] if word.endswith("s") and not word.endswith(("ss", "us", "is")) else word


@dataclass(frozen=True, slots=True, order=True)
class NameMatch:
    """How well a name fits a phrase; greater is better.

    ``quality``: 3 the name is the phrase, 2 it contains the phrase, 1 it contains it as a place (``rug under table``).
    ``end``: number of words up to the phrase's end (the last noun is the head). ``length``: letters of the phrase.
    """

    quality: int
    end: int
    length: int


def match_name(name: str, phrases: Iterable[str]) -> NameMatch | None:
    """The best match of a name with any of the phrases; None without a match."""
    name_words = words_of(name)
    head = next(
        (place for place, word in enumerate(name_words) if place and word in _BEFORE), len(name_words)
    )
    matches = [_match(name_words, head, "".join(words_of(phrase))) for phrase in phrases]
    return max((match for match in matches if match is not None), default=None)


def _match(words: tuple[str, ...], head: int, phrase: str) -> NameMatch | None:
    best: NameMatch | None = None
    for first in range(len(words)):
        joined, last = "", first - 1
        while last + 1 < len(words) and len(joined) < len(phrase):
            last += 1
            joined += words[last]
        if joined != phrase or not phrase:
            continue
        whole = first == 0 and last == len(words) - 1
        match = NameMatch(3 if whole else 2 if last < head else 1, last + 1, len(phrase))
        best = match if best is None else max(best, match)
    return best
