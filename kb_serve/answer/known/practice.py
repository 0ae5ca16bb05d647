"""Which of the sentences on what one has to know are told with an answer."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.index.analysis import stems_of
from kb_serve.answer.known.addon_sentences import ADDON_SENTENCES
from kb_serve.answer.known.advice import ADVICE
from kb_serve.answer.known.changed_defaults import ADVICE_ON_DEFAULTS
from kb_serve.answer.known.task_sentences import TASK_SENTENCES
from kb_serve.recognise.chains.subscripts import NODES_MODIFIER, CustomProperties
from kb_serve.recognise.message_patterns import is_message
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kb_serve.answer.known.told_of import Advice
    from kb_serve.reader import BaseReader

# What does a task in a sentence: of no use beside a recipe that does it.
HOW_TO = frozenset(advice.text for advice in (*TASK_SENTENCES, *ADDON_SENTENCES) if advice.wherever)
_MOST_SAID = 20  # words; in more, which are code, those of a group stand by chance
_TOGGLES_ATTRIBUTE = "bpy.ops.object.geometry_nodes_input_attribute_toggle"


class Practice:
    """Sentences for the answers from one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._custom = CustomProperties(reader)

    def of(self, identifier: str, question: str, *, is_named: bool = True) -> Iterator[str]:
        """Sentences on a symbol, or on what the page with that slug explains, that a question comes to.

        ``is_named``: the question has its name, and was not only found to be like it. What a message names it names
        for another reason than to ask of it.
        """
        said = stems_of(question)
        is_named = is_named and not is_message(question)
        known = self._of_version
        told = {
            place
            for place in self._on(identifier)
            if _is_asked(known[place], said, is_named=is_named) and identifier != known[place].needs
        }
        if len(said) <= _MOST_SAID:
            places = (place for word in said for place in self._by_word.get(word, ()))
            told.update(place for place in places if _is_told_anyway(known[place], said))
        yield from (known[place].text for place in sorted(told))
        if identifier == _TOGGLES_ATTRIBUTE and (text := self._custom.on_attributes()):
            yield text
        if identifier == NODES_MODIFIER or identifier in self._pages[NODES_MODIFIER]:
            yield self._custom.on_inputs()

    def _on(self, identifier: str) -> Iterator[int]:
        """The places of what is known of a symbol, or of what a page explains."""
        yield from self._by_id.get(identifier, ())
        yield from self._by_folder.get(_folder(identifier), ())
        yield from (place for begin, place in self._by_beginning if identifier.startswith(begin))

    @cached_property
    def _of_version(self) -> tuple[Advice, ...]:
        """What is known of this Blender and of what the base has; the look-ups below give places in it."""
        version = version_key(self._reader.meta.get("minor", ""))
        return tuple(
            advice
            for advice in (*ADVICE, *ADVICE_ON_DEFAULTS, *TASK_SENTENCES, *ADDON_SENTENCES)
            if advice.since <= version < advice.before
            and (not advice.needs or self._reader.entry(advice.needs) is not None)
        )

    @cached_property
    def _by_id(self) -> dict[str, list[int]]:
        """By the symbols that it is on, and the pages that explain them."""
        return _places(
            (*advice.symbols, *self._pages.get(advice.explained, ())) for advice in self._of_version
        )

    @cached_property
    def _by_folder(self) -> dict[str, list[int]]:
        """By the folders of the pages that explain what the chapters are of."""
        folders = {path: {*map(_folder, pages)} - {""} for path, pages in self._pages.items()}
        return _places(folders.get(advice.chapters_of, ()) for advice in self._of_version)

    @cached_property
    def _by_beginning(self) -> list[tuple[str, int]]:
        """With the beginnings of the symbols that it is on."""
        return [(begin, place) for place, advice in enumerate(self._of_version) for begin in advice.beginning]

    @cached_property
    def _by_word(self) -> dict[str, list[int]]:
        """By the words of the first group by which it is told of any symbol."""
        return _places(next(iter(advice.wherever), ()) for advice in self._of_version)

    @cached_property
    def _pages(self) -> dict[str, frozenset[str]]:
        """Symbol → the pages that explain it, of those that something is known of."""
        paths = {
            path for advice in self._of_version for path in (advice.explained, advice.chapters_of) if path
        }
        return {
            path: frozenset(target.partition("#")[0] for target in self._reader.manual.manual_links(path))
            for path in (*paths, NODES_MODIFIER)
        }


def _is_asked(advice: Advice, said: frozenset[str], *, is_named: bool) -> bool:
    """Whether a question comes to what is known of the symbol that it has, or is like."""
    is_about = is_named or not advice.about or not advice.about.isdisjoint(said)
    return is_about and (not advice.asked or not advice.asked.isdisjoint(said))


def _is_told_anyway(advice: Advice, said: frozenset[str]) -> bool:
    """Whether a question has a word of each group by which advice is told of any symbol."""
    return advice.unless.isdisjoint(said) and not any(group.isdisjoint(said) for group in advice.wherever)


def _places(keys: Iterable[Iterable[str]]) -> dict[str, list[int]]:
    """Key → the places of those that have it."""
    found: dict[str, list[int]] = {}
    for place, own in enumerate(keys):
        for key in own:
            found.setdefault(key, []).append(place)
    return found


def _folder(slug: str) -> str:
    return slug.rpartition("/")[0]
