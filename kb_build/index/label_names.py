"""The Python names of what the manual calls by its labels: beside **Frame Start** belongs what a script writes.

The passage that is about a symbol (:mod:`kb_build.index.passages`) begins with a term or stands below a heading. Of
the symbols of one such label, those count that are called just so; of a class and its subclasses, the class. Where
more different names are left than two, or than the label lists, or where it is not sure that the label means them, it
has none. Operators are added that have no passage, or several (:mod:`kb_build.index.operator_labels`).
"""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import key
from kb_build.index.analysis import terms as terms_of
from kb_build.index.passages import KIND_WORDS, Passage, keys_of_term
from kb_build.pages.definitions import term_of
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flags import new_subscript

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_build.index.operator_labels import LabelledOperator
    from kb_build.pages.page import Page
    from kb_build.symbols.records import Symbol

_MOST = 2
# Between what a label lists.
LISTED = re.compile(r"\s*(?:/|,|&| and | or )\s*")


class LabelName(NamedTuple):
    """What a script writes for a label: of the heading of a page's section (line -1), or of a term in its text."""

    slug: str
    section: int
    line: int
    names: str


def find_label_names(
    symbols: Sequence[Symbol],
    pages: Sequence[Page],
    passages: Mapping[str, Passage],
    labelled: Iterable[LabelledOperator] = (),
) -> list[LabelName]:
    """The names of all labels that surely have one, in the order of the pages.

    ``labelled`` are operators that are surely meant by a label, whether or not it has their passage.
    """
    by_path = {symbol.path: symbol for symbol in symbols}
    at: dict[str, dict[tuple[int, int], list[Symbol]]] = defaultdict(lambda: defaultdict(list))
    for path, (slug, section, line) in passages.items():
        at[slug][section, line].append(by_path[path])
    calls: dict[Passage, dict[str, str]] = defaultdict(dict)
    for place, path, arguments, _ in labelled:
        calls[place][path] = f"{path}({arguments})"
        at[place.slug].setdefault((place.section, place.line), [])
    return [
        name for page in pages if page.slug in at for name in _of_page(page, at[page.slug], by_path, calls)
    ]


def _of_page(
    page: Page,
    at: Mapping[tuple[int, int], Sequence[Symbol]],
    by_path: Mapping[str, Symbol],
    calls: Mapping[Passage, Mapping[str, str]],
) -> Iterator[LabelName]:
    lines = {number: page.sections[number].text.split("\n") for number, _ in at}
    # The class that the page's head names: its sockets need not repeat it.
    classes = [symbol for symbol in _headed(page, 0, at.get((0, -1), ())) if symbol.kind == "class"]
    subject = classes[0].path if len(classes) == 1 else ""
    for place, symbols in sorted(at.items()):
        is_heading = place[1] < 0
        label = page.sections[place[0]].title if is_heading else term_of(lines[place[0]][place[1]])
        if not label:
            continue
        there = _headed(page, place[0], symbols) if is_heading else symbols
        meant = _called(label, there)
        if len(meant) > 1:
            meant = _in_order(label, _bases_of(meant, by_path))
        called = calls.get(Passage(page.slug, *place), {})
        if called.keys() >= {symbol.path for symbol in meant or there}:
            names = dict.fromkeys(called.values())
        else:
            names = dict.fromkeys(filter(None, (_name(symbol, subject) for symbol in meant)))
        if 0 < len(names) <= max(_MOST, len(LISTED.split(label))):
            yield LabelName(page.slug, *place, ", ".join(f"`{name}`" for name in names))


def _called(label: str, symbols: Sequence[Symbol]) -> Sequence[Symbol]:
    """The symbols that are called as the label says, or that it surely means nevertheless: as the only one there."""
    if len(symbols) == 1:
        return symbols
    keys = keys_of_term(label)
    if exactly := [symbol for symbol in symbols if key(symbol.label) in keys]:
        return exactly
    words = set(terms_of(label))
    related = [symbol for symbol in symbols if words.intersection(terms_of(symbol.label))]
    lists_them = len(LISTED.split(label)) > 1
    return symbols if lists_them or len(related) == len(symbols) else ()


def _headed(page: Page, section: int, symbols: Sequence[Symbol]) -> list[Symbol]:
    """Without the classes that a section only mentions, of which a heading has the marks, too.

    The only one that a page's title has may be said in other words.
    """
    words = set(terms_of(page.sections[section].title))
    is_free = section == 0 and len(symbols) == 1
    return [
        each for each in symbols if each.kind != "class" or _heads(words, set(terms_of(each.label)), is_free)
    ]


def _heads(words: set[str], own: set[str], is_free: bool) -> bool:
    if is_free:
        return bool(words & own)
    words, own = words - KIND_WORDS, own - KIND_WORDS
    return bool(words & own) and (own <= words or words <= own)


def _bases_of(symbols: Sequence[Symbol], by_path: Mapping[str, Symbol]) -> list[Symbol]:
    """Without members that a base class of their own has, too, under that name."""
    owners = {(symbol.owner, symbol.name) for symbol in symbols}
    return [
        symbol
        for symbol in symbols
        if not any((base, symbol.name) in owners for base in _above(symbol.owner, by_path))
    ]


def _above(cls: str, by_path: Mapping[str, Symbol]) -> Iterator[str]:
    while (symbol := by_path.get(cls)) is not None and symbol.base:
        yield symbol.base
        cls = symbol.base


def _in_order(label: str, symbols: Sequence[Symbol]) -> list[Symbol]:
    """In the order in which a label lists them: End and Start of "Start, End" change places."""
    parts = [set(terms_of(part)) for part in LISTED.split(label)]

    def place(symbol: Symbol) -> int:
        own = {*terms_of(symbol.label), *terms_of(symbol.name)}
        return max(range(len(parts)), key=lambda number: (len(parts[number] & own), -number))

    return sorted(symbols, key=place)


def _name(symbol: Symbol, subject: str) -> str:
    """What a script writes for a symbol, without what every reader knows."""
    if symbol.kind == "operator":
        return f"{symbol.path}()"
    if symbol.kind != "socket":
        return symbol.path.removeprefix(TYPES)
    subscript = new_subscript(symbol)
    if not subscript or symbol.owner == subject:
        return subscript
    return f"{symbol.owner.removeprefix(TYPES)}.{subscript}"
