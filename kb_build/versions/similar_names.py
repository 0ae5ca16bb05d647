"""Finds similar names: for a symbol that a version lacks, the closest symbols that it has, by comparing the schemas.

They are guesses, for symbols whose successor no source names.

What counts: rare words that two identifiers share (those of the owner for less), what lies below them
(members, parameters, enum items), the same owner or the owner's own replacement, having come when the other
one went, the same kind, and texts that mention the missing name.
"""

from __future__ import annotations

import heapq
import re
from collections import Counter, defaultdict
from functools import cache
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, stem, words
from kb_build.symbols.api_names import OPERATORS, STRUCT, TYPES, interface_part
from kb_build.symbols.paths import split_path
from kb_build.versions.feature_index import Bag, FeatureIndex, Mentions
from kb_build.versions.history import TOP
from simworlds.releases import minor_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from kb_build.symbols.records import Symbol
    from kb_build.versions.history import ApiHistory

KEPT = 5
_LEAST = 0.3
# Features that more candidates share than this do not find any.
_COMMON = 200
_COMMON_IN_TEXTS = 60
_SHORTEST_PART = 4
_SHORTEST_PREFIX = 3

_OWNER_WORDS = 0.5
_WHOLE_NAME = 0.6
_PART = 0.7
_OVERTAKEN = 0.3
_BELOW = 0.7
_MENTION = 0.7
_SAME_OWNER = 0.3
_OWNERS_BASE = 0.2
_OWNERS_REPLACEMENT = 0.45
_CAME_THEN = 0.15
_CAME_BEFORE = 0.1
_LONG_ELSEWHERE = 0.85
_CAME_TO_OWNER = 1.8
_SAME_KIND = 0.1
_ITEM_CAME_THEN = 0.5
_VERSIONS_BEFORE = 2
_WHERE_IT_STOOD = 1.2
# Elsewhere, with no more than this share of words in common, hardly any with a lower score takes its place.
_FAR = 1.1
_FEW_WORDS = 1 / 3
_MENTIONED = 0.9  # unless its own text says so much of the missing name
_RIVAL = 0.7  # of the best, from which on a second one may be an owner's replacement too
_HOLDER = 0.25
_MOST_ITEMS = 300  # more than in any enumeration but that of the icons
_FEW_HOLDERS = 2
_OF_MODULES = 0.2
_THEME = "bpy.types.Theme"  # colours of the interface stand for nothing but each other
# Words that took the place of others: seen in so many pairs of alike symbols, and in this share of them.
_ALIKE = 0.5
_LEAST_INSIDE = 3
_LEAST_PAIRS = 5
_LEAST_SHARE = 0.5

_LONE_CAPITAL = re.compile(r"(?<![A-Z])[A-Z]{2}(?=[a-z])(?!s\b)")


@cache
def _stems(text: str) -> tuple[str, ...]:
    """The stems of a name's words. FCurve is one word, as it is in fcurves."""
    return tuple(stem(word) for word in words(_LONE_CAPITAL.sub(lambda match: match[0].capitalize(), text)))


def _name_bag(path: str) -> Bag:
    """The words of a path: its last name's fully, those above it for less; and the last name as a whole."""
    above, _, name = split_path(path)
    outer = above if above.startswith("bpy.ops") else split_path(above)[2]
    bag = dict.fromkeys(_stems(outer.removeprefix("bpy.ops")), _OWNER_WORDS)
    return bag | dict.fromkeys(_stems(name), 1.0) | {f"={name}": _WHOLE_NAME}


def _kind(path: str, below: Sequence[str]) -> str:
    """The kind of a symbol, from its path and from what the history has below it."""
    above, mark, name = split_path(path)
    if mark != ".":
        return "socket"
    if above == "bpy.types":
        return "class"
    if path.startswith(OPERATORS):
        return "module" if above == "bpy.ops" else "operator"
    if above == "bpy.context":
        return "context"
    if any(entry.startswith("(") for entry in below):
        return "function"
    return "class" if name[:1].isupper() else "property"


def _directly_below(paths: Iterable[str]) -> dict[str, list[str]]:
    """Path → mark and name of all that is one step below it."""
    below: defaultdict[str, list[str]] = defaultdict(list)
    for path in paths:
        above, mark, name = split_path(path)
        below[above].append(mark + name)
    return dict(below)


def _holders(symbols: Iterable[Symbol]) -> dict[str, list[str]]:
    """Class → the classes that have a collection of it (MeshEdge → Mesh), unless many have."""
    holders: defaultdict[str, set[str]] = defaultdict(set)
    for symbol in symbols:
        if symbol.type == "collection" and symbol.target:
            holders[TYPES + symbol.target].add(symbol.owner)
    return {
        target: sorted(owners - {target}) for target, owners in holders.items() if len(owners) <= _FEW_HOLDERS
    }


