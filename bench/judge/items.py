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
from bench.judge.ask import asked
from bench.judge.dimensions import CHECKLISTS, Dimension, dimensions
from bench.judge.questions import Enumeration, Named, enumeration, prompt_version
from bench.judge.usage import Spent
from simworlds.llm.structured import fits

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from typing import Any

    from bench.judge.answer_cache import Store
    from bench.judge.providers import Provider

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


class Anchored(BaseModel):
    """An item, and the words of the prompt that it quotes; "" for a fixed item."""

    model_config = ConfigDict(frozen=True)

    id: str
    dimension: Dimension
    text: str
    words: str = ""


class Items(BaseModel):
    """All items of a prompt, who listed them (``provider/model``), and what that cost."""

    model_config = ConfigDict(frozen=True)

    by: str
    items: tuple[Anchored, ...]
    spent: Spent

    def texts(self) -> dict[str, str]:
        """Id → the statement to judge."""
        return {item.id: item.text for item in self.items}


def items_of(prompt: str, *, static: bool, provider: Provider, store: Store) -> Items:
    """The items of a prompt: the cached ones, whoever listed them, or a new list. Raises NotJudged."""

    def ask() -> Items:
        found = asked(provider, enumeration(prompt, static=static), reader_of(prompt, static=static))
        by = f"{provider.name}/{found.by or provider.model}"
        return Items(by=by, items=_numbered(found.value, static=static), spent=found.spent)

    return store.once("items", items_key(prompt, static=static), Items, ask)


def kept_items(prompt: str, *, static: bool, store: Store) -> Items | None:
    """The cached items of a prompt, or None; asks no model."""
    return store.kept("items", items_key(prompt, static=static), Items)


def items_key(prompt: str, *, static: bool) -> str:
    """The cache key of a prompt's items. It leaves out the provider, so that all judges judge the same items."""
    return key_of({"prompt_version": prompt_version(), "prompt": prompt, "static": static})


def one_line(text: str) -> str:
    """A model's text for printing: in one line, without control characters."""
    return " ".join("".join(char if char.isprintable() else " " for char in text).split())


def reader_of(prompt: str, *, static: bool) -> Any:
    """Accepts an Enumeration whose items the prompt supports."""
    shaped = fits(Enumeration)

    def reader(data: Any) -> tuple[Enumeration | None, Sequence[object]]:
        found, wrong = shaped(data)
        if found is None:
            return None, wrong
        faults = list(_faults(found, prompt, static=static))
        return (None, faults) if faults else (found, [])

    return reader


def _numbered(found: Enumeration, *, static: bool) -> tuple[Anchored, ...]:
    listed: list[Anchored] = []
    for dimension in dimensions(static=static):
        named: Sequence[Named] = getattr(found, _LISTS[dimension]) if dimension in _LISTS else ()
        entries = [(one_line(one.text), one.words) for one in named]
        entries += [(text, "") for text in CHECKLISTS.get(dimension, ())]
        listed += [
            Anchored(id=f"{dimension}.{number}", dimension=dimension, text=text, words=words)
            for number, (text, words) in enumerate(entries, 1)
        ]
    return tuple(listed)


def _faults(found: Enumeration, prompt: str, *, static: bool) -> Iterator[str]:
    if not found.objects:
        yield "objects: the list is empty; list at least one."
    if static and found.actions:
        yield "actions: nothing happens in a still; leave the list empty."
    if not static and not found.actions:
        yield "actions: the list is empty; list what happens in the film."
    said = _plain(prompt)
    for name in _LISTS.values():
        named: Sequence[Named] = getattr(found, name)
        if len(named) > MOST:
            yield f"{name}: {len(named)} items are too many; list at most {MOST}."
        seen: dict[tuple[str, ...], int] = {}
        for place, one in enumerate(named):
            for fault in _faults_of(one, said):
                yield f"{name}[{place}]: {fault}"
            plain = tuple(word for word in _plain(one.text) if word not in _ARTICLES)
            if plain in seen:
                yield f"{name}[{place}]: it is the same as {name}[{seen[plain]}]."
            seen.setdefault(plain, place)


def _faults_of(one: Named, said: Sequence[str]) -> Iterator[str]:
    quote = _plain(one.words)
    if not content_stems(one.words) or not _contains(said, quote):
        yield f"the words {one.words[:80]!r} are not in the request in one piece."
    elif len(quote) > _LONGEST_QUOTE:
        yield f"the quotation has {len(quote)} words; quote at most {_LONGEST_QUOTE}."
    elif not set(content_stems(one.words)) & set(content_stems(one.text)):
        yield f"the item {one.text[:80]!r} uses none of the words {one.words[:80]!r} that it quotes."
    if len(one.text) > _LONGEST_TEXT:
        yield f"the text is too long ({len(one.text)} characters; at most {_LONGEST_TEXT})."


def _plain(text: str) -> tuple[str, ...]:
    """The words of a text in lower case, without punctuation."""
    return tuple(_WORD.findall(text.casefold()))


def _contains(said: Sequence[str], quote: Sequence[str]) -> bool:
    width = len(quote)
    return any(tuple(said[at : at + width]) == tuple(quote) for at in range(len(said) - width + 1))
