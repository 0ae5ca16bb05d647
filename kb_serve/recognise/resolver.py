"""Resolves expressions through RNA's types: which symbol each step of a chain is."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import lru_cache
from itertools import islice
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.api_names import (
    COLLECTION,
    GROUPS,
    NODE,
    OBJECT,
    OPERATOR_METHODS,
    OPERATORS,
    SIDES,
    STRUCT,
    TYPES,
)
from kb_build.symbols.paths import is_socket, last_name
from kb_build.symbols.python_values import METHODS, python_class
from kb_serve.recognise.chains.chain_starts import ChainStarts
from kb_serve.recognise.chains.chain_values import ChainValue, ChainValues
from kb_serve.recognise.chains.chains import ChainStep
from kb_serve.recognise.chains.operator_classes import known_operator_of_class
from kb_serve.recognise.chains.owners import Owners
from kb_serve.recognise.chains.refusals import is_listed, refuses, refuses_call
from kb_serve.recognise.chains.subscripts import PROPERTIES_OF_OPERATORS, CustomProperties
from kb_serve.recognise.chains.variables import usual_classes
from kb_serve.recognise.elsewhere.holders import by_what_holds_it
from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain

_OBJECT_DATA = f"{TYPES}Object.data"
# Pointer to an object → the class of that object's data.
_DATA_OF = {f"{TYPES}Scene.camera": f"{TYPES}Camera"}
# What every class and instance tells of itself, and what that is.
_RNA, _STRUCT_OF_ALL = ("bl_rna", "rna_type"), f"{TYPES}Struct"
_MATRIX, _ROW = "mathutils.Matrix", "mathutils.Vector"
_LINKS = "links"  # of a socket, which lead elsewhere
_ROWS = {f"{_MATRIX}.col", f"{_MATRIX}.row"}
_GROUP = f"{TYPES}PropertyGroup"
_ELEMENT, _LAYERS = "bmesh.types.BM", "bmesh.types.BMLayerAccess"
_NUMBERED = re.compile(r"\.\d{3}$")
_QUOTED = re.compile(r"""(["'])([\w.]+)\1""")
_GET, _KEY = ChainStep("attr", "get"), re.compile(r"""\s*(["'])([^"']+)\1\s*""")
_ELEMENT_SUFFIXES = ("modifier", "constraint", "node", "settings")
_TOLD = 0.2  # fit of the likeliest class of a variable whose name tells nothing
_NAMED = 0.5  # … of a class that a variable's name tells
_MOST_TRIED = 12  # readings of which it is asked whether they take a value
_MAX_BRANCHES = 60


@value_class
class ResolvedChain:
    """A chain as far as it could be resolved.

    ``symbols`` are the ids of the resolved steps, in order; ``missing`` is the first name that the class ``owner``
    does not have (empty if the whole chain resolved); ``fit`` tells how well a variable's name suits the class
    that was assumed for it, 0 to 1; ``keyed`` is the class whose custom property the chain reaches,
    ``cls`` the class of what a complete one gives, where that is known, and ``alike`` are the members of the last
    step's name that other cases of its class have, those that count most first. ``owners`` are all classes without the
    missing name, where a step led to several. ``method`` is the method of Python's own with which the chain goes on
    from its last symbol.
    """

    symbols: tuple[str, ...]
    missing: str = ""
    owner: str = ""
    fit: float = 1.0
    steps_left: int = 0
    keyed: str = ""
    cls: str = ""
    alike: tuple[str, ...] = ()
    owners: tuple[str, ...] = ()
    method: str = ""

    @property
    def complete(self) -> bool:
        """Whether every step was resolved."""
        return bool(self.symbols) and not self.missing


def _with_keys(steps: tuple[ChainStep, ...]) -> tuple[ChainStep, ...]:
    """The same steps, in which an element that is got by its name is one by its key: ``nodes.get("Mix").inputs``."""
    if _GET not in steps:
        return steps
    found: list[ChainStep] = []
    for place, step in enumerate(steps):
        key_of = _KEY.fullmatch(step.text) if step.kind == "call" and place + 1 < len(steps) else None
        if key_of and found and found[-1] == _GET:
            found[-1] = ChainStep("key", key_of[2])
        else:
            found.append(step)
    return tuple(found)


class Resolver:
    """Resolves chains against one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._owners = Owners(reader)
        self._values = ChainValues(reader)
        self._starts = ChainStarts(reader, self._values, self._owners)
        self._custom = CustomProperties(reader)
        self._named = lru_cache(maxsize=64)(self._named_classes)

    def resolve(self, chain: Chain) -> list[ResolvedChain]:
        """Every reading of a chain, best first: most steps resolved, then the likelier class for a variable."""
        data = self._data_of(chain.variable)
        readings = [
            replace(self._follow(value, chain.steps[used:], data), fit=fit)
            for value, used, fit in self._starts.of(chain)
        ]
        unique: dict[tuple[tuple[str, ...], str], ResolvedChain] = {}
        for resolved in self._ranked(readings):
            unique.setdefault((resolved.symbols[-1:], resolved.missing), resolved)
        return self._taking(chain, self._writable(chain, list(unique.values())))

    def _data_of(self, variable: str) -> str:
        """The class of the data of an object that is called like its data, ``cam``; empty for any other."""
        classes = usual_classes(variable)
        data = [cls for cls in classes if self._reader.is_object_data(cls)] if OBJECT in classes else []
        return data[0] if len(data) == 1 else ""

    def _taking(self, chain: Chain, readings: list[ResolvedChain]) -> list[ResolvedChain]:
        """The readings of an unknown variable without those that refuse what the chain is set to or called with, if
        others take it.
        """
        is_set = chain.assigned and (chain.literal or chain.values)
        if not is_set and not chain.call:
            return readings
        guessed = [reading for reading in readings if reading.complete and reading.fit < _NAMED][:_MOST_TRIED]
        symbols = [(reading, self._reader.symbol(reading.symbols[-1])) for reading in guessed]
        refusing = [
            reading
            for reading, symbol in symbols
            if symbol and (refuses(symbol, chain) or refuses_call(symbol, chain))
        ]
        if len(refusing) == len(guessed):
            return readings
        return [reading for reading in readings if reading not in refusing]

    def _writable(self, chain: Chain, readings: list[ResolvedChain]) -> list[ResolvedChain]:
        """The readings without those that cannot be assigned, where a chain is assigned and others can: but not without
        those of the class that its variable is always of.
        """
        if not chain.assigned or len(readings) < 2:
            return readings

        def owner_of_locked(reading: ResolvedChain) -> str:
            entry = self._reader.entry(reading.symbols[-1])
            return entry.owner if entry and entry.is_read_only else ""

        whole = [reading for reading in readings if reading.complete and reading.fit >= _TOLD]
        locked = [reading for reading in whole if owner_of_locked(reading)]
        # Where one that can be assigned lists the very value, that is meant all the same.
        free = (reading.symbols[-1] for reading in whole if reading not in locked)
        if not any(is_listed(chain, path, self._reader) for path in free):
            usual = usual_classes(chain.root)
            locked = [reading for reading in locked if usual != [owner_of_locked(reading)]]
        if not locked or len(locked) == len(whole):
            return readings
        return [reading for reading in readings if reading not in locked]

    def onward(self, path: str, steps: tuple[ChainStep, ...]) -> ResolvedChain:
        """Follows steps from a symbol, as if an expression had led there."""
        entry = self._reader.entry(path)
        return self._follow(self._values.of(entry), steps) if entry else ResolvedChain(())

    @staticmethod
    def _ranked(readings: Iterable[ResolvedChain]) -> list[ResolvedChain]:
        return sorted(readings, key=lambda reading: (reading.steps_left, -reading.fit, -len(reading.symbols)))

    def _follow(self, value: ChainValue, steps: tuple[ChainStep, ...], data: str = "") -> ResolvedChain:
        """Resolves step after step; a base class is tried as each of its descendants. ``data`` is the class of an
        object's data, if that is known.
        """
        symbols = [value.symbol]
        values = [value]
        alike: tuple[str, ...] = ()
        steps = _with_keys(steps)
        for number, step in enumerate(steps):
            branches = (after for before in values for after in self._step(before, step))
            following = list(islice(branches, _MAX_BRANCHES))
            if not following:
                missing, owner = self._unresolved(values[0], step)
                owners = tuple(dict.fromkeys(self._unresolved(before, step)[1] for before in values))
                left = len(steps) - number
                return ResolvedChain(tuple(symbols), missing, owner, steps_left=left, owners=owners)
            if data and following[0].symbol == _OBJECT_DATA:
                following, data = [replace(following[0], cls=data)], ""
            data = _DATA_OF.get(following[0].symbol, data)
            first = following[0].symbol
            alike = tuple(dict.fromkeys(after.symbol for after in following if after.symbol != first))
            values = following
            if step.kind == "attr" or values[0].symbol != symbols[-1]:
                symbols.append(values[0].symbol)
        first = values[0]
        return ResolvedChain(
            tuple(symbols), keyed=first.keyed, cls=first.cls, alike=alike, method=first.method
        )

    @staticmethod
    def _unresolved(value: ChainValue, step: ChainStep) -> tuple[str, str]:
        """(name, owner) of an unresolved step; a socket is missing on its node, not on its collection."""
        if step.kind == "key" and value.many:
            return f'{value.symbol.rpartition(".")[2]}["{step.text}"]', value.origin or value.cls
        if step.kind == "key":
            return f'["{step.text}"]', value.cls or value.symbol
        if value.many and step.kind == "attr":
            return step.text, value.container or value.symbol
        return step.text, value.cls or value.symbol

    def _step(self, value: ChainValue, step: ChainStep) -> Iterator[ChainValue]:
        if value.method and not value.many:  # of what it gives nothing is known
            yield value
        elif step.kind == "attr":
            yield from self._attribute(value, step.text)
        elif step.kind == "call":
            yield self._call(value, step.text)
        elif value.many and step.kind == "index" and ":" in step.text:  # a part of it
            yield value
        elif value.many:
            yield from self._item(value, step)
        elif step.kind == "index":
            yield from self._in_layers(value.cls)
            is_matrix = value.cls == _MATRIX or value.symbol in _ROWS
            yield replace(value, cls=_ROW if is_matrix else "")  # an element of a vector
        elif not value.cls:
            yield value
        else:
            for cls in self._custom.taken_by(value.cls):
                yield ChainValue(value.symbol if cls == value.cls else cls, keyed=cls)

    def _attribute(self, value: ChainValue, name: str) -> Iterator[ChainValue]:
        if value.many:
            if not value.container and hasattr(list, name):
                yield replace(value, method=name)
            elif entry := self._of_collection(value, name):
                yield self._values.of(entry, value.cls)
            return
        if name in _RNA and value.cls.startswith(TYPES):
            yield ChainValue(_STRUCT_OF_ALL, _STRUCT_OF_ALL)
            return
        if name in OPERATOR_METHODS and value.symbol.startswith(OPERATORS):
            yield value
            return
        if value.cls.startswith(OPERATORS) and self._has_parameter(value.cls, name):
            yield ChainValue(value.cls, known_operator_of_class(name, self._reader))
            return
        own = (
            self._reader.member_of(value.cls, name)
            if value.cls
            else self._reader.member((value.symbol,), name)
        )
        if own:
            after = self._values.of(own, value.cls)
            is_of_socket = is_socket(value.symbol) and not after.many and name != _LINKS
            yield replace(after, symbol=value.symbol if is_of_socket else own.path, origin=value.cls)
            return
        if not value.cls and name in METHODS and self._has_method(value.symbol, name):
            yield replace(value, method=name)
            return
        for entry in self._below(value, name):
            yield self._values.of(entry, entry.owner)
        if value.cls == PROPERTIES_OF_OPERATORS:  # of an operator that the base does not have
            yield ChainValue(value.symbol)

    def _below(self, value: ChainValue, name: str) -> Sequence[SymbolEntry]:
        """The members of that name which classes below a value's have, likeliest first. That one kind has a function
        by which things are mostly added or removed elsewhere says nothing of the others.
        """
        if not value.cls.startswith(TYPES):
            return []
        below = [
            entry
            for entry in self._reader.names.by_name(name)
            if entry.kind != "socket" and self._reader.descends(entry.owner, value.cls)
        ]
        if below and by_what_holds_it(value.cls, name, self._reader):
            return []
        if value.symbol == _OBJECT_DATA:
            below = [entry for entry in below if self._reader.is_object_data(entry.owner)] or below
        return self._owners.heaviest(below)

    def _has_parameter(self, path: str, name: str) -> bool:
        symbol = self._reader.symbol(path)
        return symbol is not None and any(parameter.name == name for parameter in symbol.parameters)

    def _of_collection(self, value: ChainValue, name: str) -> SymbolEntry | None:
        """A member of a collection: of its own class, of all collections, or of those of property groups."""
        own = self._reader.member_of(value.container, name)
        if own and (own.owner != STRUCT or own.kind == "property"):  # it has none of a structure's functions
            return own
        of_groups = self._reader.member_of(GROUPS, name) if self._reader.descends(value.cls, _GROUP) else None
        return self._reader.member_of(COLLECTION, name) or of_groups

    def _has_method(self, path: str, name: str) -> bool:
        """Whether what a property or constant holds is one of Python's own values, with a method of that name."""
        symbol = self._reader.symbol(path)
        return symbol is not None and hasattr(python_class(symbol), name)

    def _item(self, value: ChainValue, step: ChainStep) -> Iterator[ChainValue]:
        """An element of a collection; the key may tell its class or socket."""
        declared, _, side = value.symbol.rpartition(".")
        owner = value.origin or declared
        if step.kind == "key" and side in SIDES:
            yield from self._socket(owner, side, step.text)
            return
        is_numbered = step.kind == "index" and side in SIDES
        if is_numbered and (socket := self._socket_at(owner, f"{side}[{step.text}]")):
            yield self._values.of(socket)
            return
        named = self._named(value.cls, step.text) if step.kind == "key" else ()
        for path in self._in_tree(named, owner):
            yield ChainValue(path, path)
        if not named:
            yield ChainValue(value.symbol, value.cls)

    def _in_layers(self, cls: str) -> Iterator[ChainValue]:
        """What an element of a bmesh has in its layers, which it is indexed by: ``loop[uv_layer]`` is a BMLoopUV."""
        if not cls.startswith(_ELEMENT):
            return
        for layers in self._reader.members(f"{_LAYERS}{cls.removeprefix(_ELEMENT)}").values():
            for held in self._values.classes_in(layers.type.partition("[")[2], layers.path):
                yield ChainValue(held, held)

    def _in_tree(self, nodes: Sequence[str], tree: str) -> Sequence[str]:
        """Of nodes with one name, those that the tree can hold; all if that does not tell them apart."""
        if len(nodes) < 2:
            return nodes
        name = tree.removeprefix(TYPES)
        trees = {
            path: node.trees for path in nodes if (node := self._reader.symbol(path)) and name in node.trees
        }
        return sorted(trees, key=lambda path: len(trees[path])) or nodes

    def _named_classes(self, cls: str, text: str) -> tuple[str, ...]:
        """Descendants of ``cls`` (or itself) whose elements are called ``text`` by default: by the name that they are
        made with, then by a label or class name; of each the shortest first.
        """
        name = _NUMBERED.sub("", text)
        labelled = (
            path
            for suffix in ("", *_ELEMENT_SUFFIXES)
            for _, path in self._reader.names.by_key(key(name) + suffix)
        )
        found: dict[str, None] = {}
        for paths in (self._reader.makers.made_as(name), labelled):
            named = {path for path in paths if path.startswith(TYPES) and self._reader.descends(path, cls)}
            found |= dict.fromkeys(sorted(named, key=lambda path: (len(path), path)))
        return tuple(found)

    def _socket(self, owner: str, side: str, name: str) -> Iterator[ChainValue]:
        """The sockets of that name: of the node's own class, or of every node where only ``Node`` is known."""
        named = self._on_side(self._reader.names.by_name(name), owner, side)
        found = named or self._on_side(self._with_key(side, name), owner, side)
        yield from map(self._values.of, self._owners.likeliest_sockets(found))
        if not found and self._may_have_any_socket(owner, side):
            yield ChainValue(f"{NODE}.{side}", f"{TYPES}NodeSocket")

    def _on_side(self, entries: Iterable[SymbolEntry], owner: str, side: str) -> list[SymbolEntry]:
        """Of symbols, the sockets on a side of a class of nodes, or of one derived from it."""
        return [
            entry
            for entry in entries
            if entry.kind == "socket" and entry.path.startswith(f"{entry.owner}.{side}[")
            if self._reader.descends(entry.owner, owner)
        ]

    def _with_key(self, side: str, name: str) -> Iterator[SymbolEntry]:
        """The sockets that another text in brackets gives than their name: their identifier, or what they are called in
        some modes. Not what was their name in older versions, of which more is told.
        """
        for _, path in self._reader.names.by_key(key(f"{side}{name}")):
            symbol, entry = self._reader.symbol(path), self._reader.entry(path)
            is_former = entry and self._reader.history.removed(f'{entry.owner}.{side}["{name}"]')
            if symbol and entry and name in symbol.socket_keys and not is_former:
                yield entry

    def _socket_at(self, node: str, subscript: str) -> SymbolEntry | None:
        """The socket of a class of nodes that a subscript with its number gives, ``inputs[0]``."""
        side, _, number = subscript.rstrip("]").partition("[")
        entries = [entry for name, entry in self._reader.members(node).items() if name.startswith(f"{side}[")]
        if not number.isdecimal():
            return None
        # Mostly in the order of their numbers.
        entries = entries[int(number) :] + entries[: int(number)]
        symbols = ((entry, self._reader.symbol(entry.path)) for entry in entries)
        return next((entry for entry, symbol in symbols if symbol and subscript in symbol.subscripts), None)

    def _may_have_any_socket(self, owner: str, side: str) -> bool:
        """Whether a class of nodes has sockets that its group or its items name."""
        return "node_tree" in self._reader.members(owner) or self._reader.takes_more_sockets(owner, side)

    def _call(self, value: ChainValue, arguments: str) -> ChainValue:
        """What a call returns; a function that returns a base class of its owner returns the owner's class, and one
        that makes several classes that which its arguments say.
        """
        entry = self._reader.entry(value.symbol)
        if entry is None or entry.kind != "function":
            return value
        returned = self._values.returned(value.symbol)
        for _, choice in _QUOTED.findall(arguments):
            # A former name makes what has the name of today.
            today = last_name(self._reader.history.still_works(f"{TYPES}{choice}")) or choice
            if made := self._reader.makers.class_made(value.symbol, returned, today):
                return ChainValue(value.symbol, made)
        if returned == PROPERTIES_OF_OPERATORS and (operator := self._operator_in(arguments)):
            return ChainValue(value.symbol, operator)
        if value.container and returned and self._reader.descends(value.container, returned):
            returned = value.container
        return ChainValue(value.symbol, returned)

    def _operator_in(self, arguments: str) -> str:
        """The path of the operator that is called by its name in a text: ``layout.operator("mesh.delete")``."""
        paths = (f"bpy.ops.{name}" for _, name in _QUOTED.findall(arguments) if "." in name)
        return next((path for path in paths if self._reader.entry(path)), "")
