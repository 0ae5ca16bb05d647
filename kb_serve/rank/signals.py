"""The signals by which the search ranks units: what each says of every unit that speaks of a query.

A signal is a function of the evidence that gives each unit a number. A unit's score is e to the power of the sum of its
signals, each times its weight (:mod:`kb_serve.rank.weights`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kb_build.schema import DOCUMENT_KINDS
from kb_serve.rank.areas import NO_AREA, unasked
from kb_serve.rank.asked_words import CODE_WORDS, NODE_WORDS, REMOVAL_WORDS
from kb_serve.rank.weights import WEIGHTS
from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kb_build.schema import DocumentKind
    from kb_serve.rank.inverted_index import Scores

    Signal = Callable[["Evidence"], Scores | None]

_FEEDBACK = 100
_FEEDBACK_POWER = 3  # the weaker half of the feedback units hardly votes


@value_class
class Evidence:
    """What is known of the units that speak of a query, as arrays in one order.

    ``texts``: BM25F of the unit and of the topic around it. ``asked``: how nearly the query is what the unit or its
    topic is asked for by, from 0. ``counts``, ``areas``, ``chapters`` and ``kinds`` are as in the index; ``symbols``
    is 1 for those; ``called``: which share of the query, by rarity, an operator's name is that the
    query says whole; None if it says none. ``words`` are the query's; it is an error's message if ``failed``.
    """

    words: frozenset[str]
    failed: bool
    texts: Scores
    asked: Scores
    counts: Scores
    areas: NDArray[np.uint8]
    chapters: NDArray[np.int32]
    kinds: NDArray[np.uint8]
    symbols: Scores
    called: Scores | None

    def of_kind(self, kind: DocumentKind) -> Scores:
        """1 for the units of a kind, 0 for the others."""
        return (self.kinds == DOCUMENT_KINDS.index(kind)).astype(np.float32)


def text(evidence: Evidence) -> Scores:
    """How strongly the unit's own text and its topic's speak of the query."""
    return np.log(evidence.texts)


def asked(evidence: Evidence) -> Scores:
    """How nearly the query is what the unit is asked for by."""
    return evidence.asked


def counts(evidence: Evidence) -> Scores | None:
    """How much the unit counts among its like. Who gets a message may have used the rarest of them."""
    return None if evidence.failed else evidence.counts


def code(evidence: Evidence) -> Scores | None:
    """Whether the unit is about code, or what code calls or sets, where the query asks for code."""
    is_asked = not evidence.words.isdisjoint(CODE_WORDS)
    return (
        np.maximum(evidence.of_kind("code") + evidence.of_kind("removing"), evidence.symbols)
        if is_asked
        else None
    )


def called(evidence: Evidence) -> Scores | None:
    """How much of the query is an operator's name: who wants to export USD wants ``usd_export``. In a message such
    words are by chance.
    """
    return None if evidence.failed else evidence.called


def unasked_node(evidence: Evidence) -> Scores | None:
    """Whether the unit is about a node, where the query does not speak of nodes."""
    return evidence.of_kind("node") if evidence.words.isdisjoint(NODE_WORDS) else None


def unasked_area(evidence: Evidence) -> Scores:
    """Whether the unit is of an area that stands apart, where the query does not speak of it."""
    of_area = np.zeros(NO_AREA + 1, np.float32)
    of_area[unasked(evidence.words)] = 1
    return of_area[evidence.areas]


def unasked_removal(evidence: Evidence) -> Scores | None:
    """Whether the unit is a function that removes something, where the query speaks of nothing of the kind."""
    is_asked = evidence.failed or not evidence.words.isdisjoint(REMOVAL_WORDS)
    return None if is_asked else evidence.of_kind("removing")


def rarely_asked(evidence: Evidence) -> Scores:
    """Whether the unit is of what is rarely asked for."""
    return evidence.of_kind("rarely asked")


def index(evidence: Evidence) -> Scores:
    """Whether the unit is a page that only lists others."""
    return evidence.of_kind("index")


SIGNALS: dict[str, Signal] = {
    "text": text,
    "asked": asked,
    "counts": counts,
    "code": code,
    "called": called,
    "unasked node": unasked_node,
    "unasked area": unasked_area,
    "unasked removal": unasked_removal,
    "rarely asked": rarely_asked,
    "index": index,
}


def chapter(evidence: Evidence, logits: Scores) -> Scores:
    """How much the unit's chapter is favoured by the units that are best by the signals above, 0…1: what they mostly
    come from is probably what the query is about (pseudo-relevance feedback).
    """
    count = min(_FEEDBACK, len(logits))
    best = np.argpartition(-logits, count - 1)[:count]
    strength = np.exp(_FEEDBACK_POWER * (logits[best] - logits.max()))
    votes = np.bincount(evidence.chapters[best], strength, int(evidence.chapters.max()) + 1)
    return (votes[evidence.chapters] / votes.max()).astype(np.float32)


def scores_of(evidence: Evidence) -> Scores:
    """The units' scores, all above 0."""
    logits = np.zeros(len(evidence.texts), np.float32)
    for name, signal in SIGNALS.items():
        if WEIGHTS[name] and (values := signal(evidence)) is not None:
            logits += np.float32(WEIGHTS[name]) * values
    logits += np.float32(WEIGHTS["chapter"]) * chapter(evidence, logits)
    return np.exp(logits)
