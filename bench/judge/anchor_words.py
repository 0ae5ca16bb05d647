"""Compares a judged item with the words of the prompt that it stands on, by the stems of their content words.

The judge has a tokenizer of its own: what items it accepts must not change when retrieval is tuned.
"""

from __future__ import annotations

import re
from functools import cache
from typing import Any

import snowballstemmer

_WORD = re.compile(r"[^\W\d_]+|\d+(?:\.\d+)?")
_SHORTEST_STEMMED = 4  # letters
# Function words: sharing one of them does not make two texts speak of the same thing.
_STOP_WORDS = frozenset(
    """a about after all also am an and any are as at be because been before being but by can cannot could did do
    does doing don done each either else every etc few for from get gets getting go goes going got had has have
    having he her here hers him his how however i if in instead into is isn it its just let like make makes making
    many may me might more most much must my need needs no nor not now of on one only onto or other our out own per
    please rather s same shall she should so some still such t than that the their them then there these they thing
    things this those to too until up upon us very via want wants was way we were what when where whether which
    while who whole whom whose why will with without would yet you your
    """.split()  # noqa: SIM905 - a hundred words read best as a paragraph
)


def content_stems(text: str) -> list[str]:
    """The stems of a text's content words, in order."""
    words = _WORD.findall(text.lower())
    return [_stem(word) for word in words if word not in _STOP_WORDS]


@cache
def _stemmer() -> Any:
    return snowballstemmer.stemmer("english")


def _stem(word: str) -> str:
    return word if len(word) < _SHORTEST_STEMMED else str(_stemmer().stemWord(word))
