"""Which names may be meant by one that does not exist, by more than their spelling: by what menus call them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import stem, words
from kb_serve.recognise.likely.likely_keywords import EMPTY_WORDS

if TYPE_CHECKING:
    from collections.abc import Mapping

_MOST = 3


def by_label(written: str, labels: Mapping[str, str]) -> tuple[list[str], list[str]]:
    """The names whose label says what a name says: ``chain_count``, Chain Length, for ``chain_length``.

    ``labels`` is name → label. First those whose label says nothing else, then those that say more: ``body``, Body
    Text, for ``text``.
    """
    mine = _meaning(written)
    saying = {name: said for name, label in labels.items() if mine and mine <= (said := _meaning(label))}
    exact = [name for name, said in saying.items() if said == mine]
    partly = sorted(saying.keys() - {*exact}, key=lambda name: (len(saying[name]), len(name), name))
    if len(partly) > _MOST:  # what a label ends with is what the thing is
        partly = [name for name in partly if _last(labels[name]) == _last(written)]
    return exact, partly if len(partly) <= _MOST else []


def _last(text: str) -> str:
    return stem(words(text)[-1])


def _meaning(text: str) -> set[str]:
    return {stem(word) for word in words(text)} - EMPTY_WORDS
