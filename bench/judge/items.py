"""The items of a prompt, which are what is judged: listed once, from the prompt alone, and shared by all results.

Each item quotes words of the prompt. A model's list is checked: with an item that the prompt does not support, a
repeated item or too many items, it goes back with its faults.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict

from bench.judge.anchor_words import content_stems
from bench.judge.answer_cache import key_of
from bench.judge.ask import ask_judge, checked_reader
from bench.judge.dimensions import CHECKLISTS, Dimension, dimensions
from bench.judge.questions import Enumeration, Named, enumeration, prompt_version
from bench.judge.usage import AnswerCost

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from bench.judge.answer_cache import AnswerCache
    from bench.judge.providers import JudgeProvider
    from simworlds.llm.structured import AnswerReader

MOST = 40
"""Items of one list; the longest prompt names half as many."""
_LONGEST_QUOTE = 25  # words
_LONGEST_TEXT = 240
_WORD = re.compile(r"\w+(?:['’-]\w+)*")
_ARTICLES = frozenset({"a", "an", "the"})
_LISTS: dict[Dimension, str] = {
    "objects_present": "objects",
    "spatial_relations": "relations",
    "actions_visible": "actions",
}


class PromptItem(BaseModel):
    """An item, and the words of the prompt that it quotes; "" for a fixed item."""

    model_config = ConfigDict(frozen=True)

    id: str
    dimension: Dimension
    text: str
    words: str = ""


class PromptItems(BaseModel):
    """All items of a prompt, who listed them (``provider/model``), and what that cost."""

    model_config = ConfigDict(frozen=True)

    by: str
    items: tuple[PromptItem, ...]
    spent: AnswerCost

    def texts(self) -> dict[str, str]:
        """Id → the statement to judge."""
        return {item.id: item.text for item in self.items}


def items_of(prompt: str, *, static: bool, provider: JudgeProvider, answers: AnswerCache) -> PromptItems:
    """The items of a prompt: the cached ones, whoever listed them, or a new list. Raises NotJudged."""

    def ask() -> PromptItems:
        answer = ask_judge(provider, enumeration(prompt, static=static), items_reader(prompt, static=static))
        by = f"{provider.name}/{answer.by or provider.model}"
        return PromptItems(by=by, items=_numbered(answer.value, static=static), spent=answer.spent)

    return answers.load_or_make("items", items_key(prompt, static=static), PromptItems, ask)


def cached_items(prompt: str, *, static: bool, answers: AnswerCache) -> PromptItems | None:
    """The cached items of a prompt, or None; asks no model."""
    return answers.load("items", items_key(prompt, static=static), PromptItems)


def items_key(prompt: str, *, static: bool) -> str:
    """The cache key of a prompt's items. It leaves out the provider, so that all judges judge the same items."""
    return key_of({"prompt_version": prompt_version(), "prompt": prompt, "static": static})


def one_line(text: str) -> str:
    """A model's text for printing: in one line, without control characters."""
    return " ".join("".join(char if char.isprintable() else " " for char in text).split())


def items_reader(prompt: str, *, static: bool) -> AnswerReader[Enumeration]:
    """Accepts an Enumeration whose items the prompt supports."""
    return checked_reader(Enumeration, lambda enumeration: _faults(enumeration, prompt, static=static))


def _numbered(enumeration: Enumeration, *, static: bool) -> tuple[PromptItem, ...]:
    listed: list[PromptItem] = []
    for dimension in dimensions(static=static):
        named: Sequence[Named] = getattr(enumeration, _LISTS[dimension]) if dimension in _LISTS else ()
        entries = [(one_line(entry.text), entry.words) for entry in named]
        entries += [(text, "") for text in CHECKLISTS.get(dimension, ())]
        listed += [
            PromptItem(id=f"{dimension}.{number}", dimension=dimension, text=text, words=words)
            for number, (text, words) in enumerate(entries, 1)
        ]
    return tuple(listed)


def _faults(enumeration: Enumeration, prompt: str, *, static: bool) -> Iterator[str]:
    if not enumeration.objects:
        yield "objects: the list is empty; list at least one."
    if static and enumeration.actions:
        yield "actions: nothing happens in a still; leave the list empty."
    if not static and not enumeration.actions:
        yield "actions: the list is empty; list what happens in the film."
    prompt_words = _words_of(prompt)
    for name in _LISTS.values():
        named: Sequence[Named] = getattr(enumeration, name)
        if len(named) > MOST:
            yield f"{name}: {len(named)} items are too many; list at most {MOST}."
        seen: dict[tuple[str, ...], int] = {}
        for place, item in enumerate(named):
            for fault in _faults_of(item, prompt_words):
                yield f"{name}[{place}]: {fault}"
            words = tuple(word for word in _words_of(item.text) if word not in _ARTICLES)
            if words in seen:
                yield f"{name}[{place}]: it is the same as {name}[{seen[words]}]."
            seen.setdefault(words, place)


def _faults_of(item: Named, prompt_words: Sequence[str]) -> Iterator[str]:
    quote = _words_of(item.words)
    if not content_stems(item.words) or not _contains(prompt_words, quote):
        yield f"the words {item.words[:80]!r} are not in the request in one piece."
    elif len(quote) > _LONGEST_QUOTE:
        yield f"the quotation has {len(quote)} words; quote at most {_LONGEST_QUOTE}."
    elif not set(content_stems(item.words)) & set(content_stems(item.text)):
        yield f"the item {item.text[:80]!r} uses none of the words {item.words[:80]!r} that it quotes."
    if len(item.text) > _LONGEST_TEXT:
        yield f"the text is too long ({len(item.text)} characters; at most {_LONGEST_TEXT})."


def _words_of(text: str) -> tuple[str, ...]:
    """The words of a text in lower case, without punctuation."""
    return tuple(_WORD.findall(text.casefold()))


def _contains(words: Sequence[str], quote: Sequence[str]) -> bool:
    width = len(quote)
    return any(tuple(words[at : at + width]) == tuple(quote) for at in range(len(words) - width + 1))
