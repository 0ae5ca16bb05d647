"""The place in the manual that is about a symbol.

Blender's own table leads every symbol to a page. Where the page carries the symbol's address and speaks of it there,
that is the place. Else it is the definition whose term is the symbol's label, within the part of the page that is about
the symbol's class, not marked as another symbol's, not under another class's heading, and the only one of that name.
Where that is not sure, a symbol has no place.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import key
from kb_build.index.analysis import terms as terms_of
from kb_build.pages.definitions import passage_text, term_lines
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import INVERTED

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_build.pages.page import Page
    from kb_build.symbols.records import Link, Symbol

_KINDS = frozenset({"property", "socket", "operator", "class"})
_BEGINNING = 400  # letters of a definition that say what it is about
# Headings that say nothing about what stands below, and what the names of classes have in common.
_PLAIN_HEADINGS = frozenset(
    terms_of("options option properties property settings setting panel advanced general common")
)
KIND_WORDS = frozenset(terms_of("f-modifier constraint node settings rule texture strip type types"))
_ADDRESS = re.compile(r"[^a-z0-9]+")
_PARTS = re.compile(r"\s*(?:/|,| and )\s*")
_REFERS = re.compile(r"(?:See .{,40}|> \*\*Todo:\*\*[\s\S]*)?")  # to what is not there, or not yet
_BRACKETS = re.compile(r"\s*[(\[][^)\]]*[)\]]|,?\s*`[^`]*`")  # and keys to press


class Passage(NamedTuple):
    """A place in the manual: the number of a page's section, and the line of its text; -1 is the heading."""

    slug: str
    section: int
    line: int


@cache
def address_of(path: str) -> str:
    """The address that the manual gives a symbol: ``bpy-types-clothsettings-quality``."""
    return _ADDRESS.sub("-", path.lower()).strip("-")


@dataclass(frozen=True, slots=True)
class _Term:
    """A term that a page defines: where, and the key of all of it."""

    section: int
    line: int
    own: str


@dataclass(slots=True)
class _Place:
    """What choosing a passage needs of one page."""

    page: Page
    marks: dict[str, tuple[int, int]] = field(default_factory=dict[str, tuple[int, int]])
    taken: set[tuple[int, int]] = field(default_factory=set[tuple[int, int]])
    terms: dict[str, list[_Term]] = field(default_factory=lambda: defaultdict(list[_Term]))
    chains: list[tuple[str, ...]] = field(default_factory=list[tuple[str, ...]])
    words: dict[tuple[int, int], frozenset[str]] = field(
        default_factory=dict[tuple[int, int], frozenset[str]]
    )


def keys_of_term(term: str) -> frozenset[str]:
    """The keys of a term: ``Size / Size X`` and ``Distance (m)`` are found by each of their names, without the
    keys to press.
    """
    plain = _BRACKETS.sub("", term)
    parts = _PARTS.split(plain)
    return frozenset(filter(None, (key(plain), key(term), *map(key, parts), *map(key, _in_full(parts)))))


def key_of_term(term: str) -> str:
    """The key of all of a term, without the keys to press."""
    return key(_BRACKETS.sub("", term))


def _in_full(parts: Sequence[str]) -> Iterator[str]:
    """The names that a list is short for, in the orders that labels have: "Levels Viewport, Render" for Levels and
    Render Levels, "Mute/Unmute Strips" for Mute Strips.
    """
    first, *others = parts
    *before, last = parts
    head, _, own = first.rpartition(" ")
    if head and others and not any(" " in part for part in others):
        yield head
        for part in (own, *others):
            yield from (f"{head} {part}", f"{part} {head}")
    _, _, tail = last.partition(" ")
    if tail and not any(" " in part for part in before):
        yield from (f"{part} {tail}" for part in before)


def _read(page: Page) -> _Place:
    place = _Place(page)
    above: list[tuple[int, str]] = []
    for number, section in enumerate(page.sections):
        above = [(level, title) for level, title in above if level < section.level]
        above.append((section.level, section.title))
        place.chains.append(tuple(title for _, title in above))
        for name, line in section.marks:
            place.marks.setdefault(name, (number, line))
            place.taken.add((number, line))
        for line, term in term_lines(section.text):
            keys = keys_of_term(term)
            entry = _Term(number, line, key_of_term(term))
            for each in keys:
                place.terms[each].append(entry)
    return place


def find_passages(
    symbols: Sequence[Symbol], pages: Sequence[Page], links: Iterable[Link]
) -> dict[str, Passage]:
    """Symbol path → its place in the manual, for every symbol that surely has one."""
    return dict(_Finder(symbols, pages, links).found())


