"""Symbols that only other versions have: looked up by path, by member of a class, by spelling, by name alone."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, words
from kb_build.symbols.api_names import CONTEXT, ID, TYPES
from kb_build.symbols.paths import argument_of, item_of, plain_path, socket_node, split_path
from kb_serve.recognise.chains.variables import usual_classes
from kb_serve.recognise.likely.likely_keywords import likely_keywords

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_serve.lookups.records import Successor
    from kb_serve.reader import BaseReader

_INSTANCES = {CONTEXT: "bpy.context"}
_LISTING = "listing of"  # how the sources begin that are no word on a change
_MOST_OWNERS = 40  # a name that more removed symbols have says nothing about its class


@dataclass(frozen=True, slots=True)
class RemovedSymbol:
    """A symbol that only other versions have.

    ``first`` and ``last`` are the versions that had it, ``gone`` the first one without it ("" for what only newer
    versions have). ``successors`` take its place, by written sources: one with an empty target says why nothing
    does. ``similar`` are guesses with their scores, best first, where no source is known.
    """

    path: str
    first: str
    last: str
    gone: str
    successors: tuple[Successor, ...] = ()
    similar: tuple[tuple[str, float], ...] = ()

    def is_dated(self, versions: Sequence[str]) -> bool:
        """Whether ``gone`` is the very version that lost it: next after ``last`` in ``versions``, or by a source.

        A listing of what a version has does not say since when it lacks the rest.
        """
        told = (one for one in self.successors if not one.source.startswith(_LISTING))
        return any(successor.version == self.gone for successor in told) or self.was_last(versions)

    def was_last(self, versions: Sequence[str]) -> bool:
        """Whether ``last`` is the version right before ``gone`` in ``versions``: none between them may have it."""
        known = self.last in versions and self.gone in versions
        return known and versions.index(self.gone) == versions.index(self.last) + 1

    @property
    def targets(self) -> tuple[str, ...]:
        """The paths that take its place, best first."""
        return tuple(successor.target for successor in self.successors if successor.target)

    def renamed_argument(self, call: str) -> tuple[str, str] | None:
        """(its name, what a function or operator has in its place), where that is one argument and no more is told."""
        old, targets = argument_of(self.path), self.targets
        if not old or len(targets) != 1 or self.successors[0].how:
            return None
        new = argument_of(targets[0])
        return (old, new) if new and plain_path(targets[0]) == call and not item_of(targets[0]) else None

    @property
    def without_successor(self) -> bool:
        """Whether it is known that nothing takes its place."""
        return bool(self.successors) and not self.targets


def for_reading(removed: RemovedSymbol) -> RemovedSymbol:
    """A removed property that is read, not assigned: what took its place, getters (``select_get``) first."""
    getters_first = sorted(removed.successors, key=lambda successor: not successor.target.endswith("_get"))
    return replace(removed, successors=tuple(getters_first))


def _nearest_to(owner: str, removed: RemovedSymbol) -> RemovedSymbol:
    """A symbol of a removed class, with that of its successors first which the class has that was asked."""
    own_first = sorted(removed.successors, key=lambda one: not one.target.startswith(f"{owner}."))
    return replace(removed, successors=tuple(own_first))


def _owners_of_targets(removed: RemovedSymbol) -> Iterator[str]:
    """The classes that have what takes a symbol's place."""
    yield from (split_path(target)[0] for target in removed.targets)


def _new_names(removed: RemovedSymbol) -> Iterator[str]:
    """What took a symbol's place, without its class, and how."""
    for successor in removed.successors:
        yield from (successor.target.rpartition(".")[2], successor.how)


