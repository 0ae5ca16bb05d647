"""Which section of the page that was found is asked for.

The search finds a page by all that is known of it, most of which stands with its opening: its summary, the phrases by
which people look for it. Its sections are told apart here by their own words alone.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import terms as terms_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kb_build.pages.page import Page, Section
    from kb_serve.rank.scoring import Concept

_IN_HEADING, _IN_LABEL = 3.0, 2.0  # what a word counts there more than in the text
_K = 1.2
_B = 0.5  # how much a section's length counts
_BETTER = 1.5  # how much more than the opening a section must say of the query
_LEAST = 0.3  # how much of the query it must say
_NUMBERS = frozenset(terms_of("two three four five six several multiple"))
_LABELS = re.compile(r"^[ >]*\*\*.*$", re.MULTILINE)


def asked_section(page: Page, concepts: Sequence[Concept]) -> str:
    """The anchor of the section that says most of the query, and clearly more than the opening; empty for none.

    Words of the page's own title do not tell its sections apart, and are left out, as is how many there are of a thing.
    """
    own = _NUMBERS.union(terms_of(page.title))
    weights = {concept.stem: concept.idf for concept in concepts if concept.stem not in own}
    average = sum(len(section.text) for section in page.sections) / len(page.sections) or 1.0
    scores = [_score(section, weights, average) for section in page.sections]
    best = max(range(len(scores)), key=lambda number: (scores[number], -number))
    if best == 0 or scores[best] < max(_BETTER * scores[0], _LEAST * sum(weights.values())):
        return ""
    return page.sections[best].anchor


def _score(section: Section, weights: Mapping[str, float], average: float) -> float:
    """BM25 of a section's text, heading and labels, and more if the query says all of its heading. A stem is looked for
    as the beginning of words.
    """
    text = f" {section.title}\n {section.text}".lower()
    found = [(stem, weight) for stem, weight in weights.items() if stem and stem in text]
    if not found:
        return 0.0
    heading = f" {section.title.lower()}"
    labels = "\n".join(_LABELS.findall(text)).replace("*", " ")
    norm = _K * (1 - _B + _B * len(text) / average)
    score = 0.0
    for stem, weight in found:
        begins = f" {stem}"
        count = text.count(begins) + _IN_LABEL * labels.count(begins) + _IN_HEADING * heading.count(begins)
        score += weight * count / (count + norm)
    named = terms_of(section.title)
    return score + sum(weights[stem] for stem in named) if named and weights.keys() >= set(named) else score