def says_something(page: Page, place: Passage) -> bool:
    """Whether the text of a place does more than to refer to another one."""
    return not _REFERS.fullmatch(passage_text(page.sections[place.section].text, place.line))


def _tells_of(symbol: Symbol, page: Page, place: Passage) -> bool:
    """Whether a place says something, or is the heading of an enumeration's items."""
    if place.line >= 0 or not symbol.enum_items or says_something(page, place):
        return says_something(page, place)
    items = {key(item.name) for item in symbol.enum_items}
    return sum(key(term) in items for _, term in term_lines(page.sections[place.section].text)) > 1


class _Finder:
    def __init__(self, symbols: Sequence[Symbol], pages: Sequence[Page], links: Iterable[Link]) -> None:
        self._symbols = {symbol.path: symbol for symbol in symbols}
        self._pages = {page.slug: page for page in pages if page.source == "manual"}
        self._links = {link.source: link.target for link in links if link.kind == "manual"}
        self._places: dict[str, _Place] = {}
        self._sockets: dict[str, set[str]] = defaultdict(set)
        self._explained: dict[str, list[Symbol]] = defaultdict(list)
        # What properties like points_u, points_v are named after: a label "Points" means these, not a collection.
        self._families = {symbol.path.rpartition("_")[0] for symbol in symbols if symbol.kind == "property"}
        for symbol in symbols:
            if symbol.kind == "socket":
                self._sockets[symbol.owner].add(key(symbol.label))
            elif symbol.kind == "class" and symbol.path in self._links:
                self._explained[self._links[symbol.path].partition("#")[0]].append(symbol)

    def found(self) -> Iterator[tuple[str, Passage]]:
        for symbol in self._symbols.values():
            source = symbol.owner if symbol.kind == "socket" else symbol.path
            slug, _, address = self._links.get(source, "").partition("#")
            # Of a switch that is shown the other way round the manual says what the checkbox does.
            if slug not in self._pages or symbol.kind not in _KINDS or INVERTED in symbol.flags:
                continue
            place = self._place(slug)
            found = (Passage(slug, *at) for at in self._candidates(symbol, place, address))
            if passage := next((each for each in found if _tells_of(symbol, place.page, each)), None):
                yield symbol.path, passage

    def _place(self, slug: str) -> _Place:
        if slug not in self._places:
            self._places[slug] = _read(self._pages[slug])
        return self._places[slug]

    def _candidates(self, symbol: Symbol, place: _Place, address: str) -> Iterator[tuple[int, int]]:
        """Where the page may speak of the symbol, the surest place first."""
        if at := place.marks.get(address_of(symbol.path)):
            if at[1] < 0 and symbol.kind != "class":
                yield from self._entry_below(symbol, place, at)
            if self._is_marked(symbol, place, at):
                yield at
        if at := self._defined(symbol, place, address):
            yield at

    def _entry_below(
        self, symbol: Symbol, place: _Place, heading: tuple[int, int]
    ) -> Iterator[tuple[int, int]]:
        """The only term below a heading with the symbol's address that is the symbol's label, as the heading is not."""
        scope, wanted = scope_of(place.page, heading), key(symbol.label)
        if key(place.page.sections[heading[0]].title) == wanted:
            return
        entries = {
            (term.section, term.line)
            for term in place.terms.get(wanted, ())
            if term.own == wanted and term.section in scope
        }
        if len(entries) == 1:
            yield from entries - place.taken

    def _is_marked(self, symbol: Symbol, place: _Place, at: tuple[int, int]) -> bool:
        """Whether the place with the symbol's address is about it.

        Headings also carry the addresses of what is only mentioned below: there half of the label must be found in the
        heading or the first paragraph. A term also carries those of what is set beside it.
        """
        section, line = place.page.sections[at[0]], at[1]
        if symbol.kind == "class":
            return line < 0
        if line < 0:
            said = _stems(section.title if section.level > 1 else "", passage_text(section.text, -1))
            return not symbol.label or _share(symbol.label, said) >= 1 / 2
        is_alone = sum(mark == at for mark in place.marks.values()) == 1
        return is_alone or _is_of(
            symbol, _stems(section.text.split("\n")[line], passage_text(section.text, line))
        )

    def _defined(self, symbol: Symbol, place: _Place, address: str) -> tuple[int, int] | None:
        """Where the page surely defines the symbol's label."""
        if symbol.kind not in {"property", "socket"} or not symbol.label:
            return None
        if symbol.type == "collection" and symbol.path in self._families:
            return None
        scope = scope_of(place.page, place.marks.get(address))
        wanted = key(symbol.label)
        terms = [
            term
            for term in place.terms.get(wanted, ())
            if self._may_be(symbol, term, place, scope)
            and says_something(place.page, Passage(place.page.slug, term.section, term.line))
        ]
        # A term of its own goes before one that it shares with others, as Target before Target/Owner.
        terms = [term for term in terms if term.own == wanted] or terms
        if len(terms) == 1 and self._is_sure(symbol, terms[0], place, address):
            return terms[0].section, terms[0].line
        return None

    def _may_be(self, symbol: Symbol, term: _Term, place: _Place, scope: range) -> bool:
        """Whether nothing speaks against it: another symbol's address, another class's heading, the other sockets."""
        if term.section not in scope or (term.section, term.line) in place.taken:
            return False
        headings = place.chains[term.section][1:]
        sides = [n for n, title in enumerate(headings) if title.lower().startswith(("input", "output"))]
        if symbol.kind == "socket":
            if not sides or headings[sides[-1]].lower()[:3] != symbol.path[len(symbol.owner) + 1 :][:3]:
                return False
            more = set(_stems(symbol.name)) - set(_stems(symbol.label))
            below = set(_stems(*headings[sides[-1] + 1 :]))
            return not more or not below or bool(more & below)
        if sides and key(symbol.label) in self._sockets.get(symbol.owner, ()):
            return False
        return not any(self._is_anothers(title, symbol, place) for title in headings)

    def _is_anothers(self, title: str, symbol: Symbol, place: _Place) -> bool:
        """Whether a heading names another class that the page explains."""
        words = set(_stems(title))
        about = set(_stems(symbol.owner.removeprefix(TYPES), symbol.name, symbol.description))
        return any(
            (name := set(_stems(cls.label)) - KIND_WORDS) and name <= words and not name <= about
            for cls in self._explained[place.page.slug]
            if cls.path != symbol.owner
        )

    def _is_sure(self, symbol: Symbol, term: _Term, place: _Place, address: str) -> bool:
        """Whether the only definition of a label is the symbol's: the page is its class's and the label says enough, or
        the words around both agree.
        """
        label = set(_stems(symbol.label))
        owner = self._symbols.get(symbol.owner)
        plain = _PLAIN_HEADINGS | set(_stems(owner.label if owner else ""))
        headings = set(_stems(*place.chains[term.section][1:])) - plain
        its_own = any(address.startswith(address_of(cls)) for cls in self._lineage(symbol.owner))
        if symbol.kind == "socket" or (its_own and (len(label) > 1 or not headings)):
            return symbol.label != symbol.name or symbol.kind == "socket" or bool(symbol.description)
        return bool(_about(symbol) & (headings | self._words(term, place)))

    def _lineage(self, path: str) -> Iterator[str]:
        while (symbol := self._symbols.get(path)) is not None:
            yield path
            path = symbol.base

    def _words(self, term: _Term, place: _Place) -> set[str]:
        text = passage_text(place.page.sections[term.section].text, term.line)
        return set(_stems(text[:_BEGINNING]))


