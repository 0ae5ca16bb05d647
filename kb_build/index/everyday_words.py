"""Everyday words that the documentation hardly uses, and where it speaks of what they mean."""

from __future__ import annotations

from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np

from kb_build.index.analysis import stem, terms
from kb_build.index.everyday_table import everyday_lines
from kb_build.index.postings import NOWHERE, PostingList

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    # A word's stem → the stems of each of its terms, the most likely term first.
    EverydayWords = Mapping[str, tuple[tuple[str, ...], ...]]
    # A term's stems → the documents that say most of it, and how much.
    _SaidMost = Callable[[tuple[str, ...]], list[tuple[int, float]]]

_KNOWN = 30  # documents; a word with more of its own says what it means by itself
_SHARE = 0.15  # of what a term's document says of the term, what it says of the everyday word
_LESS_LIKELY = 0.85
_MOST = 100  # documents that a term lends: those that say most of it


def load_everyday_words() -> EverydayWords:
    """The table of everyday words; {} where the package came without it."""
    return read_everyday_words(everyday_lines())


def read_everyday_words(lines: Iterable[str]) -> EverydayWords:
    """Reads lines such as ``plume: smoke, volume scatter``; those that begin with ``#`` are comments."""
    rows = (line.partition(": ") for line in lines if not line.startswith("#"))
    table: dict[str, tuple[tuple[str, ...], ...]] = {}
    for word, _, told in rows:
        stems = tuple(tuple(terms(term)) for term in told.split(","))
        table[stem(word.strip())] = (*table.get(stem(word.strip()), ()), *filter(None, stems))
    return table


def unknown_of(words: EverydayWords, units: Mapping[str, PostingList]) -> EverydayWords:
    """Those of the words that the documentation hardly uses."""
    return {word: told for word, told in words.items() if len(units.get(word, NOWHERE).numbers) < _KNOWN}


def lend(postings: dict[str, PostingList], words: EverydayWords) -> None:
    """Adds to the posting lists of words the documents of their terms, where these say most of them.

    A term of several stems lends the documents that have all of them. Documents that have the word itself stay as they
    are.
    """
    # Many words share a term.
    said_most = cache(partial(_said_most, postings))
    lent = {word: _lent(its_terms, said_most) for word, its_terms in words.items()}
    for word, weights in lent.items():
        if weights:
            own = postings.get(word, NOWHERE)
            together = {**weights, **dict(zip(own.numbers.tolist(), own.weights.tolist(), strict=True))}
            numbers = sorted(together)
            postings[word] = PostingList(
                np.array(numbers, np.intp), np.array([together[number] for number in numbers])
            )


def _lent(its_terms: Iterable[tuple[str, ...]], said_most: _SaidMost) -> dict[int, float]:
    """The documents that a word is lent by its terms, and what they say of it."""
    weights: dict[int, float] = {}
    share = _SHARE
    for stems in its_terms:
        for number, weight in said_most(stems):
            if share * weight > weights.get(number, 0.0):
                weights[number] = share * weight
        share *= _LESS_LIKELY
    return weights


def _said_most(postings: Mapping[str, PostingList], stems: tuple[str, ...]) -> list[tuple[int, float]]:
    """The documents that have all of the stems and say most of them: of the one of which they say least."""
    (numbers, weights), *others = sorted(
        (postings.get(stem, NOWHERE) for stem in stems), key=lambda one: len(one.numbers)
    )
    for other in others:
        numbers, own, its = np.intersect1d(numbers, other.numbers, assume_unique=True, return_indices=True)
        weights = np.minimum(weights[own], other.weights[its])
    best = np.argsort(-weights, kind="stable")[:_MOST]
    return [*zip(numbers[best].tolist(), weights[best].tolist(), strict=True)]