def _is_of_module(path: str) -> bool:
    """Whether a path is of a Python module, ``gpu.state.blend_set``, rather than of Blender's data or operators."""
    return not path.startswith((TYPES, OPERATORS, "bpy.context.", "bpy.data."))


def _text(symbol: Symbol) -> str:
    """A symbol's label, description and enum items; not those of the icons, which are called like anything."""
    listed = symbol.enum_items if len(symbol.enum_items) <= _MOST_ITEMS else ()
    items = (f"{item.identifier} {item.name}" for item in listed)
    return " ".join((symbol.label, symbol.description, *items))


class SimilarNames:
    """Finds the closest symbols of one version, which the history must know. ``symbols`` are that version's."""

    def __init__(self, symbols: Sequence[Symbol], history: ApiHistory, version: str) -> None:
        by_path = {symbol.path: symbol for symbol in symbols}
        self._candidates = [symbol for symbol in symbols if _is_candidate(symbol, by_path)]
        self._bases = {symbol.path: symbol.base for symbol in symbols if symbol.base}
        self._history = history
        self._known = {symbol.path: number for number, symbol in enumerate(self._candidates)}
        order = {name: number for number, name in enumerate(history.versions)}
        # Missing path → the number of the first version without it.
        self._missing = {
            span.path: order[span.gone] if span.gone else order[span.last] + 1
            for span in history.removed_from(version)
        }
        self._below = _directly_below(history.masks)
        self._members: defaultdict[str, list[int]] = defaultdict(list)
        for number, symbol in enumerate(self._candidates):
            self._members[symbol.owner].append(number)
        self._led_to = {symbol.path: symbol.collection or symbol.target for symbol in symbols}
        self._holders = _holders(symbols)
        self._themes = [symbol.path.startswith(_THEME) for symbol in self._candidates]
        self._of_modules = [_is_of_module(symbol.path) for symbol in self._candidates]
        self._found_items: dict[tuple[str, str, int], list[tuple[str, float]]] = {}
        self._bit = 1 << order[minor_of(version)]
        arrived = {each.path: order[each.first] for each in history.arrivals(version)}
        self._came = [arrived.get(symbol.path, 0) for symbol in self._candidates]
        self._kinds = [_candidate_kind(symbol) for symbol in self._candidates]
        self._names = FeatureIndex([_name_bag(symbol.path) for symbol in self._candidates], _COMMON)
        self._insides = FeatureIndex([self._inside(symbol.path) for symbol in self._candidates], _COMMON)
        self._mentions = Mentions(map(_text, self._candidates), _COMMON_IN_TEXTS, stem)
        self._found: dict[str, list[tuple[str, float]]] = {}
        self._successors = self._learn_successors()

    def closest(self, path: str) -> list[tuple[str, float]]:
        """(path, score) of the closest symbols to a missing one, best first; [] when none is close."""
        if path not in self._found:
            self._found[path] = self._items(path) if ":" in path else self._closest(path)
        return self._found[path]

    def near(self, path: str) -> Iterator[tuple[str, float]]:
        """Those of the closest symbols that are worth naming: not what is elsewhere and called quite otherwise.

        Operators are not judged so: whole modules of them got other names.
        """
        if ":" in path or path.startswith(OPERATORS):
            yield from self.closest(path)
            return
        above, _, name = split_path(path)
        wanted = {word for word in self._today(dict.fromkeys(_stems(name), 1.0)) if word in self._names}
        mentions = self._mentions.coverage(set(_stems(name)), besides=self._names)
        for target, score in self.closest(path):
            owner, _, last = split_path(target)
            having = set(_stems(last))
            alike = len(wanted & having) / len(wanted | having or {""})
            mentioned = mentions.get(self._known[target], 0.0) >= _MENTIONED
            if owner == above or score >= _FAR or alike > _FEW_WORDS or mentioned:
                yield target, score

    def _inside(self, path: str) -> Bag:
        return dict.fromkeys(self._below.get(path, ()), 1.0)

    def _closest(self, path: str) -> list[tuple[str, float]]:
        above, _, name = split_path(path)
        gone = self._missing.get(path, 1)
        kind = _kind(path, self._below.get(path, ()))
        scores: defaultdict[int, float] = defaultdict(float)
        names = self._names.vector(self._today(_name_bag(path)))
        self._names.add_cosines(names, 1.0, scores)
        self._insides.add_cosines(self._insides.vector(self._inside(path)), _BELOW, scores)
        mentions = self._mentions.coverage(set(_stems(name)), besides=self._names)
        at_home: dict[int, float] = {}
        for owner, bonus in self._owners(above):
            members = self._members.get(owner, ())
            self._names.add_common(names, members, scores)
            arrived = sum(self._came[number] == gone for number in members)
            for number in members:
                # One that came alone says more than one of many.
                came_here = _CAME_TO_OWNER / (1 + arrived) if self._came[number] == gone else 0.0
                at_home[number] = bonus * (1 + came_here)
        if kind == "class":
            alike = [number for number in scores if self._kinds[number] == kind]
            self._names.add_common(names, alike, scores)
            if instance := self._known.get(self._instance_of(path)):
                scores[instance] += _WHERE_IT_STOOD
        ranked: list[tuple[float, int]] = []
        of_theme, of_module = path.startswith(_THEME), _is_of_module(path)
        for number in scores.keys() | at_home.keys() | mentions.keys():
            came = self._came[number]
            total = scores[number]
            if came == gone:
                total += _CAME_THEN
            elif gone - _VERSIONS_BEFORE <= came < gone and came:
                total += _CAME_BEFORE
            elif number not in at_home:
                total *= _LONG_ELSEWHERE
            total += at_home.get(number, 0.0) + _MENTION * mentions.get(number, 0.0)
            total += _SAME_KIND if self._kinds[number] == kind else 0.0
            total += _OF_MODULES if of_module and self._of_modules[number] else 0.0
            if self._themes[number] and not of_theme:
                continue
            if total >= _LEAST:
                ranked.append((total, -number))
        best = heapq.nlargest(KEPT, ranked)
        return [(self._candidates[-number].path, round(score, 3)) for score, number in best]

    def _learn_successors(self) -> dict[str, list[str]]:
        """Removed word → words that took its place, learnt from symbols that differ only in the name."""
        changes = list(self._renamings())
        gone = Counter(word for lost, _ in changes for word in lost)
        pairs = Counter((word, other) for lost, won in changes for word in lost for other in won)
        # Of several words that went together, the one that went most regularly is what was replaced.
        pairs = Counter(
            (max(lost, key=lambda word: (pairs[word, other] / gone[word], gone[word], word)), other)
            for lost, won in changes
            for other in won
        )
        before = Counter(word for path in self._missing if has_similar(path) for word in _name_bag(path))
        successors: defaultdict[str, list[str]] = defaultdict(list)
        for (word, other), count in sorted(pairs.items()):
            dying = before[word] > self._names.df(word)
            if dying and count >= _LEAST_PAIRS and count >= _LEAST_SHARE * gone[word]:
                successors[word].append(other)
        return dict(successors)

    def _renamings(self) -> Iterator[tuple[set[str], set[str]]]:
        """(words lost, words won) between a missing symbol and a newer one that has the same inside."""
        for path in self._missing:
            inside = self._inside(path)
            if len(inside) < _LEAST_INSIDE or not has_similar(path):
                continue
            scores: defaultdict[int, float] = defaultdict(float)
            self._insides.add_cosines(self._insides.vector(inside), 1.0, scores)
            number = max(scores, key=lambda number: (scores[number], -number), default=None)
            if number is None or scores[number] < _ALIKE or not self._came[number]:
                continue
            old, new = _name_bag(path), _name_bag(self._candidates[number].path)
            lost = {word for word in old if word not in new and word[0] != "="}
            won = {word for word in new if word not in old and word[0] != "="}
            if lost and won:
                yield lost, won

    def _today(self, bag: Bag) -> Bag:
        """The bag with what took its words' place; words no longer known are taken apart: clear|coat."""
        today = dict(bag)
        for word, weight in bag.items():
            if after := self._successors.get(word):
                today[word] = weight * _OVERTAKEN
                today.update((other, max(weight, today.get(other, 0.0))) for other in after)
            elif word not in self._names and word[0] != "=":
                for part in self._relatives(word):
                    today[part] = max(weight * _PART, today.get(part, 0.0))
        return today

    def _relatives(self, word: str) -> list[str]:
        """Known words that an unknown one is made of (clear|coat) or short for (sep: separate)."""
        halves = [half for cut in range(1, len(word)) for half in (word[cut:], word[:cut])]
        parts = [half for half in halves if len(half) >= _SHORTEST_PART and half in self._names]
        longer = self._names.starting_with(word) if len(word) >= _SHORTEST_PREFIX else []
        return parts + longer

    def _owners(self, owner: str) -> Iterator[tuple[str, float]]:
        """Where members of ``owner`` may live now, with what that is worth."""
        if owner in {"", "bpy.types", "bpy.ops"}:
            return
        if owner in self._missing:
            rivals = [row for row in self.closest(owner)[:2] if row[1] >= _RIVAL * self.closest(owner)[0][1]]
            for replacement, score in rivals:
                worth = _OWNERS_REPLACEMENT * min(1.0, score) * score / rivals[0][1]
                yield replacement, worth
                yield from ((base, worth * 0.8) for base in self._ancestors(replacement))
            return
        yield owner, _SAME_OWNER
        yield from ((holder, _HOLDER) for holder in self._holders.get(owner, ()))
        yield from ((base, _OWNERS_BASE) for base in self._ancestors(owner))

    def _instance_of(self, path: str) -> str:
        """For a missing collection class, ``NodeTreeInputs``: the class that stands where it stood.

        Such classes are called after the owner and its property; what took the property's place leads there.
        """
        name = path.removeprefix(TYPES)
        for cut in range(1, len(name)):
            owner, end = TYPES + name[:cut], key(name[cut:])
            if not name[cut].isupper() or owner not in self._below:
                continue
            for entry in self._below[owner]:
                if entry[0] == "." and key(entry) == end:
                    there = owner + entry
                    successors = self.closest(there)[:1] if there in self._missing else [(there, 1.0)]
                    return TYPES + self._led_to.get(successors[0][0], "") if successors else ""
        return ""

    def _ancestors(self, path: str) -> Iterator[str]:
        seen = {path, STRUCT}
        while (path := self._bases.get(path, "")) and path not in seen:
            seen.add(path)
            yield path

    def _items(self, path: str) -> list[tuple[str, float]]:
        """For an enum item: the items of the same enumeration, by words shared and by having come then."""
        above, _, name = split_path(path)
        if above in self._missing:
            return self.closest(above)
        enumeration = self._history.shared.get(above, above)
        gone = self._missing.get(path, 1)
        if (enumeration, name, gone) not in self._found_items:
            self._found_items[enumeration, name, gone] = self._closest_items(enumeration, name, gone)
        return [(above + entry, score) for entry, score in self._found_items[enumeration, name, gone]]

    def _closest_items(self, enumeration: str, name: str, gone: int) -> list[tuple[str, float]]:
        wanted = set(_stems(name))
        scored: list[tuple[float, str]] = []
        entries = self._below.get(enumeration, ())
        for entry in entries if len(entries) <= _MOST_ITEMS else ():
            mask = self._history.masks[enumeration + entry]
            if entry[0] == ":" and mask & self._bit:
                having = set(_stems(entry[1:]))
                alike = len(wanted & having) / len(wanted | having or {""})
                came = mask & -mask == 1 << gone
                scored.append((round(alike + (_ITEM_CAME_THEN if came else 0.0), 3), entry))
        return [(entry, score) for score, entry in heapq.nlargest(KEPT, scored) if score >= _LEAST]


