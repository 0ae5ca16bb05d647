"""What a script writes for the choices that the manual lists: ``'MODULAR'`` beside **Modular**.

They stand right below the label of an enumeration (:mod:`kb_build.index.passages`). What is listed among them and is
none of its items in this version is named as such: manuals keep choices that Blender has dropped. The same goes for
what the text calls one ("the Final cache type").
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import key
from kb_build.index.analysis import terms as terms_of
from kb_build.index.analysis import words as words_of
from kb_build.index.label_names import LISTED, LabelName
from kb_build.pages.definitions import term_of
from kb_build.symbols.api_names import TYPES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_build.index.passages import Passage
    from kb_build.pages.page import Page
    from kb_build.symbols.records import Symbol

_SHOWN_VALUES = 8
_LEAST = 2  # choices below a heading that make it a list of them
_LIKE = 3  # letters that words have in common: Vertices, Vertex
_BULLET = re.compile(r"\s*- \*\*(?P<term>.+?):?\*\*")
_LINKED = re.compile(r"\[([^\]]*)\]\([^)]*\)")
_NAMED = r"\b(?:the|an?) [*\"]*([A-Z][\w-]*(?: [A-Z0-9][\w-]*)?)[*\"]* {}\b"


class _Entry(NamedTuple):
    """A term right below a label; ``group`` is the number of its list, -1 for a definition."""

    line: int
    term: str
    group: int


@dataclass(frozen=True, slots=True)
class _Choices:
    """The items of the enumerations that one label stands for; ``settings`` are the keys of what else it may name."""

    symbols: Sequence[Symbol]
    settings: frozenset[str]
    texts: frozenset[str]
    by_key: Mapping[str, set[str]]
    by_words: Mapping[frozenset[str], set[str]]

    @classmethod
    def of(cls, symbols: Sequence[Symbol], settings: Mapping[str, set[str]]) -> _Choices:
        """``settings``: the keys of the labels of each class's members."""
        texts: set[str] = set()
        by_key, by_words = defaultdict[str, set[str]](set), defaultdict[frozenset[str], set[str]](set)
        for symbol in symbols:
            for item in symbol.enum_items:
                for text in (item.name, item.identifier) if item.is_taken else ():
                    texts.add(text)
                    by_key[key(text)].add(item.identifier)
                    by_words[frozenset(terms_of(text))].add(item.identifier)
        others = frozenset(label for symbol in symbols for label in settings[symbol.owner])
        return cls(symbols, others, frozenset(texts), by_key, by_words)

    def identifiers(self, term: str) -> list[str]:
        """The items that a term means, all of those that it lists; empty where one is not surely known."""
        found = [self._identifier(part) for part in (term, *LISTED.split(term))]
        if found[0]:
            return found[:1]
        return found[1:] if all(found[1:]) else []

    def _identifier(self, text: str) -> str:
        items = self.by_key.get(key(text))
        if items is None and (words := frozenset(terms_of(text))):
            items = self.by_words.get(words)
        return next(iter(items)) if items and len(items) == 1 else ""

    def written(self, identifier: str) -> str:
        """What a script writes for an item, and which of several settings takes it, if not all do."""
        takers = [symbol for symbol in self.symbols if _has_item(symbol, identifier)]
        names = dict.fromkeys(f"`{symbol.name}`" for symbol in takers)
        return f"`{identifier!r}`" + (
            f" ({', '.join(names)} only)" if len(takers) < len(self.symbols) else ""
        )

    def lack(self, term: str) -> bool:
        """Whether a term is surely none: neither a setting, nor like any item of those that Blender lists in full."""
        own = {word[:_LIKE] for text in self.texts for word in words_of(text)}
        words = {word[:_LIKE] for word in words_of(term)}
        known = not words or words & own or key(term) in self.settings
        return self.are_fixed and len(self.symbols[0].enum_items) > 1 and not known

    @property
    def are_fixed(self) -> bool:
        """Whether the items are the same in all contexts."""
        return not any(
            symbol.enum_computed or any(item.where for item in symbol.enum_items) for symbol in self.symbols
        )

    def told(self, lacking: str) -> str:
        """That an enumeration has other items than this one."""
        symbol = self.symbols[0]
        items = [f"`{item.identifier!r}`" for item in symbol.enum_items]
        more = ", …" if len(items) > _SHOWN_VALUES else ""
        return (
            f"(“{lacking}” is not a value of `{symbol.path.removeprefix(TYPES)}` in this Blender, which has "
            f"{', '.join(items[:_SHOWN_VALUES])}{more})"
        )


