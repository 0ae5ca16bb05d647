"""The places in the manual where operators stand by their labels, or by the words on their buttons.

Blender's own table leads most operators to the page or the chapter of their whole module only. A term or a heading
there that says just what one operator of that module is called is about it; so is one of several words, on any page,
that nothing else in Blender is called.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import key
from kb_build.index.analysis import terms as terms_of
from kb_build.index.passages import Passage, address_of, says_something, scope_of
from kb_build.pages.definitions import term_lines

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_build.blender.buttons import Button
    from kb_build.pages.page import Page
    from kb_build.symbols.records import Link, Symbol

_MEANINGLESS = ("bpy.ops.wm.context_", "bpy.ops.wm.call_")  # without arguments that are computed
_SHORTCUT = re.compile(r"\s*`[^`]*`(?:\s*[,/]\s*`[^`]*`)*$")
_LISTED = re.compile(r"\s*[/,]\s*")
# Where a place is: in the part that carries the operator's address, on the page to which Blender's table leads, in the
# chapter to which it leads, in a neighbouring page, or anywhere; and how many words a label must have there.
_MARKED, _ON_ITS_PAGE, _BELOW, _BESIDE, _ANYWHERE = range(5)
_LEAST_WORDS = (1, 1, 2, 2, 3)

_Scopes = Mapping[str, range]


class LabelledOperator(NamedTuple):
    """An operator at a place, and the arguments with which its button calls it, as a script writes them.

    ``is_near``: the place is where Blender's table leads for it, or below.
    """

    place: Passage
    path: str
    arguments: str
    is_near: bool


@dataclass(slots=True)
class _Called:
    """What is called by one key: operators, with the arguments of each of their buttons; and what else is."""

    operators: dict[str, set[str]] = field(default_factory=lambda: defaultdict(set[str]))
    words: int = 0
    is_a_propertys: bool = False
    is_a_classes: bool = False
    labelled: set[str] = field(
        default_factory=set[str]
    )  # those that are called so themselves, not only their buttons


def find_labelled_operators(
    symbols: Sequence[Symbol],
    pages: Sequence[Page],
    links: Iterable[Link],
    buttons: Mapping[str, Sequence[Button]],
) -> list[LabelledOperator]:
    """The operators that are surely meant by a term or a heading, in the order of the pages."""
    finder = _Finder(
        _calls(symbols, buttons), {link.source: link.target for link in links if link.kind == "manual"}
    )
    return [found for page in pages if page.source == "manual" for found in finder.on(page)]


def _calls(symbols: Sequence[Symbol], buttons: Mapping[str, Sequence[Button]]) -> dict[str, _Called]:
    called: dict[str, _Called] = defaultdict(_Called)
    for symbol in symbols:
        if symbol.kind == "operator" and not symbol.path.startswith(_MEANINGLESS):
            for text, arguments in ((symbol.label, ""), *buttons.get(symbol.path, ())):
                entry = called[key(text)]
                entry.operators[symbol.path].add(arguments)
                if text == symbol.label:
                    entry.labelled.add(symbol.path)
                entry.words = len(terms_of(text))
    for symbol in symbols:
        if symbol.kind in {"property", "socket", "class"} and (entry := called.get(key(symbol.label))):
            entry.is_a_propertys |= symbol.kind != "class"
            entry.is_a_classes |= symbol.kind == "class" and symbol.group != "operator"
    called.pop("", None)
    return called


class _Finder:
    def __init__(self, called: Mapping[str, _Called], links: Mapping[str, str]) -> None:
        self._called = called
        self._links = links

    def on(self, page: Page) -> Iterator[LabelledOperator]:
        scopes = {
            name: scope_of(page, (number, line))
            for number, section in enumerate(page.sections)
            for name, line in section.marks
        }
        for number, section in enumerate(page.sections):
            for line, label in ((-1, section.title), *term_lines(section.text)):
                place = Passage(page.slug, number, line)
                yield from self._all_meant(label, place, scopes)

    def _all_meant(self, label: str, place: Passage, scopes: _Scopes) -> list[LabelledOperator]:
        """The operator that a label means, or of a list those that each of its parts means."""
        plain = _SHORTCUT.sub("", label)
        for parts in ([plain], _LISTED.split(plain)):
            meant = [self._meant(part, place, scopes) for part in parts]
            if all(meant):
                return [found for found in meant if found]
        return []

    def _meant(self, label: str, place: Passage, scopes: _Scopes) -> LabelledOperator | None:
        """The operator that a label means; None where it is not sure."""
        if (called := self._called.get(key(label))) is None:
            return None
        near: dict[int, list[str]] = defaultdict(list)
        for path in called.operators:
            near[self._distance(path, place, scopes)].append(path)
        nearest = min(near)
        if len(near[nearest]) > 1 or called.words < _LEAST_WORDS[nearest]:
            return None
        is_elsewhere = nearest in {_BESIDE, _ANYWHERE}
        if is_elsewhere and (called.is_a_propertys or len(called.operators) > 1 or _is_aside(place)):
            return None
        path = near[nearest][0]
        if nearest != _MARKED and (called.is_a_classes or (_is_title(place) and path not in called.labelled)):
            return None
        arguments = called.operators[path]
        only = next(iter(arguments)) if len(arguments) == 1 else ""
        return LabelledOperator(place, path, only, nearest <= _BELOW)

    def _distance(self, path: str, place: Passage, scopes: _Scopes) -> int:
        """How far a place is from where Blender's table leads for an operator."""
        own = self._links.get(path, "").partition("#")[0]
        if own == place.slug:
            scope = scopes.get(address_of(path))
            if scope is None:
                return _BELOW if _is_title(place) else _ON_ITS_PAGE
            return _MARKED if place.section in scope else _ANYWHERE
        folder = own.rpartition("/")[0]
        if folder and place.slug.startswith(f"{folder}/"):
            return _BELOW if own.endswith("/index") else _BESIDE
        return _ANYWHERE


def _is_title(place: Passage) -> bool:
    return place.section == 0 and place.line < 0


def _is_aside(place: Passage) -> bool:
    """Whether it is a page's title, or on a page about add-ons or tools, which are no operators."""
    return _is_title(place) or place.slug.startswith("addons/") or place.slug.endswith("/toolbar")


def passages_of(labelled: Iterable[LabelledOperator], pages: Iterable[Page]) -> dict[str, Passage]:
    """Operator → the one place near to it that is about it, and not about one of its uses, where it says something."""
    places: dict[str, list[LabelledOperator]] = defaultdict(list)
    for found in labelled:
        if found.is_near:
            places[found.path].append(found)
    by_slug = {page.slug: page for page in pages}
    return {
        path: found.place
        for path, (found, *more) in places.items()
        if not more and not found.arguments and says_something(by_slug[found.place.slug], found.place)
    }
