"""The names of a topic: its words, and the classes and operators that belong to it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms
from kb_build.symbols.api_names import TYPES

if TYPE_CHECKING:
    from collections.abc import Iterable

_SHORTEST = 4  # of the keys that members are called as


@dataclass(slots=True)
class TopicNames:
    """The classes and operators of a topic, each with a weight, the heaviest first.

    ``title`` is the key of its title; ``words``: those of its title, then those of its address. ``explained``: the
    symbols that its page explains, if there are none below it. ``of_kind``: those of the page that is called as the
    topic and says what kind it is, as that of the Line Art Modifier. ``elsewhere``: the classes that only have its
    words in their names and that other pages explain.
    """

    keys: frozenset[str]
    words: tuple[frozenset[str], ...]
    explained: frozenset[str] = frozenset()
    classes: dict[str, float] = field(default_factory=dict[str, float])
    operators: dict[str, float] = field(default_factory=dict[str, float])
    title: str = ""
    of_kind: frozenset[str] = frozenset()
    elsewhere: frozenset[str] = frozenset()

    def names(self, name: str) -> bool:
        """Whether a name holds the topic's words."""
        return any(words <= set(terms(name)) for words in self.words)

    def holds(self, name: str) -> bool:
        """Whether the topic has all words of a name."""
        return any(words >= set(terms(name)) for words in self.words)

    def has_title(self, name: str) -> bool:
        """Whether a name holds all words of the title."""
        return all(words <= set(terms(name)) for words in self.words[:1])

    def is_called(self, path: str) -> bool:
        """Whether a class has the topic's words and no other."""
        return frozenset(terms(path.removeprefix(TYPES))) in self.words

    def ends_as_title(self, path: str) -> bool:
        """Whether the name of a class ends in the several words of the title: a user's asset library."""
        words = terms(path.removeprefix(TYPES))
        return any(len(title) > 1 and title == frozenset(words[-len(title) :]) for title in self.words[:1])

    def stems(self) -> list[str]:
        """The topic's keys, in the singular too."""
        names = (name for each in sorted(self.keys) for name in (each, each.removesuffix("s")))
        return [name for name in dict.fromkeys(names) if len(name) >= _SHORTEST]

    def has_modifier(self, path: str) -> bool:
        """Whether a class is the modifier that is called as the topic is."""
        name = path.removeprefix(TYPES)
        return name.endswith("Modifier") and key(name.removesuffix("Modifier")) in self.keys

    def weight_of(self, classes: Iterable[str]) -> float:
        """What some of its classes weigh together."""
        return sum(map(self.classes.__getitem__, classes))