@cache
def _stems_of(text: str) -> tuple[str, ...]:
    return tuple(terms_of(text))


def _stems(*texts: str) -> list[str]:
    return [word for text in texts for word in _stems_of(text)]


def _share(text: str, said: Iterable[str]) -> float:
    """The share of a text's words that are said."""
    stems = set(_stems(text))
    return len(stems.intersection(said)) / len(stems) if stems else 0.0


def _is_of(symbol: Symbol, said: Sequence[str]) -> bool:
    """Whether a term with the addresses of several symbols is about this one: of an operator it says what is done, not
    only with what; of a property half of the label, or a third of the description.
    """
    share = _share(symbol.label, said)
    if symbol.kind == "operator":
        return share > 1 / 2
    return share >= 1 / 2 or _share(symbol.description, said) >= 1 / 3


def _about(symbol: Symbol) -> set[str]:
    """The words of a symbol beside its label's."""
    return set(_stems(symbol.name, symbol.description)) - set(_stems(symbol.label))


def scope_of(page: Page, mark: tuple[int, int] | None) -> range:
    """The sections at or below the one that a heading's address leads to; all where there is none."""
    sections = page.sections
    if mark is None or mark[1] >= 0:
        return range(len(sections))
    start = mark[0]
    level = sections[start].level
    end = next((n for n in range(start + 1, len(sections)) if sections[n].level <= level), len(sections))
    return range(start, end)
