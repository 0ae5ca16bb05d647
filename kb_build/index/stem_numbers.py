"""The words of texts as numbers, so that numpy can count them."""

from __future__ import annotations

from array import array
from collections import defaultdict
from functools import cache
from itertools import chain, count
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from kb_build.index.analysis import terms_in, tokens

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Numbers = NDArray[np.intp]

_TOKEN = np.dtype("i")  # of array("i")


class StemRows(NamedTuple):
    """For each time that a document has a stem: the document's number and the stem's, by document."""

    documents: Numbers
    stems: Numbers


class StemNumbers:
    """Numbers the tokens of texts and their stems, as they come. A text is read once: many come several times, in
    units, topics and phrases.
    """

    def __init__(self) -> None:
        self._tokens: dict[str, int] = defaultdict(count().__next__)
        self._stems: dict[str, int] = defaultdict(count().__next__)
        self._of_token: list[tuple[int, ...]] = []  # a token's stems, by its number
        self._read = cache(self._numbered)

    def _numbered(self, text: str) -> array[int]:
        return array("i", map(self._tokens.__getitem__, tokens(text)))

    @property
    def stems(self) -> list[str]:
        """The stems by number."""
        return list(self._stems)

    def token_counts(self, texts: Sequence[str]) -> list[tuple[str, int]]:
        """(token, how often it stands in the texts) of those that do."""
        numbers = np.frombuffer(b"".join(map(self._read, texts)), _TOKEN)
        counts = np.bincount(numbers, minlength=len(self._tokens)).tolist()
        return [(token, times) for token, times in zip(self._tokens, counts, strict=True) if times]

    def rows(self, documents: Sequence[Sequence[str]]) -> StemRows:
        """The stems of documents, each given by its texts."""
        read = [[*map(self._read, texts)] for texts in documents]
        numbers = np.frombuffer(b"".join(chain.from_iterable(read)), _TOKEN)
        lengths = np.fromiter((sum(map(len, texts)) for texts in read), np.intp, len(read))
        stems, starts = self._table()
        # A token has several stems (`ClothSettings`), or none (`the`): each stem gives a row.
        having = starts[numbers + 1] - starts[numbers]
        ends = np.cumsum(having)
        total = int(ends[-1]) if len(ends) else 0
        places = np.arange(total) + np.repeat(starts[numbers] - (ends - having), having)
        return StemRows(np.repeat(np.repeat(np.arange(len(read)), lengths), having), stems[places])

    def _table(self) -> tuple[Numbers, Numbers]:
        """All tokens' stems one after another, and for each token the place where its own begin, and then the end."""
        for token in list(self._tokens)[len(self._of_token) :]:
            self._of_token.append(tuple(self._stems[stem] for stem in terms_in(token)))
        flat = np.fromiter(chain.from_iterable(self._of_token), np.intp)
        starts = np.zeros(len(self._of_token) + 1, np.intp)
        np.cumsum([*map(len, self._of_token)], out=starts[1:])
        return flat, starts
