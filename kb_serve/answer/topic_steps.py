"""How a topic's work is done, in order: the calls that make its things, where these go, what is set, what runs it.

Computed from the schema and weights: a class that has a creation call is made; what points to it is where it goes; its
own settings and those it points to are set; the operators of the topic that neither make nor remove anything run it.
"""

from __future__ import annotations

from collections import defaultdict
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_serve.answer.budget import AnswerBlock
from kb_serve.reader import STRUCT, TYPES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_serve.answer.topic_overview import TopicNames
    from kb_serve.reader import BaseReader, SymbolEntry

_MAKERS = 3
_CHOICES = 14  # types that one maker is shown with
_SETTINGS = 7
_HOLDERS = 3  # pointers of a thing whose settings are shown
_RUNS = 4
_MAKES = ("add", "new", "create", "insert")
_REMOVES = (
    "remove",
    "delete",
    "free",
    "clear",
    "preset",
    "copy",
    "paste",
    "select",
    "move",
    "reset",
    "toggle",
)
_CACHE = "PointCache"


class Steps:
    """The steps of one topic."""

    def __init__(self, reader: BaseReader, names: TopicNames) -> None:
        self._reader = reader
        self._names = names
        self._shown: set[str] = set()

    def blocks(self) -> Iterator[AnswerBlock]:
        """One block, a numbered list; none where nothing is made, set or run."""
        steps = [*self._make(), *self._use(), *self._run()]
        if steps:
            lines = (f"{number}. {step}" for number, step in enumerate(steps, 1))
            yield AnswerBlock("**How it is done**\n" + "\n".join(lines), "how it is done")

    # What is made

    def _make(self) -> Iterator[str]:
        creations = self._reader.creations(list(self._names.classes))
        groups: dict[str, list[str]] = defaultdict(list)
        for path in self._names.classes:
            if path in creations:
                groups[creations[path][1]].append(path)
        for maker, paths in islice(groups.items(), _MAKERS):
            call, _, choice = creations[paths[0]]
            others = [path for path in paths[1:] if creations[path][2]]
            if len(others) >= _SETTINGS and maker.endswith("Nodes.new"):
                yield from self._tree(paths[0])
            text = f"`{call}`" + self._known(paths[0])
            if choice and others:
                named = ", ".join(f"`{creations[path][2]}`" for path in others[:_CHOICES])
                more = f", … {len(others) - _CHOICES} more" if len(others) > _CHOICES else ""
                text += f"; types by weight: {named}{more}"
            yield text
            yield from self._goes(paths[0])
            if len(others) < _SETTINGS or self._names.names(paths[0]):
                yield from self._set(paths[0])

    def _known(self, path: str) -> str:
        self._shown.add(path)
        return f" → `{path.removeprefix(TYPES)}`"

    def _tree(self, node: str) -> Iterator[str]:
        """The tree that takes a node, and how nodes are joined."""
        symbol = self._reader.symbol(node)
        trees = [f"{TYPES}{tree}" for tree in (symbol.trees if symbol else ())]
        for tree, (call, _, _) in self._reader.creations(trees[:1]).items():
            yield f"`tree = {call}`" + self._known(tree)
            yield from self._goes(tree)
        for call, _, _ in self._reader.creations([f"{TYPES}NodeLink"]).values():
            yield f"join nodes: `{call}`"

    # Where it goes

    def _goes(self, path: str) -> Iterator[str]:
        if self._is_object_data(path):
            calls = self._reader.creations([f"{TYPES}Object"])
            made = next((call for call, _, _ in calls.values()), "")
            yield f"`obj = {made}`, `bpy.context.collection.objects.link(obj)`"
        places = [*self._reader.pointing_at(path.removeprefix(TYPES))]
        places += [place for place in self._named_pointers() if place.target == "Object"]
        if places := self._heaviest(place for place in places if _is_set(place))[:2]:
            yield "it goes to " + ", ".join(f"`{self._expression(place)}`" for place in places)

    def _is_object_data(self, path: str) -> bool:
        return any(entry.path in self._object_data for entry in self._reader.lineage(path))

    @cached_property
    def _object_data(self) -> set[str]:
        """The classes that an object can be of, by the names of its types."""
        types = self._reader.symbol(f"{TYPES}Object.type")
        names = {key(item.identifier) for item in types.enum_items} if types else set[str]()
        names |= {key(item.name) for item in types.enum_items} if types else set[str]()
        return {path for path, name in self._reader.data_classes() if key(name) in names}

    def _named_pointers(self) -> list[SymbolEntry]:
        """Properties called as the topic is: ``Scene.camera``."""
        entries = [entry for name in self._stems() for entry in self._reader.by_name(name)]
        return [entry for entry in entries if entry.kind == "property" and entry.type == "pointer"]

    def _stems(self) -> set[str]:
        """The topic's keys, in the singular too."""
        return {name for each in self._names.keys for name in (each, each.removesuffix("s")) if len(name) > 3}

    # What is set

    def _set(self, path: str) -> Iterator[str]:
        if own := self._settings(path):
            yield f"set {own}"
        yield from self._held_settings(path, "")

    def _held_settings(self, path: str, above: str) -> Iterator[str]:
        """The settings that a thing points to, where they belong to the topic or are its cache."""
        pointers = [
            entry
            for entry in self._reader.members(path).values()
            if entry.type == "pointer" and self._belongs(f"{TYPES}{entry.target}")
        ]
        for entry in pointers[:_HOLDERS]:
            target = f"{TYPES}{entry.target}"
            self._shown.add(target)
            if settings := self._settings(target):
                yield f"set on `{above}.{entry.name}` (`{entry.target}`): {settings}"
            yield from self._held_settings(target, f"{above}.{entry.name}")

    def _belongs(self, path: str) -> bool:
        return path not in self._shown and (path in self._names.classes or path == f"{TYPES}{_CACHE}")

    def _settings(self, path: str) -> str:
        entries = [
            entry
            for entry in self._reader.members(path).values()
            if entry.kind == "property" and entry.type not in {"pointer", "collection"} and _is_set(entry)
        ]
        return ", ".join(entry.line.partition(" — ")[0] for entry in self._heaviest(entries)[:_SETTINGS])

    def _use(self) -> Iterator[str]:
        """Settings that are there without being made, and functions called as the topic is."""
        functions = [path for name in self._stems() for path in self._reader.functions_named(name)]
        entries = self._heaviest(entry for path in functions if (entry := self._reader.entry(path)))
        weights = self._reader.weights([entry.path for entry in entries])
        for entry in entries[:2]:
            if weights.get(entry.path, 0) >= 1:
                owner = "obj" if entry.owner == STRUCT else entry.owner.removeprefix(TYPES)
                yield f"`{owner}.{entry.line.partition(' — ')[0].strip('`')}`"
        there = [path for path in self._names.classes if path not in self._shown and self._names.names(path)]
        creations = self._reader.creations(there)
        for path in [path for path in there if path not in creations][:2]:
            symbol, settings = self._reader.symbol(path), self._settings(path)
            if symbol is not None and symbol.reached and settings:
                self._shown.add(path)
                yield f"set on `{symbol.reached}` (`{symbol.name}`): {settings}"

    # What runs it

    def _run(self) -> Iterator[str]:
        operators = [path for path in self._names.operators if not _has(path, (*_MAKES, *_REMOVES))][:_RUNS]
        if f"{TYPES}{_CACHE}" in self._shown:
            operators = [*self._bakes(), *operators]
        for path in operators[:_RUNS]:
            entry = self._reader.entry(path)
            if entry is not None:
                yield f"`{path}()` — {entry.line.partition(' — ')[2]}"

    def _bakes(self) -> Iterator[str]:
        """The heaviest operator of the page that explains the cache."""
        for target in self._reader.links_from(f"{TYPES}{_CACHE}", "manual"):
            paths = self._reader.symbols_of_page(target.partition("#")[0])
            entries = (self._reader.entry(path) for path in paths if not _has(path, (*_MAKES, *_REMOVES)))
            operators = [entry for entry in entries if entry and entry.kind == "operator"]
            yield from (entry.path for entry in self._heaviest(operators)[:1])

    # Order

    def _heaviest(self, entries: Iterable[SymbolEntry]) -> list[SymbolEntry]:
        """Entries by weight; those of equal weight keep their order."""
        found = list(entries)
        weights = self._reader.weights([entry.path for entry in found])
        return sorted(found, key=lambda entry: -weights.get(entry.path, 0.0))

    def _expression(self, entry: SymbolEntry) -> str:
        owner = self._reader.symbol(entry.owner)
        return f"{owner.reached if owner and owner.reached else entry.owner.removeprefix(TYPES)}.{entry.name}"


def _is_set(entry: SymbolEntry) -> bool:
    return "read-only" not in entry.line.partition(" — ")[0]


def _has(path: str, verbs: Sequence[str]) -> bool:
    return not set(path.rpartition(".")[2].split("_")).isdisjoint(verbs)
