"""Searches the base for a query in plain words.

BM25F over two levels (a unit and the topic around it) finds units, and signals (:mod:`kb_serve.rank.signals`) rank
them. Then comes variety: one class or page gives one hit before the others had theirs, and so do the members of one
name, and a class with the page that explains it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from kb_build.index.analysis import stem, stems_of, words
from kb_build.schema import DOCUMENT_KINDS
from kb_build.symbols.api_names import NODE, OPERATORS
from kb_serve.rank.asked_words import wants_script
from kb_serve.rank.inverted_index import InvertedIndex
from kb_serve.rank.query_words import QueryWords
from kb_serve.rank.scoring import Concept, said_phrases, score_all
from kb_serve.rank.signals import Evidence, scores_of
from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence, Set

    from numpy.typing import NDArray

    from kb_serve.rank.inverted_index import Scores
    from kb_serve.reader import BaseReader

COVERAGE = True  # whether a document counts by the share of the query that it speaks of
TOPIC_WEIGHT = 0.4
ALONE = 0.5  # what stands in for the topic of a unit that has none
_CANDIDATES = 400
_DIFFERENT = 4  # hits, before what says the same as one of them may follow
_OF_A_CHAPTER = 3
_WORDS_OF_A_NAME = 2  # of an operator's name that a query hardly says by chance
# What it counts that a query says a member's name and its owner's, or a node's label, next to an operator's name.
_AS_MEMBER = 0.3
_AS_NODE = 0.6
_KINDS = frozenset(map(stem, ("modifier", "constraint", "node")))  # who says one means no operator without it
_NEAREST = 30  # units by their texts, among which such a name is looked for
_OTHERS = 0.4  # share of what further phrases add to the nearest that counts
_MEMBERS = 3  # of a class that are told with it
_NEAR = 0.35  # share of the best member's score below which another one is not told
_NO_NAME = frozenset[str]()
_INDEX, _NODE = map(DOCUMENT_KINDS.index, ("index", "node"))


class SearchHit(NamedTuple):
    """One ranked unit: a symbol path or a page's slug, and the anchor of the section that was found; of a class or
    module the names of those members that speak most of the query. ``chapter``: see Level.
    """

    ref: str
    anchor: str
    score: float
    members: tuple[str, ...] = ()
    chapter: int = -1


@value_class
class _Ranked:
    """Units, best first: their numbers, scores and topics."""

    numbers: list[int]
    scores: Scores
    topics: NDArray[np.int32]


class Searcher:
    """Searches one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self.index = InvertedIndex(reader)
        self.words = QueryWords(reader, self.index)

    def search(self, text: str, limit: int = 50, *, failed: bool = False, about: str = "") -> list[SearchHit]:
        """The best documents for a text, best first, each id once. ``failed`` where it is an error's message; ``about``
        are words around it, which count less.
        """
        if (found := self.find(text, failed=failed, about=about)) is None:
            return []
        numbers, evidence = found
        scores = scores_of(evidence)
        order = best_first(scores, len(scores))
        numbers = numbers[order]
        topics = self.index.levels[0].topics[numbers]
        ranked = _Ranked(numbers.tolist(), scores[order], topics)
        best = _with_text_first(evidence.kinds[order].tolist())
        return [self._hit(place, ranked) for place in self._varied(best, ranked, limit)]

    def found(self, text: str) -> Iterator[tuple[str, float]]:
        """The units that speak of a class and a name, best first, with their scores: each section of a page is one.
        That a member is called by its class says nothing there.
        """
        if (found := self.find(text)) is None:
            return
        numbers, evidence = found
        scores = scores_of(replace(evidence, called=None))
        for place in best_first(scores, len(scores)).tolist():
            yield self.index.levels[0].refs[numbers[place]], float(scores[place])

    def _hit(self, place: int, ranked: _Ranked) -> SearchHit:
        """The hit at a place, with the members of it that rank best."""
        units, topics = self.index.levels
        number, topic = ranked.numbers[place], ranked.topics[place]
        ref = units.refs[number]
        members: list[str] = []
        if topic >= 0 and topics.refs[topic] == ref and not self._reader.manual.is_page(ref):
            below = (ranked.topics == topic).nonzero()[0][: _MEMBERS + 1].tolist()
            near = [
                units.refs[ranked.numbers[other]]
                for other in below
                if ranked.scores[other] >= _NEAR * ranked.scores[below[0]]
            ]
            members = [other.removeprefix(f"{ref}.") for other in near if other.startswith(f"{ref}.")]
        return SearchHit(
            ref,
            units.anchors[number],
            float(ranked.scores[place]),
            tuple(members[:_MEMBERS]),
            int(units.chapters[number]),
        )

    def find(
        self, text: str, *, failed: bool = False, about: str = ""
    ) -> tuple[NDArray[np.intp], Evidence] | None:
        """The units that speak most of a text: their numbers, and what is known of them. None if there are none."""
        concepts = [*self.words.concepts(text), *self.words.around(about, text)]
        units = self.index.levels[0]
        scores, coverage = score_all(self.index, concepts)
        (numbers,) = (coverage[: units.count] > 0).nonzero()
        if not len(numbers):
            return None
        told = scores * coverage if COVERAGE else scores
        own, topic = told[numbers], self.index.topics[numbers]
        around = np.where(topic < self.index.ends[1], told[topic], ALONE * own)
        texts = _float32(own + TOPIC_WEIGHT * around)
        best = best_first(texts, _CANDIDATES)
        numbers, texts, topic = numbers[best], texts[best], topic[best]
        said = frozenset(words(text))
        evidence = Evidence(
            said,
            failed,
            texts,
            self._asked(concepts, numbers, topic),
            self.index.counts[numbers],
            self.index.areas[numbers],
            units.chapters[numbers],
            units.kinds[numbers],
            self.index.symbols[numbers],
            self._called(numbers, concepts, with_nodes=not wants_script(said)),
        )
        return numbers, evidence

    def _called(
        self, numbers: NDArray[np.intp], concepts: Sequence[Concept], *, with_nodes: bool
    ) -> Scores | None:
        """The share of the query that the names of operators are, of some words, which the query says whole, and in
        part that the labels of nodes are (``with_nodes``), and the names of members with their owners'; None if it says
        none.
        """
        asked = {concept.stem: concept.idf for concept in concepts}
        said = frozenset(asked)
        kinds = said & _KINDS
        called: Scores | None = None
        units = self.index.levels[0]
        nearest = numbers[:_NEAREST]
        for place, (number, kind) in enumerate(
            zip(nearest.tolist(), units.kinds[nearest].tolist(), strict=True)
        ):
            ref = units.refs[number]
            label = self._node_labels.get(ref) if kind == _NODE and with_nodes else None
            name, counts = _said_name(ref, said, kinds) if label is None else (stems_of(label), _AS_NODE)
            if len(name) >= _WORDS_OF_A_NAME and name <= said:
                called = np.zeros(len(numbers), np.float32) if called is None else called
                called[place] = counts * sum(asked[part] for part in name) / sum(asked.values())
        return called

    @cached_property
    def _node_labels(self) -> dict[str, str]:
        """The labels of the classes of nodes."""
        return self._reader.labels_below(NODE)

    def _asked(
        self, concepts: Sequence[Concept], numbers: NDArray[np.intp], topic: NDArray[np.intp]
    ) -> Scores:
        """How nearly the query is, word by word, what units or their topics are asked for, from 0: nothing.

        The nearest phrase counts, and in part what all of the same add up to, in the power of 1.5: a question often
        mixes the words of a few.
        """
        places = np.concatenate((numbers, topic))
        wanted = np.zeros(self.index.ends[1] + 1, np.bool_)  # the last: of the units that have no topic
        wanted[places] = True
        said = said_phrases(self.index, concepts, wanted)
        near = np.sqrt(np.minimum(said.shares, 1) * said.coverage)
        nearest = np.zeros(len(wanted), np.float32)
        np.maximum.at(nearest, said.asked, near)
        sums = np.bincount(said.asked, near * np.sqrt(near), len(wanted))
        best, summed = nearest[places], sums[places]
        asked = best + _OTHERS * (np.cbrt(summed * summed) - best)
        return _float32(np.maximum(asked[: len(numbers)], asked[len(numbers) :]))

    def _varied(self, order: Iterable[int], ranked: _Ranked, limit: int) -> list[int]:
        """Of the places of ranked units each ref's first, and the first member of a name before other members of that
        name.

        A class or operator and the page that explains it say the same: the second of them waits until the first
        few different things have been named. So does the fourth of a chapter, as the query may mean another one.
        """
        units = self.index.levels[0]
        first: list[int] = []
        waiting: list[int] = []
        later: list[int] = []
        seen: set[str | int] = set()
        chapters: dict[int, int] = {}  # how many of each are among the first
        for place in order:
            number = ranked.numbers[place]
            ref = units.refs[number]
            if ref in seen:
                continue
            name = f".{ref.rpartition('.')[2]}" if units.members[number] else ref
            explained, chapter = int(units.explained[number]), int(units.chapters[number])
            if name in seen:
                later.append(place)
            elif len(first) < _DIFFERENT and (explained in seen or chapters.get(chapter) == _OF_A_CHAPTER):
                waiting.append(place)
            else:
                first.append(place)
                chapters[chapter] = chapters.get(chapter, 0) + 1
                if len(first) == _DIFFERENT:
                    first += waiting
            seen.update((ref, name))
            if explained >= 0:
                seen.add(explained)
            if len(first) >= limit:
                return first[:limit]
        few = waiting if len(first) < _DIFFERENT else []
        return [*first, *few, *later][:limit]


