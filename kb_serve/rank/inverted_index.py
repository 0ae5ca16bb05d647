"""The inverted index of a base, as numpy arrays: its documents, what they are asked for by, the postings of stems.

All is numbered through: first the units, then the topics around them, then the phrases that ask for either.
"""

from __future__ import annotations

import math
from functools import cache, cached_property
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kb_build.index.analysis import idf
from kb_build.schema import DOCUMENT_KINDS, POSTING_BYTES, TOPICS, UNITS
from kb_serve.lookups.kept_rows import KeptRows
from kb_serve.rank.areas import NO_AREA, area_of
from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_serve.reader import BaseReader

Scores = NDArray[np.float32]

K1 = 2.2
_PAGES = 2.0  # what a page counts, as pages are not weighed: as much as a symbol that is often used
_NUMBER_BYTES = 4
_INFINITE = 0x7C00  # the bits of weights that are finite, and not below 0, are fewer
_KEPT = 150  # stems; a query has a dozen at most


@value_class
class Level:
    """The documents of one level, by number; ``explained``: a number for the page that explains them, or -1, ``kinds``:
    places in DOCUMENT_KINDS.
    """

    count: int
    refs: list[str]
    anchors: list[str]
    topics: NDArray[np.int32]
    chapters: NDArray[np.int32]
    explained: NDArray[np.int32]
    kinds: NDArray[np.uint8]
    members: NDArray[np.bool_]


@value_class
class StemPostings:
    """The documents and phrases that have a stem, and for each how much it says of it: of documents, BM25's saturated
    frequency; of phrases, the share that a unit of idf is of all that the phrase tells.

    ``units`` and ``documents``: how many of them are those, which stand before the phrases; ``idf``: how much the stem
    tells, 0 if no unit has it.
    """

    numbers: NDArray[np.intp]
    saturated: Scores
    units: int
    documents: int
    idf: float


_NOWHERE = StemPostings(np.zeros(0, np.intp), np.zeros(0, np.float32), 0, 0, 0.0)


