"""The closest symbols that a version has to one that it lacks, found by comparing the versions' own schemas.

What counts: rare words that two identifiers share (those of the owner for less), what lies below them
(members, parameters, enum items), the same owner or the owner's own replacement, having come when the other
one went, the same kind, and texts that mention the missing name.
"""

from __future__ import annotations

import heapq
import math
import re
from collections import Counter, defaultdict
from typing import TYPE_CHECKING

from kb_build.analysis import stem, words
from kb_build.history import split_path, version_key

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_build.history import History
    from kb_build.records import Symbol

KEPT = 5
_LEAST = 0.3
# Features that more candidates share than this do not find any.
_COMMON = 400
_COMMON_IN_TEXTS = 60
_SHORTEST_PART = 4

_OWNER_WORDS = 0.5
_WHOLE_NAME = 0.6
_PART = 0.7
_BELOW = 0.7
_MENTION = 0.7
_SAME_OWNER = 0.3
_OWNERS_BASE = 0.2
_OWNERS_REPLACEMENT = 0.45
_CAME_THEN = 0.15
_CAME_BEFORE = 0.1
_CAME_TO_OWNER = 0.3
_SAME_KIND = 0.1
_VERSIONS_BEFORE = 2
# Words that took the place of others: seen in so many pairs of alike symbols, and in this share of them.
_ALIKE = 0.5
_LEAST_PAIRS = 3
_LEAST_SHARE = 0.5
_NOT_DATA = frozenset({"ui", "operator"})

_INTERFACE = re.compile(r"[A-Z0-9_]+_(?:PT|MT|HT|OT|UL|AST|GGT|GT|FH|KSI|RE)_")

Bag = dict[str, float]


class _Index:
    """Weighted bags of features of all candidates, for comparing one bag against all of them at once."""

    def __init__(self, bags: Sequence[Bag], common: int) -> None:
        df = Counter(name for bag in bags for name in bag)
        self._idf = {name: math.log(1 + len(bags) / count) for name, count in df.items()}
        self._unknown = math.log(1 + len(bags)) / 2
        self._postings: dict[str, list[tuple[int, float]]] = {
            name: [] for name, count in df.items() if count <= common
        }
        for number, bag in enumerate(bags):
            for name, weight in self._vector(bag).items():
                if name in self._postings:
                    self._postings[name].append((number, weight))

    def knows(self, name: str) -> bool:
        return name in self._idf

    def _vector(self, bag: Bag) -> Bag:
        weighted = {name: weight * self._idf.get(name, self._unknown) for name, weight in bag.items()}
        length = math.sqrt(sum(weight * weight for weight in weighted.values())) or 1.0
        return {name: weight / length for name, weight in weighted.items()}

    def compare(self, bag: Bag, factor: float, scores: defaultdict[int, float]) -> None:
        """Adds the cosine with every candidate that shares a feature, times ``factor``."""
        for name, weight in self._vector(bag).items():
            share = weight * factor
            for number, other in self._postings.get(name, ()):
                scores[number] += share * other


def _stems(text: str) -> list[str]:
    return [stem(word) for word in words(text)]


def _name_bag(path: str) -> Bag:
    """The words of a path: its last name's fully, those above it for less."""
    above, _, name = split_path(path)
    outer = above if above.startswith("bpy.ops") else split_path(above)[2]
    bag = dict.fromkeys(_stems(outer.removeprefix("bpy.ops")), _OWNER_WORDS)
    return bag | dict.fromkeys(_stems(name), 1.0)


def _kind(path: str, below: Sequence[str]) -> str:
    """What sort of thing a path names, told from the path and from what the history knows below it."""
    above, mark, name = split_path(path)
    if mark != ".":
        return "socket"
    if above == "bpy.types":
        return "class"
    if path.startswith("bpy.ops."):
        return "module" if above == "bpy.ops" else "operator"
    if above == "bpy.context":
        return "context"
    if any(entry.startswith("(") for entry in below):
        return "function"
    return "class" if name[:1].isupper() else "property"


def _directly_below(paths: Iterable[str]) -> dict[str, list[str]]:
    """Path → mark and name of all that is one step below it."""
    found: defaultdict[str, list[str]] = defaultdict(list)
    for path in paths:
        above, mark, name = split_path(path)
        found[above].append(mark + name)
    return dict(found)


def _mention_bag(symbol: Symbol, items: Iterable[str]) -> Bag:
    """The words of a symbol's texts, each once."""
    return dict.fromkeys(_stems(" ".join((symbol.label, symbol.description, *items))), 1.0)