class RemovedSymbolLookup:
    """Looks up symbols that only other versions have."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def of_path(self, path: str) -> RemovedSymbol | None:
        """A removed symbol by its exact path; None for what this version has or takes under the former name."""
        span = self._reader.history.removed(path)
        if span is None or self._reader.history.still_works(path):
            return None
        successors = tuple(self._reader.history.successors(path) or dict.fromkeys(self._of_same_items(path)))
        similar = () if successors else self._similar(path)
        return RemovedSymbol(path, *span, successors, similar)

    def _similar(self, path: str) -> tuple[tuple[str, float], ...]:
        """What resembles a symbol without known successor; of an argument, ``f(x)``, the others of its call."""
        whole, mark, argument = split_path(path)
        symbol = self._reader.symbol(whole) if mark == "(" and argument.isidentifier() else None
        if symbol is None:
            return tuple(self._reader.history.similar_names(path))
        labels = {parameter.name: parameter.label for parameter in symbol.parameters}
        alike = likely_keywords(argument, labels) if argument not in labels else ()
        return tuple((f"{whole}({name})", 1.0) for name in alike)

    def _of_same_items(self, path: str) -> Iterator[Successor]:
        """What took the place of an item, or why nothing did, where that is known of a property with the same items,
        which may have kept it longer.
        """
        item = item_of(path)
        items = self._items_beside(path) if item else frozenset()
        if not items:
            return
        for other in self._reader.history.removed_named(item):
            holder = other.removesuffix(f":{item}")
            same = self._reader.symbol(holder) if other != path and "(" not in holder else None
            if same is None or not items <= {i.identifier for i in same.enum_items}:
                continue
            for successor in self._reader.history.successors(other):
                new = successor.target.removeprefix(f"{holder}:")
                if new in items:
                    yield replace(successor, target=f"{path.removesuffix(item)}{new}")
                elif not new:
                    yield successor

    def _items_beside(self, path: str) -> frozenset[str]:
        """The items of today where an item of a property or an argument was."""
        argument = argument_of(path)
        symbol = self._reader.symbol(plain_path(path) if argument else split_path(path)[0])
        if symbol is None:
            return frozenset()
        owners = (p for p in symbol.parameters if p.name == argument) if argument else (symbol,)
        return frozenset(i.identifier for owner in owners for i in owner.enum_items)

    def of_member(self, owner: str, name: str) -> RemovedSymbol | None:
        """A removed member of a class, of its bases, of what they were called before, or of a module.

        What a base itself had, or will have, comes before what the former name of a class had.
        """
        lineage = [entry.path for entry in self._reader.lineage(owner)] or [owner]
        own = [(ancestor, ancestor) for ancestor in lineage]
        others = [
            (ancestor, holder)
            for ancestor in lineage
            for holder in (_INSTANCES.get(ancestor), *self._former_names.get(ancestor, ()))
        ]
        for ancestor, holder in (*own, *others):
            if holder and (removed := self.of_path(f"{holder}.{name}")):
                return removed if holder == ancestor else _nearest_to(ancestor, removed)
        return None

    def of_part(self, path: str, part: str) -> RemovedSymbol | None:
        """A removed parameter ``(x)`` or enum item ``:X`` of a symbol that this version has, or had by another name."""
        owner, _, name = path.rpartition(".")
        holders = (owner, *self._former_names.get(owner, ()))
        return next(filter(None, (self.of_path(f"{holder}.{name}{part}") for holder in holders)), None)

    def below(self, owner: str, name: str, variable: str = "") -> RemovedSymbol | None:
        """A removed member of a class below ``owner``: ``Material.alpha`` for an ID.

        Of several classes the one that ``variable`` may hold; that which counts most, if they all lost it alike. Where
        each has it later, and another class has it until then, nothing tells which is meant.
        """
        found = {path: removed for path in self.paths_below(owner, name) if (removed := self.of_path(path))}
        present = {
            path: removed for path, removed in found.items() if self._reader.entry(path.rpartition(".")[0])
        }
        found = present or found  # of the class before what it was called before
        alike = len({(removed.gone, *_new_names(removed)) for removed in found.values()}) == 1
        until = {cls for one in found.values() if not one.gone for cls in _owners_of_targets(one)}
        if len(found) > 1 and (owner == ID or not alike or len(until) > 1):
            usual = [f"{cls}.{name}" for cls in usual_classes(variable)]
            return next((found[path] for path in usual if path in found), None)
        return found.get(self._likeliest(found, variable))

    def _likeliest(self, paths: Iterable[str], variable: str) -> str:
        """Of members of several classes that of the one which a variable is named after, or which counts most, as what
        took its place does; empty for none.
        """
        now = {path: (*self._classes_now(path.rpartition(".")[0]),) for path in paths}
        weights = self._reader.usage.weights({cls for classes in now.values() for cls in classes})
        said = set(words(variable))

        def likely(path: str) -> tuple[int, float]:
            is_named = len(said.intersection(words(path.rpartition(".")[0])))
            return is_named, max((weights.get(cls, 0.0) for cls in now[path]), default=0.0)

        return max(now, key=likely, default="")

    def paths_below(self, owner: str, name: str) -> list[str]:
        """Paths of the removed members called ``name`` of a class and of those below it."""
        return [
            path
            for path in self.paths_named(name)
            if self._was_below(path.removesuffix(f".{name}"), owner, by_name="_" in name)
        ]

    def _was_below(self, cls: str, owner: str, *, by_name: bool) -> bool:
        """Whether a class, or what took its place, is below ``owner``; of other removed classes the name tells it, if
        it may (``by_name``).
        """
        if any(self._reader.descends(now, owner) for now in self._classes_now(cls)):
            return True
        named = cls.endswith(owner.removeprefix(TYPES)) and not self._reader.entry(cls)
        return by_name and named and bool(self._reader.subclasses(owner))

    def paths_named(self, name: str) -> list[str]:
        """Paths of the removed members that are called exactly ``name``; none for a name that too many have."""
        paths = [path for path in self._reader.history.removed_named(name) if path.endswith(f".{name}")]
        return paths if len(paths) <= _MOST_OWNERS else []

    def of_socket(self, owner: str, name: str, variable: str) -> RemovedSymbol | None:
        """A removed socket, ``inputs["Subsurface"]``, of a node below ``owner``; the variable may tell which."""
        nodes = usual_classes(variable)
        below = [
            path
            for path in self._reader.history.removed_by_key(key(name))
            if path.endswith(name) and self._reader.descends(socket_node(path), owner)
        ]
        below.sort(key=lambda path: (socket_node(path) not in nodes, path))
        return next(filter(None, map(self.of_path, below)), None)

    def of_sockets(self, side: str, name: str) -> list[str]:
        """Paths of the removed sockets of a name on a side of nodes; none where one is still taken under that name."""
        end = f'.{side}["{name}"]'
        paths = [path for path in self._reader.history.removed_by_key(key(end)) if path.endswith(end)]
        return [] if any(map(self._reader.history.still_works, paths)) else paths

    def spelled(self, text: str) -> Iterator[RemovedSymbol]:
        """Removed symbols in any usual spelling; bare enum items only as code writes them."""
        items = [f":{text}"] if text.isupper() and "_" in text else []
        named = [
            path for item in items for path in self._reader.history.removed_named(text) if path.endswith(item)
        ]
        known = [path for path in named if self._reader.history.successors(path)]
        for path in (*self._reader.history.removed_by_key(key(text)), *known[:1]):
            if not self._is_meant(text, path):
                continue
            if removed := self.of_path(path):
                yield removed

    def _is_meant(self, text: str, path: str) -> bool:
        """Whether a text is a removed symbol's name, rather than other names, or words of prose, with these letters."""
        if "." in text:
            return f".{path}".endswith(f".{text}")  # ``lamp.type`` is a variable's, ``Lamp.type`` the class's
        if ":" in path:
            return text.isupper() and not self._reader.names.enum_owners(key(text))
        return (
            path == text or " " in text or "_" in text or (text[:1].isupper() and path.endswith(f".{text}"))
        )

    def _classes_now(self, cls: str) -> Iterable[str]:
        """A class, or what took the place of a removed one."""
        return (cls,) if self._reader.entry(cls) else self._class_successors.get(cls, ())

    @cached_property
    def _class_successors(self) -> dict[str, list[str]]:
        """Removed class → the classes that took its place."""
        found: dict[str, list[str]] = {}
        for path, target in self._reader.history.successors_of_classes():
            found.setdefault(path, []).append(target)
        return found

    @cached_property
    def _former_names(self) -> dict[str, list[str]]:
        """Class → what it was called before: Light → Lamp."""
        found: dict[str, list[str]] = {}
        for path, targets in self._class_successors.items():
            for target in targets:
                found.setdefault(target, []).append(path)
        return found
