"""The inverted index of a base, as numpy arrays: its two levels of documents, and the postings of stems.

A level's documents are numbered from 0: units (level 0) and the topics around them (level 1). Lists that queries touch
are kept, the least used forgotten first; those that a query needs are read together, since a look-up costs more than
what it finds.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_serve.reader import Reader

Scores = NDArray[np.float32]

K1 = 2.2
_KEPT = 600  # stems; a query has a dozen, with their near ones


@dataclass(frozen=True, slots=True)
class Level:
    """The documents of one level, by number: their topics, chapters, weights, and which are about code."""

    count: int
    topics: NDArray[np.int32]
    chapters: NDArray[np.int32]
    weights: Scores
    code: NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Postings:
    """The documents of a level that have a stem, and for each how much it says of it: BM25's saturated frequency."""

    numbers: NDArray[np.uint32]
    saturated: Scores


_Lists = tuple[Postings | None, Postings | None]
_NONE: _Lists = (None, None)


class InvertedIndex:
    """What one base's index tells of stems."""

    def __init__(self, reader: Reader) -> None:
        self._reader = reader
        self._kept: OrderedDict[str, _Lists] = OrderedDict()

    @cached_property
    def levels(self) -> tuple[Level, Level]:
        """Units and topics. Raises BaseUnreadable."""
        units, topics = self._read_level(0), self._read_level(1)
        if not _within(units.topics, -1, topics.count):
            raise self._reader.damaged("its index points at topics that it has not")
        return units, topics

    def load(self, stems: Iterable[str]) -> None:
        """Reads the postings of stems that are not known yet, all at once."""
        wanted = [stem for stem in dict.fromkeys(stems) if stem not in self._kept]
        if not wanted:
            return
        found: dict[str, list[Postings | None]] = {stem: [None, None] for stem in wanted}
        marks = ",".join("?" * len(wanted))
        sql = f"SELECT level, stem, df, data FROM postings WHERE level IN (0, 1) AND stem IN ({marks})"  # noqa: S608
        rows = self._reader.rows(sql, *wanted)
        for level in (0, 1):
            mine = [(stem, count, data) for at, stem, count, data in rows if at == level]
            for (stem, *_), postings in zip(mine, self._postings(level, mine), strict=True):
                found[stem][level] = postings
        for stem, (units, topics) in found.items():
            self._kept[stem] = (units, topics) if units or topics else _NONE
        while len(self._kept) > max(_KEPT, len(wanted)):
            self._kept.popitem(last=False)

    def postings(self, level: int, stem: str) -> Postings | None:
        """Where a stem stands; None where it does nowhere."""
        if stem not in self._kept:
            self.load((stem,))
        self._kept.move_to_end(stem)
        return self._kept[stem][level]

    def frequency(self, stem: str) -> int:
        """How many units have a stem."""
        found = self.postings(0, stem)
        return 0 if found is None else len(found.numbers)

    def idf(self, stem: str) -> float:
        """How much a stem tells: ln(1 + (N - df + ½) / (df + ½)) over the units; 0 for an unknown one."""
        df = self.frequency(stem)
        return math.log(1 + (self.levels[0].count - df + 0.5) / (df + 0.5)) if df else 0.0

    def _read_level(self, level: int) -> Level:
        sql = "SELECT count, topics, chapters, weights, code FROM levels WHERE level = ?"
        try:
            ((count, topics, chapters, weights, code),) = self._reader.rows(sql, level)
            read = Level(
                count,
                np.frombuffer(topics, np.int32),
                np.frombuffer(chapters, np.int32),
                np.frombuffer(weights, np.float32),
                np.frombuffer(code, np.bool_),
            )
        except (ValueError, TypeError) as error:
            raise self._reader.damaged(error) from error
        arrays = (read.topics, read.chapters, read.weights, read.code)
        sound = all(len(array) == count for array in arrays) and np.isfinite(read.weights).all()
        if not (sound and _within(read.chapters, 0, count)):
            raise self._reader.damaged(f"level {level} of its index")
        return read

    def _postings(self, level: int, rows: Sequence[tuple[str, int, bytes]]) -> Iterator[Postings]:
        """Of (stem, df, data): checked and weighed all at once, which costs less than the rows one by one."""
        if not rows:
            return
        try:
            numbers = [np.frombuffer(data, np.uint32, count) for _, count, data in rows]
            weights = [np.frombuffer(data, np.float16, count, offset=4 * count) for _, count, data in rows]
        except (ValueError, TypeError) as error:
            raise self._reader.damaged(error) from error
        weight = np.concatenate(weights).astype(np.float32)
        if not (_within(np.concatenate(numbers), 0, self.levels[level].count) and np.isfinite(weight).all()):
            raise self._reader.damaged(f"the postings of {', '.join(repr(stem) for stem, *_ in rows)}")
        saturated = np.asarray(weight * (K1 + 1) / (weight + K1), np.float32)
        end = 0
        for listed in numbers:
            start, end = end, end + len(listed)
            yield Postings(listed, saturated[start:end].copy())  # not to keep all of them for one


def _within(numbers: NDArray[Any], low: int, high: int) -> bool:
    return not len(numbers) or (int(numbers.min()) >= low and int(numbers.max()) < high)