def _said_name(ref: str, said: Set[str], kinds: Set[str]) -> tuple[Set[str], float]:
    """(the words that a symbol is called by, how much it counts that a query says them), if they are all ``said``: an
    operator by its own name, with the ``kinds`` of things that are asked for; a member by its owner's and its own, if
    that adds something.
    """
    path, _, last = ref.rpartition(".")
    # Most are pages, which have no owner, or are not said: their names need no more looking at.
    if not path or not (own := stems_of(last)) <= said:
        return _NO_NAME, 0.0
    if ref.startswith(OPERATORS):
        return (own, 1.0) if own >= kinds else (_NO_NAME, 0.0)
    owners = stems_of(path.rpartition(".")[2])
    return (owners | own, _AS_MEMBER) if owners <= said and not own <= owners else (_NO_NAME, 0.0)


def _float32(values: NDArray[Any]) -> Scores:
    return values.astype(np.float32, copy=False)


def _with_text_first(kinds: Sequence[int]) -> Iterator[int]:
    """The places of units, of which the kinds are given: the best that has a text before those of pages without."""
    hollow: list[int] = []
    rest = iter(range(len(kinds)))
    for place in rest:
        if kinds[place] != _INDEX:
            yield place
            break
        hollow.append(place)
    yield from hollow
    yield from rest


def best_first(scores: Scores, count: int) -> NDArray[np.intp]:
    """The places of the ``count`` highest scores, all above 0, highest first, equal ones in their order.

    The bits of such numbers ascend as they do. Sorted as whole numbers, with their places behind them, they take a
    third of the time.
    """
    keys = np.left_shift(~scores.view(np.uint32), 32, dtype=np.uint64)
    keys |= np.arange(len(keys), dtype=np.uint64)
    if count < len(keys):
        keys.partition(count)
        keys = keys[:count]
    keys.sort()
    return keys.astype(np.uint32).astype(np.intp)