def _is_candidate(symbol: Symbol, by_path: Mapping[str, Symbol]) -> bool:
    """Whether a symbol can be a replacement: data API, operators, sockets; no interface, no repeated members."""
    if symbol.kind == "enum" or symbol.is_of_interface or symbol.is_class_lookup:
        return False
    owner = by_path.get(symbol.owner)
    if owner is not None and owner.is_of_interface:
        return False
    return not symbol.same_as


def _candidate_kind(symbol: Symbol) -> str:
    return {"data": "property"}.get(symbol.kind, symbol.kind)


def has_similar(path: str) -> bool:
    """Whether similar names are looked for: not for interface classes, parameters, items of shared enumerations."""
    above, mark, _ = split_path(path)
    if mark == "(" or "(" in above or path.startswith("rna_enum_"):
        return False
    return not interface_part(path)


def find_similar_names(
    symbols: Sequence[Symbol], history: ApiHistory, version: str, besides: Collection[str] = ()
) -> Iterator[tuple[str, str, float]]:
    """(missing path, closest path, score) for what ``version`` lacks and an earlier version had.

    Nothing for a version that the history does not know (see History.including), nothing for what is in ``besides``,
    and nothing for what went with its owner: what resembles that is told of it.
    """
    if minor_of(version) not in history.versions:
        return
    finder = SimilarNames(symbols, history, version)
    for span in history.removed_from(version):
        if not span.gone or span.path in besides or not has_similar(span.path):
            continue
        above, _, _ = split_path(span.path)
        if above in TOP or history.exists(above, version):
            for target, score in finder.near(span.path):
                yield span.path, target, score
