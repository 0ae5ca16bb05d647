"""The place in the manual that is about a symbol.

Blender's own table leads every symbol to a page. Where the page carries the symbol's address, that is the place. Else it
is the definition whose term is the symbol's label: within the part of the page that is about the symbol's class, not
marked as another symbol's, and among several the one whose headings and words say most about the symbol. Where that
is not sure, a symbol has no place.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import key
from kb_build.symbol_lines import term_lines

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kb_build.records import Link, Page, Symbol

_ADDRESS = re.compile(r"[^a-z0-9]+")
_PARTS = re.compile(r"\s*(?:/|,| and )\s*")
_BRACKETS = re.compile(r"\s*[(\[][^)\]]*[)\]]")


class Passage(NamedTuple):
    """A place in the manual: the number of a page's section, and the line of its text; -1 is the heading."""

    slug: str
    section: int
    line: int


def address_of(path: str) -> str:
    """The address that the manual gives a symbol: ``bpy-types-clothsettings-quality``."""
    return _ADDRESS.sub("-", path.lower()).strip("-")


@dataclass(frozen=True, slots=True)
class _Term:
    """A term that a page defines, with the keys of its spellings and its depth below other definitions."""

    section: int
    line: int
    keys: frozenset[str]
    depth: int


@dataclass(slots=True)
class _Place:
    """What choosing a passage needs of one page."""

    page: Page
    marks: dict[str, tuple[int, int]] = field(default_factory=dict[str, tuple[int, int]])
    taken: dict[tuple[int, int], list[str]] = field(default_factory=lambda: defaultdict(list[str]))
    terms: dict[str, list[_Term]] = field(default_factory=lambda: defaultdict(list[_Term]))
    chains: list[tuple[str, ...]] = field(default_factory=list[tuple[str, ...]])
    words: dict[tuple[int, int], frozenset[str]] = field(
        default_factory=dict[tuple[int, int], frozenset[str]]
    )


def _keys(term: str) -> frozenset[str]:
    """``Size / Size X`` and ``Distance (m)`` are found by each of their names."""
    plain = _BRACKETS.sub("", term)
    return frozenset(filter(None, (key(plain), key(term), *map(key, _PARTS.split(plain)))))


def _read(page: Page) -> _Place:
    place = _Place(page)
    above: list[tuple[int, str]] = []
    for number, section in enumerate(page.sections):
        above = [(level, title) for level, title in above if level < section.level]
        above.append((section.level, section.title))
        place.chains.append(tuple(title for _, title in above))
        for name, line in section.marks:
            place.marks.setdefault(name, (number, line))
            place.taken[number, line].append(name)
        for line, term, depth in term_lines(section.text):
            entry = _Term(number, line, _keys(term), depth)
            for each in entry.keys:
                place.terms[each].append(entry)
    return place


def find_passages(
    symbols: Sequence[Symbol], pages: Sequence[Page], links: Iterable[Link]
) -> dict[str, Passage]:
    """Symbol path → its place in the manual, for every symbol that surely has one."""
    return _Finder(symbols, pages, links).found()


class _Finder:
    def __init__(self, symbols: Sequence[Symbol], pages: Sequence[Page], links: Iterable[Link]) -> None:
        self._symbols = {symbol.path: symbol for symbol in symbols}
        self._pages = {page.slug: page for page in pages if page.source == "manual"}
        self._links = {link.source: link.target for link in links if link.kind == "manual"}
        self._places: dict[str, _Place] = {}
        self._sockets: dict[str, set[str]] = defaultdict(set)
        for symbol in symbols:
            if symbol.kind == "socket":
                self._sockets[symbol.owner].add(key(symbol.label))

    def found(self) -> dict[str, Passage]:
        found: dict[str, Passage] = {}
        for symbol in self._symbols.values():
            source = symbol.owner if symbol.kind == "socket" else symbol.path
            slug, _, anchor = self._links.get(source, "").partition("#")
            if slug in self._pages and symbol.kind in {"property", "socket", "operator", "class"}:
                place = self._place(slug)
                at = self.marked(symbol, place) or self.defined(symbol, place, anchor)
                if at:
                    found[symbol.path] = Passage(slug, *at)
        return found

    def _place(self, slug: str) -> _Place:
        if slug not in self._places:
            self._places[slug] = _read(self._pages[slug])
        return self._places[slug]

    def marked(self, symbol: Symbol, place: _Place) -> tuple[int, int] | None:
        """Where the page carries the symbol's own address."""
        return place.marks.get(address_of(symbol.path))

    def defined(self, symbol: Symbol, place: _Place, anchor: str) -> tuple[int, int] | None:
        """Where the page surely defines the symbol's label."""
        if symbol.kind not in {"property", "socket"} or not symbol.label:
            return None
        own = address_of(symbol.path)
        scope = _scope(place.page, place.marks.get(anchor))
        terms = [
            term
            for term in place.terms.get(key(symbol.label), ())
            if term.section in scope and self._may_be(symbol, term, place, own)
        ]
        if not terms:
            return None
        if len(terms) == 1:
            return terms[0].section, terms[0].line
        return None

    def _may_be(self, symbol: Symbol, term: _Term, place: _Place, own: str) -> bool:
        taken = place.taken.get((term.section, term.line), ())
        if taken and own not in taken:
            return False
        chain = [title.lower() for title in place.chains[term.section][1:]]
        puts = [title for title in chain if title.startswith(("input", "output"))]
        if symbol.kind == "socket":
            return bool(puts) and puts[-1][:3] == symbol.path[len(symbol.owner) + 1 :][:3]
        return not (puts and key(symbol.label) in self._sockets.get(symbol.owner, ()))


def _scope(page: Page, mark: tuple[int, int] | None) -> range:
    """The sections at or below the one that a heading's address leads to; all where there is none."""
    sections = page.sections
    if mark is None or mark[1] >= 0:
        return range(len(sections))
    start = mark[0]
    level = sections[start].level
    end = next((n for n in range(start + 1, len(sections)) if sections[n].level <= level), len(sections))
    return range(start, end)
