"""Fits the weights of the search's signals: ``python -m measurements.fit_weights BASE``.

Training pairs are phrases by which a page or symbol is asked for. One phrase in five is held out: an index is made
without it, it is asked as a query, and what it leads to is right, as is the page that explains that, or what that page
explains. The weights maximise the likelihood of what is right among the units found, as a softmax of their scores
(conditional logit, by Newton's method), with a penalty for leaving the present ones. Prints a table, in which the text
counts 1 as in ``kb_serve/rank/weights.py``, and how both tables rank held-out phrases that neither was fitted on. Every
page has as many phrases, however rarely it is asked for: what the fit says of kinds of units, it says of phrases alone.
``make bench`` tells whether a table is better for queries.
"""

from __future__ import annotations

import random
import shutil
import sqlite3
import sys
import tempfile
import zlib
from collections import defaultdict
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kb_build.index.query_expansions import query_expansions
from kb_build.store import write_index
from kb_build.summaries.methods import summarise
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.rank.search import Searcher
from kb_serve.rank.signals import SIGNALS, chapter
from kb_serve.rank.weights import WEIGHTS
from kb_serve.reader import BaseReader
from measurements.baselines import read_units
from measurements.setting import say

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

QUERIES = 3_000
HELD_OUT = 5  # one phrase in so many
PENALTY = 100.0
_STEPS = 20
_TOLERANCE = 1e-4


@dataclass(frozen=True, slots=True)
class Example:
    """A query: for each unit found its signals (in the order of WEIGHTS), and whether it is right."""

    signals: Floats
    right: NDArray[np.bool_]


def hold_out(expansions: Mapping[str, str]) -> tuple[dict[str, str], list[tuple[str, str]]]:
    """(the expansions without what is held out, the (phrase, topic) pairs held out)."""
    kept: dict[str, str] = {}
    held: list[tuple[str, str]] = []
    for topic, row in expansions.items():
        phrases = [phrase.strip() for phrase in row.split(";")]
        out = {phrase for phrase in phrases if zlib.crc32(phrase.encode()) % HELD_OUT == 0}
        kept[topic] = "; ".join(phrase for phrase in phrases if phrase not in out)
        held += ((phrase, topic) for phrase in sorted(out))
    return kept, held


def examples(base: Path, queries: Sequence[tuple[str, str]]) -> Iterator[Example]:
    """What the search knows of each query's units, where what is right is among them."""
    with closing(BaseReader(base)) as reader:
        searcher = Searcher(reader)
        refs = searcher.index.levels[0].refs
        beside: dict[str, set[str]] = defaultdict(set)
        for slug, symbol in reader.rows("SELECT slug, symbol FROM explained"):
            beside[slug].add(symbol)
            beside[symbol].add(slug)
        for phrase, topic in queries:
            if (found := searcher.find(phrase)) is None:
                continue
            numbers, evidence = found
            right = np.array([refs[number] in {topic, *beside[topic]} for number in numbers.tolist()])
            if not right.any() or right.all():
                continue
            columns = {name: signal(evidence) for name, signal in SIGNALS.items()}
            logits = sum(WEIGHTS[name] * values for name, values in columns.items() if values is not None)
            columns["chapter"] = chapter(evidence, np.asarray(logits, np.float32))
            nothing = np.zeros(len(numbers))
            signals = [nothing if columns[name] is None else columns[name] for name in WEIGHTS]
            yield Example(np.stack(signals, 1, dtype=np.float64), right)


def fit(training: Sequence[Example], start: Floats) -> Floats:
    """The weights that maximise the penalised likelihood of what is right, beginning at ``start``."""
    weights = start.copy()
    for _ in range(_STEPS):
        gradient = -PENALTY * (weights - start)
        curvature = PENALTY * np.eye(len(weights))
        for example in training:
            logits = example.signals @ weights
            expected = _softmax(logits)
            mean = expected @ example.signals
            gradient += _softmax(logits[example.right]) @ example.signals[example.right] - mean
            curvature += (example.signals * expected[:, None]).T @ example.signals - np.outer(mean, mean)
        step = np.linalg.solve(curvature, gradient)
        weights += step
        if np.abs(step).max() < _TOLERANCE:
            break
    return weights


def mean_reciprocal_rank(tested: Sequence[Example], weights: Floats) -> float:
    """The mean of 1 / the place of the first right unit."""
    places: list[int] = []
    for example in tested:
        logits = example.signals @ weights
        places.append(1 + int((logits > logits[example.right].max()).sum()))
    return float(np.mean(1 / np.array(places)))


def _softmax(logits: Floats) -> Floats:
    powers = np.exp(logits - logits.max())
    return powers / powers.sum()


def _without_held_out(base: Path, folder: Path) -> tuple[Path, list[tuple[str, str]]]:
    """(a copy of a base without the phrases that are held out, these phrases with their topics)."""
    copy = folder / base.name
    shutil.copyfile(base, copy)
    with KnowledgeBase(base) as knowledge, closing(sqlite3.connect(copy)) as connection:
        slugs = [slug for (slug,) in connection.execute("SELECT slug FROM pages")]
        pages = [page for slug in slugs if (page := knowledge.page(slug)) is not None]
        kept, held = hold_out(query_expansions(summarise(pages, method="shipped").by_slug))
        with connection:
            for table in ("levels", "phrases", "postings", "vocabulary"):
                connection.execute(f"DELETE FROM {table}")
            write_index(connection, read_units(base, kept), kept)
        bare = {page.slug for page in pages if not any(section.text.strip() for section in page.sections)}
    return copy, [(phrase, topic) for phrase, topic in held if topic not in bare]


def main(base: str) -> None:
    """Fits, and prints the table."""
    start = np.array(list(WEIGHTS.values()))
    with tempfile.TemporaryDirectory(prefix="simworlds-fit-") as folder:
        say("making an index without the phrases that are held out")
        copy, held = _without_held_out(Path(base), Path(folder))
        random.Random(0).shuffle(held)
        say(f"asking {min(QUERIES, len(held))} of {len(held)} phrases")
        asked = list(examples(copy, held[:QUERIES]))
    training, tested = asked[len(asked) // 5 :], asked[: len(asked) // 5]
    fitted = fit(training, start)
    print(f"{len(asked)} phrases find what they lead to; mean reciprocal rank of those not fitted on:")
    print(f"{mean_reciprocal_rank(tested, start):.3f} now, {mean_reciprocal_rank(tested, fitted):.3f} fitted")
    fitted /= fitted[list(WEIGHTS).index("text")]
    for name, now, new in zip(WEIGHTS, start, fitted, strict=True):
        print(f'    "{name}": {new:.2f},  # {now:.2f} now')


if __name__ == "__main__":
    main(*sys.argv[1:])