class Replacements:
    """Finds the closest symbols of one version. ``symbols`` are that version's."""

    def __init__(self, symbols: Sequence[Symbol], history: History, version: str) -> None:
        by_path = {symbol.path: symbol for symbol in symbols}
        self._candidates = [symbol for symbol in symbols if _is_candidate(symbol, by_path)]
        self._bases = {symbol.path: symbol.base for symbol in symbols if symbol.base}
        self._history = history
        self._known = {symbol.path: number for number, symbol in enumerate(self._candidates)}
        self._missing = {path: last for path, _, last in history.removed_from(version)}
        self._below = _directly_below(history.masks)
        self._members: defaultdict[str, list[int]] = defaultdict(list)
        for number, symbol in enumerate(self._candidates):
            self._members[symbol.owner].append(number)
        order = {name: number for number, name in enumerate(history.versions)}
        self._order = order
        since = history.since(version)
        self._came = [order[since.get(symbol.path, history.versions[0])] for symbol in self._candidates]
        self._kinds = [_candidate_kind(symbol) for symbol in self._candidates]
        self._names = _Index([_name_bag(symbol.path) for symbol in self._candidates], _COMMON)
        self._insides = _Index([self._inside(symbol.path) for symbol in self._candidates], _COMMON)
        texts = [
            _mention_bag(symbol, (f"{item.identifier} {item.name}" for item in symbol.enum_items))
            for symbol in self._candidates
        ]
        self._texts = _Index(texts, _COMMON_IN_TEXTS)
        self._found: dict[str, list[tuple[str, float]]] = {}

    def closest(self, path: str) -> list[tuple[str, float]]:
        """(path, score) of the closest symbols to a missing one, best first; [] when none is close."""
        if path not in self._found:
            self._found[path] = self._items(path) if ":" in path else self._closest(path)
        return self._found[path]

    def _inside(self, path: str) -> Bag:
        return dict.fromkeys(self._below.get(path, ()), 1.0)

    def _closest(self, path: str) -> list[tuple[str, float]]:
        above, _, name = split_path(path)
        last = self._order[self._missing.get(path, self._history.versions[0])]
        kind = _kind(path, self._below.get(path, ()))
        scores: defaultdict[int, float] = defaultdict(float)
        self._names.compare(self._parted(_name_bag(path)), 1.0, scores)
        self._insides.compare(self._inside(path), _BELOW, scores)
        self._texts.compare(dict.fromkeys(_stems(name), 1.0), _MENTION, scores)
        for owner, bonus in self._owners(above):
            for number in self._members.get(owner, ()):
                scores[number] += bonus
        for number in scores:
            came = self._came[number]
            if came == last + 1:
                scores[number] += _CAME_THEN
            elif 0 < came <= last and came > last - _VERSIONS_BEFORE:
                scores[number] += _CAME_BEFORE
            if self._kinds[number] == kind:
                scores[number] += _SAME_KIND
        best = heapq.nlargest(KEPT, scores.items(), key=lambda entry: (entry[1], -entry[0]))
        return [(self._candidates[number].path, round(score, 3)) for number, score in best if score >= _LEAST]

    def _parted(self, bag: Bag) -> Bag:
        """Words that this version does not know are taken apart at one that it does: clear|coat, g|pencil."""
        parted: Bag = {}
        for word, weight in bag.items():
            parted[word] = weight
            if not self._names.knows(word):
                for cut in range(1, len(word)):
                    for part in (word[cut:], word[:cut]):
                        if len(part) >= _SHORTEST_PART and self._names.knows(part):
                            parted[part] = max(weight * 0.7, parted.get(part, 0.0))
        return parted

    def _owners(self, owner: str) -> Iterator[tuple[str, float]]:
        """Where members of ``owner`` may live now, with what that is worth."""
        if owner in {"", "bpy.types", "bpy.ops"}:
            return
        if owner in self._missing:
            for replacement, score in self.closest(owner)[:2]:
                worth = _OWNERS_REPLACEMENT * min(1.0, score)
                yield replacement, worth
                yield from ((base, worth * 0.8) for base in self._ancestors(replacement))
            return
        yield owner, _SAME_OWNER
        yield from ((base, _OWNERS_BASE) for base in self._ancestors(owner))

    def _ancestors(self, path: str) -> Iterator[str]:
        seen = {path, "bpy.types.bpy_struct"}
        while (path := self._bases.get(path, "")) and path not in seen:
            seen.add(path)
            yield path

    def _items(self, path: str) -> list[tuple[str, float]]:
        """For an enum item: the items of the same enumeration, newly come ones first."""
        above, _, name = split_path(path)
        last = self._order[self._missing.get(path, self._history.versions[0])]
        newest = self._history.masks.get(above, 0)
        wanted = set(_stems(name))
        found: list[tuple[str, float]] = []
        for entry in self._below.get(above, ()):
            other = above + entry
            mask = self._history.masks.get(other, 0)
            if entry[0] != ":" or other in self._missing or not mask & newest:
                continue
            came = (mask & -mask).bit_length() - 1
            shared = wanted & set(_stems(entry[1:]))
            score = len(shared) / len(wanted | set(_stems(entry[1:]))) + (0.5 if came == last + 1 else 0.0)
            found.append((other, round(score, 3)))
        best = heapq.nlargest(KEPT, found, key=lambda entry: (entry[1], entry[0]))
        return [(other, score) for other, score in best if score >= _LEAST]


def _is_candidate(symbol: Symbol, by_path: Mapping[str, Symbol]) -> bool:
    """What people write: data API, operators, sockets; not the interface's classes, nor what repeats."""
    if symbol.kind == "enum" or symbol.group in _NOT_DATA or ".bl_rna_get_subclass" in symbol.path:
        return False
    owner = by_path.get(symbol.owner)
    if owner is not None and owner.group in _NOT_DATA:
        return False
    return not any(flag.startswith("same-as:") for flag in symbol.flags)


def _candidate_kind(symbol: Symbol) -> str:
    return {"data": "property"}.get(symbol.kind, symbol.kind)


def is_asked_for(path: str) -> bool:
    """Whether people write it: not the interface's classes, parameters, nor items of shared enumerations."""
    above, mark, name = split_path(path)
    if mark == "(" or "(" in above or path.startswith("rna_enum_"):
        return False
    return _INTERFACE.match(name if above == "bpy.types" else above.removeprefix("bpy.types.")) is None


def find_replacements(
    symbols: Sequence[Symbol], history: History, version: str
) -> Iterator[tuple[str, str, float]]:
    """(missing path, closest path, score) for what ``version`` lacks and an earlier version had."""
    finder = Replacements(symbols, history, version)
    for path, first, _ in history.removed_from(version):
        if version_key(first) < version_key(version) and is_asked_for(path):
            for target, score in finder.closest(path):
                yield path, target, score
