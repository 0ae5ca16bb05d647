"""TF-IDF index of candidates' features, for comparing one bag of features with all candidates at once."""

from __future__ import annotations

import math
import re
from bisect import bisect_left
from collections import Counter
from itertools import takewhile
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections import defaultdict
    from collections.abc import Callable, Iterable, Sequence

_FEW = 8
_WORD = re.compile(r"[a-z]{3,}")

Bag = dict[str, float]


class FeatureIndex:
    """TF-IDF vectors of length 1. Features that more than ``common`` bags hold do not find a candidate."""

    def __init__(self, bags: Sequence[Bag], common: int) -> None:
        df = Counter(name for bag in bags for name in bag)
        self._df = df
        self._sorted = sorted(df)
        self._idf = {name: math.log(1 + len(bags) / count) for name, count in df.items()}
        # A feature that no candidate has takes its share of the length, but not the largest.
        self._unknown = math.log(1 + len(bags)) / 2
        self._vectors = [self.vector(bag) for bag in bags]
        self._postings: dict[str, list[tuple[int, float]]] = {
            name: [] for name, count in df.items() if count <= common
        }
        for number, vector in enumerate(self._vectors):
            for name, weight in vector.items():
                if (postings := self._postings.get(name)) is not None:
                    postings.append((number, weight))

    def __contains__(self, name: str) -> bool:
        return name in self._idf

    def df(self, name: str) -> int:
        """How many candidates have the feature."""
        return self._df[name]

    def has(self, number: int, name: str) -> bool:
        """Whether a candidate has the feature."""
        return name in self._vectors[number]

    def starting_with(self, prefix: str) -> list[str]:
        """The features that begin so."""
        first = bisect_left(self._sorted, prefix)
        return list(takewhile(lambda name: name.startswith(prefix), self._sorted[first : first + _FEW]))

    def vector(self, bag: Bag) -> Bag:
        """The bag weighted by rarity, its length made 1."""
        weighted = {name: weight * self._idf.get(name, self._unknown) for name, weight in bag.items()}
        length = math.sqrt(sum(weight * weight for weight in weighted.values())) or 1.0
        return {name: weight / length for name, weight in weighted.items()}

    def add_cosines(self, vector: Bag, factor: float, scores: defaultdict[int, float]) -> None:
        """Adds ``factor`` times the cosine to the score of all that share a feature which is not common."""
        for name, weight in vector.items():
            share = weight * factor
            for number, other in self._postings.get(name, ()):
                scores[number] += share * other

    def add_common(self, vector: Bag, numbers: Iterable[int], scores: defaultdict[int, float]) -> None:
        """Adds, for the candidates named, what the common features contribute to the cosine."""
        common = {name: weight for name, weight in vector.items() if name not in self._postings}
        for number in numbers:
            other = self._vectors[number]
            for name, weight in common.items():
                scores[number] += weight * other.get(name, 0.0)


class Mentions:
    """Which texts mention a rare word. ``texts`` are one a candidate; words are folded by ``fold``."""

    def __init__(self, texts: Iterable[str], common: int, fold: Callable[[str], str]) -> None:
        by_word: dict[str, list[int]] = {}
        number = -1
        for number, text in enumerate(texts):
            for word in set(_WORD.findall(text.lower())):
                by_word.setdefault(word, []).append(number)
        folded: dict[str, set[int]] = {}
        for word, numbers in by_word.items():
            folded.setdefault(fold(word), set()).update(numbers)
        self._count = number + 1
        self._found = {word: numbers for word, numbers in folded.items() if len(numbers) <= common}
        self._usual = math.log(1 + self._count / common)

    def coverage(self, wanted: Iterable[str], besides: FeatureIndex) -> dict[int, float]:
        """Candidate → the share of the ``wanted`` words, weighted by rarity, that its text mentions.

        A word that the candidate has among its features in ``besides`` is no news and does not count.
        """
        weights = {word: self._weight(word) for word in wanted}
        total = sum(weights.values())
        scores: dict[int, float] = {}
        for word, weight in weights.items():
            for number in self._found.get(word, ()):
                if not besides.has(number, word):
                    scores[number] = scores.get(number, 0.0) + weight / total
        return scores

    def _weight(self, word: str) -> float:
        numbers = self._found.get(word)
        return math.log(1 + self._count / len(numbers)) ** 2 if numbers else self._usual
