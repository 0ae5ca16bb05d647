"""Which of the sentences on what one has to know are told with an answer."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.index.analysis import stems_of
from kb_serve.answer.known.advice import ADVICE
from kb_serve.answer.known.recipes import RECIPES
from kb_serve.recognise.resolving.subscripts import NODES_MODIFIER, CustomProperties
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.answer.known.advice import Advice
    from kb_serve.reader import BaseReader

_MOST_SAID = 20  # words; in more, which are code, those of a group stand by chance
_TOGGLES_ATTRIBUTE = "bpy.ops.object.geometry_nodes_input_attribute_toggle"


class Practice:
    """Sentences for the answers from one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._custom = CustomProperties(reader)

    def of(self, identifier: str, question: str, *, is_named: bool = True) -> Iterator[str]:
        """Sentences on a symbol, or on what the page with that slug explains, that a question comes to.

        ``is_named``: the question has its name, and was not only found to be like it.
        """
        said = stems_of(question)
        for advice in self._of_version:
            is_about = is_named or not advice.about or not advice.about.isdisjoint(said)
            is_asked = not advice.asked or not advice.asked.isdisjoint(said)
            # What a question says first: that soon tells most of it.
            if (is_about and is_asked and self._is_on(advice, identifier)) or (
                advice.wherever and self._is_told_anyway(advice, said)
            ):
                yield advice.text
        if identifier == _TOGGLES_ATTRIBUTE and (text := self._custom.on_attributes()):
            yield text
        if identifier == NODES_MODIFIER or identifier in self._pages[NODES_MODIFIER]:
            yield self._custom.on_inputs()

    def _is_on(self, advice: Advice, identifier: str) -> bool:
        """Whether advice is on a symbol, or on what a page explains."""
        if advice.needs and (identifier == advice.needs or not self._reader.entry(advice.needs)):
            return False
        return (
            identifier in advice.symbols
            or identifier.startswith(advice.beginning)
            or (bool(advice.explained) and identifier in self._pages[advice.explained])
            or (bool(advice.chapters_of) and _folder(identifier) in self._folders[advice.chapters_of])
        )

    def _is_told_anyway(self, advice: Advice, said: frozenset[str]) -> bool:
        """Whether a question has a word of each group by which advice is told of any symbol."""
        if len(said) > _MOST_SAID:
            return False
        is_asked = not any(group.isdisjoint(said) for group in advice.wherever)
        is_asked = is_asked and advice.unless.isdisjoint(said)
        return is_asked and (not advice.needs or self._reader.entry(advice.needs) is not None)

    @cached_property
    def _of_version(self) -> tuple[Advice, ...]:
        version = version_key(self._reader.meta.get("minor", ""))
        return tuple(advice for advice in (*ADVICE, *RECIPES) if advice.since <= version < advice.before)

    @cached_property
    def _pages(self) -> dict[str, frozenset[str]]:
        """Symbol → the pages that explain it, of those that something is known of."""
        paths = {path for advice in ADVICE for path in (advice.explained, advice.chapters_of) if path}
        return {
            path: frozenset(target.partition("#")[0] for target in self._reader.manual_links(path))
            for path in (*paths, NODES_MODIFIER)
        }

    @cached_property
    def _folders(self) -> dict[str, frozenset[str]]:
        """Symbol → the folders of those pages."""
        return {path: frozenset(map(_folder, pages)) - {""} for path, pages in self._pages.items()}


def _folder(slug: str) -> str:
    return slug.rpartition("/")[0]
