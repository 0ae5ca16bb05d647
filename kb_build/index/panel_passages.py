"""The place in the manual that is about a property, by the panel that shows it.

Blender's own table leads the settings of particles to one page that explains none of them. The manual says above its
sections which panel they describe, **Panel:** Particle System ‣ Emission; the panel in Blender's scripts says which
properties it shows, and what they are called there. Where one term below such a heading is called so, that is the
place. On the page that Blender's table leads to, a section's heading with the panel's label is enough.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import key
from kb_build.index.passages import Passage, key_of_term, keys_of_term, says_something
from kb_build.pages.definitions import term_lines
from kb_build.symbols.api_names import ID
from kb_build.symbols.flag_names import INVERTED

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator, Mapping, Sequence

    from kb_build.pages.page import Page, Section
    from kb_build.panels.panel_labels import PanelLabel
    from kb_build.symbols.records import Link, Symbol

_PANEL = re.compile(r"\*\*Panel:\*\* *(.+)")
_STEP = "‣"
_SHORTEST = 3  # letters of a text that is looked for: not the Y of "Size X, Y"
_MOST_PANELS = 3  # a property that more of them show is described by none


class _Term(NamedTuple):
    place: Passage
    own: str
    keys: frozenset[str]


class _Described:
    """A section of the manual, with the keys of the headings around it but for the page's title, and of the paths of
    the panels that it is of, if it says so.
    """

    def __init__(self, page: Page, number: int, above: _Described | None) -> None:
        self._page = page
        self._number = number
        title = key(self.section.title)
        self.headings: frozenset[str] = above.headings | {title} if above else frozenset()
        own = [tuple(map(key, path.split(_STEP))) for path in _PANEL.findall(self.section.text)]
        self.paths: list[tuple[str, ...]] = own or [(*path, title) for path in (above.paths if above else ())]

    @property
    def section(self) -> Section:
        return self._page.sections[self._number]

    @cached_property
    def terms(self) -> list[_Term]:
        """What is defined here, but for what is marked as another symbol's."""
        marked = {line for _, line in self.section.marks}
        found: list[_Term] = []
        for line, term in term_lines(self.section.text):
            place = Passage(self._page.slug, self._number, line)
            if line not in marked and says_something(self._page, place):
                found.append(_Term(place, key_of_term(term), keys_of_term(term)))
        return found


def find_panel_passages(
    symbols: Iterable[Symbol],
    pages: Iterable[Page],
    links: Iterable[Link],
    shown: Mapping[str, Sequence[PanelLabel]],
    known: Container[str],
) -> dict[str, Passage]:
    """Property → its place in the manual, for each that is not ``known`` and surely has one.

    ``shown`` tells in which panels properties stand (see panels.panel_labels).
    """
    manual = _Manual(pages, links)
    found = {
        symbol.path: [*manual.places(symbol, shown[symbol.path])]
        for symbol in symbols
        if symbol.kind == "property"
        and symbol.path not in known
        and 0 < len(shown.get(symbol.path, ())) <= _MOST_PANELS
        and symbol.owner != ID  # whatever panels show of an ID, it is not about all of them
        and INVERTED not in symbol.flags
    }
    # Of two pages about one panel, that of emitters and that of hair, the one that explains more of what it shows.
    explained = Counter(place.slug for places in found.values() for place in {*places})
    chosen = {path: _of_one_page(places, explained) for path, places in found.items()}
    return {path: place for path, place in chosen.items() if place}


class _Manual:
    """The sections of the manual, by the panels that they are of, and by page."""

    def __init__(self, pages: Iterable[Page], links: Iterable[Link]) -> None:
        self._pages = {page.slug: page for page in pages if page.source == "manual"}
        self._links = {one.source: one.target.partition("#")[0] for one in links if one.kind == "manual"}
        self._read: dict[str, list[_Described]] = {}
        self._of_panel: dict[str, list[_Described]] = defaultdict(list)
        for slug, page in self._pages.items():
            if any(_PANEL.search(section.text) for section in page.sections):
                for described in self._on(slug):
                    for name in {path[-1] for path in described.paths}:
                        self._of_panel[name].append(described)

    def places(self, symbol: Symbol, labels: Sequence[PanelLabel]) -> Iterator[Passage]:
        """Where the manual explains a property in a section on a panel that shows it."""
        for label in labels:
            panel = key(label.headings[-1])
            texts = [text for text in map(key, label.texts) if len(text) >= _SHORTEST]
            of_panel = [
                one for one in self._of_panel.get(panel, ()) if any(_is_of(path, label) for path in one.paths)
            ]
            found = [place for one in of_panel for place in _defined(symbol, texts, one.terms)]
            if not found:
                own = [one for one in self._on(self._links.get(symbol.path, "")) if panel in one.headings]
                found = _defined(symbol, texts, [term for one in own for term in one.terms])
            yield from found

    def _on(self, slug: str) -> list[_Described]:
        """The sections of a page."""
        if slug not in self._read:
            found: list[_Described] = []
            above: list[_Described] = []
            page = self._pages.get(slug)
            for number, section in enumerate(page.sections if page else ()):
                above = [one for one in above if one.section.level < section.level]
                assert page is not None
                above.append(_Described(page, number, above[-1] if above else None))
                found.append(above[-1])
            self._read[slug] = found
        return self._read[slug]


def _defined(symbol: Symbol, texts: Sequence[str], terms: Sequence[_Term]) -> list[Passage]:
    """The one term that is called as the property is, else as it is in the panel, else lists it; none of several."""
    label = key(symbol.label)
    ways = (
        [term.place for term in terms if term.own == label],
        [term.place for term in terms if term.own in texts],
        [term.place for term in terms if label in term.keys],
        [term.place for term in terms if not term.keys.isdisjoint(texts)],
    )
    found = next(filter(None, ways), [])
    return found if len(found) == 1 else []


def _is_of(path: Sequence[str], label: PanelLabel) -> bool:
    """Whether a path in the manual ends with the headings of a panel, below its tab."""
    headings = [*map(key, label.headings)]
    above, tab = path[: -len(headings)], key(label.tab)
    return (
        [*path[-len(headings) :]] == headings
        and bool(tab)
        and any(step.startswith(tab) or tab.startswith(step) or step.endswith(tab) for step in above)
    )


def _of_one_page(places: Sequence[Passage], explained: Mapping[str, int]) -> Passage | None:
    """The place on the page that explains more than the others; none where two places are left."""
    most = max((explained[place.slug] for place in places), default=0)
    best = {place for place in places if explained[place.slug] == most}
    return best.pop() if len(best) == 1 else None