def find_value_names(
    symbols: Iterable[Symbol], pages: Sequence[Page], passages: Mapping[str, Passage]
) -> list[LabelName]:
    """Rows beside those of labels: the identifiers of choices, and which are none, in the order of the pages."""
    at: dict[str, dict[tuple[int, int], list[Symbol]]] = defaultdict(lambda: defaultdict(list))
    settings: dict[str, set[str]] = defaultdict(set)
    for symbol in symbols:
        if symbol.kind == "property":
            settings[symbol.owner].add(key(symbol.label))
            if symbol.enum_items and (passage := passages.get(symbol.path)):
                at[passage.slug][passage.section, passage.line].append(symbol)
    labels: dict[str, set[tuple[int, int]]] = defaultdict(set)
    for passage in passages.values():
        labels[passage.slug].add((passage.section, passage.line))
    return [
        row
        for page in pages
        if page.slug in at
        for row in _of_page(
            page,
            {place: _Choices.of(there, settings) for place, there in at[page.slug].items()},
            labels[page.slug],
        )
    ]


def _of_page(
    page: Page, at: Mapping[tuple[int, int], _Choices], labels: set[tuple[int, int]]
) -> Iterator[LabelName]:
    """The rows of a page; ``labels`` are the places of symbols, which are no choices."""
    taken = set(labels)
    for (section, line), choices in sorted(at.items(), reverse=True):
        lines = page.sections[section].text.split("\n")
        entries = [entry for entry in _entries(lines, line) if (section, entry.line) not in taken]
        meant = {entry: choices.identifiers(entry.term) for entry in entries}
        known = sum(map(bool, meant.values()))
        if known < _LEAST and (line < 0 or known * 2 < len(entries)):
            continue
        for entry, identifiers in meant.items():
            taken.add((section, entry.line))
            if identifiers and entry.term not in identifiers:
                names = ", ".join(map(choices.written, identifiers))
                yield LabelName(page.slug, section, entry.line, names)
            elif not identifiers and _is_choice(entry, meant) and choices.lack(entry.term):
                yield LabelName(page.slug, section, entry.line, choices.told(entry.term))
    for row in _called(page, [choices for choices in at.values() if len(choices.symbols) == 1]):
        if (row.section, row.line) not in taken:
            yield row


def _has_item(symbol: Symbol, identifier: str) -> bool:
    return any(item.identifier == identifier and item.is_taken for item in symbol.enum_items)


def _is_choice(entry: _Entry, meant: Mapping[_Entry, Sequence[str]]) -> bool:
    """Whether a term stands in a list of which at least half are known choices."""
    group = [bool(found) for each, found in meant.items() if each.group == entry.group]
    return entry.group >= 0 and sum(group) * 2 >= len(group)


def _entries(lines: Sequence[str], label: int) -> Iterator[_Entry]:
    """The terms right below a label; ``label`` is its line, -1 for the heading."""
    above = _depth(lines[label]) if label >= 0 else -1
    start = label + 1
    while label >= 0 and start < len(lines) and term_of(lines[start]) and _depth(lines[start]) == above:
        start += 1  # several terms share what stands below
    depth, group, in_list = -1, 0, False
    for number in range(start, len(lines)):
        line = lines[number]
        if not line.strip():
            continue
        if _depth(line) <= above:
            return
        depth = _depth(line) if depth < 0 else depth
        if _depth(line) != depth:
            continue
        bullet = _BULLET.match(line)
        group += in_list and not bullet
        in_list = bool(bullet)
        if term := _LINKED.sub(r"\1", bullet["term"] if bullet else term_of(line)):
            yield _Entry(number, term, group if bullet else -1)


def _called(page: Page, enumerations: Iterable[_Choices]) -> Iterator[LabelName]:
    """The rows of lines in which a page's text calls something a choice that is none: "the Final cache type"."""
    spoken = [(words, choices) for choices in enumerations for words in _spoken(choices.symbols[0])]
    about = set(terms_of(page.title))
    for number, section in enumerate(page.sections):
        told: dict[int, dict[str, None]] = defaultdict(dict)
        for words, choices in spoken:
            for match in (
                re.finditer(_NAMED.format(re.escape(words)), section.text) if words in section.text else ()
            ):
                if choices.lack(match[1]) and not about.intersection(terms_of(match[1])):
                    told[section.text.count("\n", 0, match.start())][choices.told(match[1])] = None
        for line, texts in told.items():
            yield LabelName(page.slug, number, line, " ".join(texts))


def _spoken(symbol: Symbol) -> list[str]:
    """What a setting is called within a sentence, of those names that are more than one word."""
    names = (symbol.name.replace("_", " "), symbol.label.lower())
    return [name for name in dict.fromkeys(names) if " " in name]


def _depth(line: str) -> int:
    return len(line) - len(line.lstrip())