class InvertedIndex:
    """The inverted index of one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        # Where a stem stands; nowhere, if it is unknown.
        self.postings = KeptRows(self._read_postings, _NOWHERE, _KEPT)

    @cached_property
    def levels(self) -> tuple[Level, Level]:
        """Units and topics. Raises BaseUnreadable."""
        names: dict[str, str] = {}
        units, topics = self._read_level(UNITS, names), self._read_level(TOPICS, names)
        if not _within(units.topics, -1, topics.count):
            raise self._reader.damaged("its index refers to topics that do not exist")
        return units, topics

    @cached_property
    def areas(self) -> NDArray[np.uint8]:
        """For each unit its area (see area_of): that of a page, and of what is of one chapter with it."""
        units, _ = self.levels
        areas = np.full(units.count, NO_AREA, np.uint8)  # of chapters, which are numbered by their units
        for chapter, slug in zip(units.chapters.tolist(), units.refs, strict=True):
            if (area := area_of(slug)) != NO_AREA:
                areas[chapter] = area
        return areas[units.chapters]

    @cached_property
    def asked(self) -> NDArray[np.int32]:
        """For each phrase the number of the document that it asks for. Raises BaseUnreadable."""
        try:
            ((targets,),) = self._reader.rows("SELECT targets FROM phrases")
            asked = np.frombuffer(targets, np.int32)
        except (ValueError, TypeError) as error:
            raise self._reader.damaged(error) from error
        if not _within(asked, 0, sum(level.count for level in self.levels)):
            raise self._reader.damaged("its phrases refer to documents that do not exist")
        return asked

    @cached_property
    def ends(self) -> tuple[int, int, int]:
        """The numbers at which units, topics and phrases end."""
        units, topics = (level.count for level in self.levels)
        return units, units + topics, units + topics + len(self.asked)

    @cached_property
    def topics(self) -> NDArray[np.intp]:
        """For each unit the number of its topic among all documents; of those that have none, the one behind them."""
        units, documents, _ = self.ends
        own = self.levels[0].topics.astype(np.intp)
        return np.where(own >= 0, units + own, documents)

    @cached_property
    def counts(self) -> Scores:
        """How much each unit counts among its like, on a scale that begins at 0. Raises BaseUnreadable."""
        weights: list[tuple[str, float]] = self._reader.rows("SELECT path, weight FROM weights")
        try:
            own = {path: math.log1p(weight) for path, weight in weights}
        except (ValueError, TypeError) as error:
            raise self._reader.damaged(error) from error
        own |= dict.fromkeys(self._reader.manual.slugs, _PAGES)
        return np.array([own.get(ref, 0.0) for ref in self.levels[0].refs], np.float32)

    @cached_property
    def symbols(self) -> Scores:
        """1 for each unit that is a symbol, no page."""
        return np.array([not self._reader.manual.is_page(ref) for ref in self.levels[0].refs], np.float32)

    def idf(self, stem: str) -> float:
        """How much a stem tells, by the units that have it; 0 for an unknown one."""
        return self.postings(stem).idf

    def _read_level(self, level: int, names: dict[str, str]) -> Level:
        """The documents of a level; equal ``names`` become one text, as a page stands for each of its sections."""
        sql = """SELECT count, refs, anchors, topics, chapters, explained, kinds, members FROM levels
            WHERE level = ?"""
        try:
            ((count, refs, anchors, topics, chapters, explained, kinds, members),) = self._reader.rows(
                sql, level
            )
            read = Level(
                count,
                [names.setdefault(ref, ref) for ref in refs.split("\n")] if count else [],
                [names.setdefault(anchor, anchor) for anchor in anchors.split("\n")] if count else [],
                np.frombuffer(topics, np.int32),
                np.frombuffer(chapters, np.int32),
                np.frombuffer(explained, np.int32),
                np.frombuffer(kinds, np.uint8),
                np.frombuffer(members, np.bool_),
            )
        except (ValueError, TypeError, AttributeError) as error:
            raise self._reader.damaged(error) from error
        columns = (
            read.refs, read.anchors, read.topics, read.chapters, read.explained, read.kinds, read.members
        )  # fmt: skip
        sound = all(len(column) == count for column in columns)
        if not (sound and _within(read.chapters, 0, count) and _within(read.kinds, 0, len(DOCUMENT_KINDS))):
            raise self._reader.damaged(f"level {level} of its index")
        return read

    def _read_postings(self, stems: Sequence[str]) -> dict[str, StemPostings]:
        """Those of some stems, checked and weighed all at once, which costs less than one by one."""
        rows: list[tuple[str, int, bytes]] = self._reader.rows_of(
            "SELECT stem, units, data FROM postings WHERE stem", stems
        )
        if not rows:
            return {}
        try:
            lengths = [len(data) // POSTING_BYTES for *_, data in rows]
            # The numbers' bytes of each stem stand before those of their weights.
            cuts = [_NUMBER_BYTES * length for length in lengths]
            numbers = np.frombuffer(
                b"".join(data[:cut] for (*_, data), cut in zip(rows, cuts, strict=True)), np.uint32
            )
            weights = np.frombuffer(
                b"".join(data[cut:] for (*_, data), cut in zip(rows, cuts, strict=True)), np.uint16
            )
        except (ValueError, TypeError) as error:
            raise self._reader.damaged(error) from error
        units, documents, end = self.ends
        starts = [0, *accumulate(lengths)]
        sound = (
            len(numbers) == len(weights) and _within(numbers, 0, end) and bool((weights < _INFINITE).all())
        )
        if not (sound and _ascend(numbers, starts)):
            raise self._reader.damaged(f"the postings of {', '.join(stem for stem, *_ in rows)}")
        plain, of_documents = _values_of_weights()
        saturated = of_documents.take(weights, mode="clip")
        places = numbers.astype(np.intp)  # which numpy looks up faster
        found: dict[str, StemPostings] = {}
        # Parts of what is kept and forgotten together.
        for (stem, having, _), (first, last) in zip(rows, pairwise(starts), strict=True):
            own = places[first:last]
            phrases = int(own.searchsorted(documents))
            if first + phrases < last:
                saturated[first + phrases : last] = plain.take(weights[first + phrases : last], mode="clip")
            found[stem] = StemPostings(own, saturated[first:last], having, phrases, idf(units, having))
        return found


@cache
def _values_of_weights() -> tuple[Scores, Scores]:
    """What each weight is by its bits: itself, and saturated. Numpy works with float16 slowly."""
    weight = np.arange(_INFINITE, dtype=np.uint16).view(np.float16).astype(np.float32)
    return weight, (weight * (K1 + 1) / (weight + K1)).astype(np.float32, copy=False)


def _ascend(numbers: NDArray[np.uint32], starts: Sequence[int]) -> bool:
    """Whether numbers ascend from each start to the next."""
    (falls,) = (numbers[1:] <= numbers[:-1]).nonzero()
    return set(starts).issuperset((falls + 1).tolist())


def _within(numbers: NDArray[Any], low: int, high: int) -> bool:
    return not len(numbers) or (int(numbers.min()) >= low and int(numbers.max()) < high)
