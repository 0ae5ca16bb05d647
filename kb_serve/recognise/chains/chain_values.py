"""What the steps of an expression stand for: instances of classes, collections, modules, functions."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import BLEND_DATA, COLLECTION, CONTEXT, TYPES
from kb_build.symbols.math_classes import math_class
from kb_build.symbols.python_values import is_new_list
from kb_serve.recognise.chains.untyped_properties import SEQUENCES, VALUES
from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_ARRAY = f"{TYPES}bpy_prop_array"
_INSTANCES = {"bpy.context": CONTEXT, "bpy.data": BLEND_DATA}
_SEQUENCE = re.compile(r"(?:list|set|tuple)\[(?:bpy\.types\.)?([A-Z]\w*)(?:, \.\.\.)?\]")
_VALUELESS = frozenset({"bundle", "closure", "custom", "geometry", "matrix", "shader"})  # types of sockets
_CLASS_NAME = re.compile(r"\b(?:\w+\.)*[A-Z]\w+")


@value_class
class ChainValue:
    """What a chain stands for up to a step: an instance of ``cls``, a collection of it, a module or a function.

    ``origin`` is the class that the last attribute was read from, which may inherit it; ``keyed`` the class whose
    custom property this is; ``method`` is that of Python's own which was read of the symbol's value.
    """

    symbol: str
    cls: str = ""
    many: bool = False
    container: str = ""
    origin: str = ""
    keyed: str = ""
    method: str = ""


class ChainValues:
    """Tells, by one base, what its symbols stand for."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._returned = lru_cache(maxsize=500)(self._returned_class)

    def of(self, entry: SymbolEntry, came_from: str = "") -> ChainValue:  # noqa: PLR0911 - one return a kind
        """What a step to ``entry`` leads to."""
        if entry.path in _INSTANCES:
            return ChainValue(entry.path, _INSTANCES[entry.path])
        if entry.kind in {"module", "class"}:
            return ChainValue(entry.path, entry.path)
        if entry.kind == "socket":
            return ChainValue(entry.path, self._socket_class(entry))
        if (sequence := _of_python(entry)) or entry.path in VALUES:
            cls = TYPES + sequence[1] if sequence else VALUES[entry.path]
            return ChainValue(entry.path, cls, many=bool(sequence))
        if is_new_list(entry.kind, entry.type):
            return ChainValue(entry.path, TYPES + entry.target, many=True)
        if entry.type == "collection":
            container = TYPES + entry.collection if entry.collection else COLLECTION
            return ChainValue(entry.path, TYPES + entry.target, many=True, container=container)
        if entry.target and entry.kind != "operator":
            return ChainValue(entry.path, TYPES + entry.target)
        if entry.kind == "function":
            return ChainValue(entry.path, container=came_from)
        if classes := self.classes_in(entry.type, entry.path, whole=True):
            return self._sequence(entry.path, classes)
        return ChainValue(entry.path, self._value_class(entry))

    def _socket_class(self, entry: SymbolEntry) -> str:
        """A socket's own class: the target in its record may be the data-block that it takes. Of what a setting of the
        node decides, that of all sockets, where the usual one has no value.
        """
        symbol = self._reader.symbol(entry.path) if entry.type in _VALUELESS else None
        if symbol and symbol.type_settings:
            return f"{TYPES}NodeSocket"
        own = f"{TYPES}NodeSocket{entry.type.title()}"
        return (
            own
            if not entry.target.startswith("NodeSocket") and self._reader.entry(own)
            else TYPES + entry.target
        )

    def _value_class(self, entry: SymbolEntry) -> str:
        """The class of a plain property's value: mathutils for coordinates and colours."""
        symbol = self._reader.symbol(entry.path)
        if symbol is None or not symbol.array:
            return ""
        return math_class(symbol) or _ARRAY

    def _sequence(self, symbol: str, classes: list[str]) -> ChainValue:
        """An instance of the first class; of a sequence, the elements are of the class that it names or creates."""
        first, *others = classes
        if first.endswith(("Seq", "Slice")):
            makes = self._reader.member_of(first, "new")
            element = others[0] if others else self.returned(makes.path) if makes else ""
            return ChainValue(symbol, element, many=True, container=first)
        if self._reader.member((first,), "keys") and (found := self._reader.member((first,), "get")):
            # Like a dictionary: what it has is found by a key.
            return ChainValue(symbol, self.returned(found.path), many=True, container=first)
        return ChainValue(symbol, first)

    def classes_in(self, text: str, path: str, *, whole: bool = False) -> list[str]:
        """The classes in the text of a type, ``BMElemSeq[BMEdge]``; each the nearest to ``path`` of that name.

        With ``whole`` the type must be a class itself, not Python's list or tuple of one.
        """
        paths: list[str] = []
        if whole and not _CLASS_NAME.match(text):
            return paths
        for name in _CLASS_NAME.findall(text):
            scopes = [path[:at] for at in range(len(path), 0, -1) if path[at : at + 1] == "."]
            last = name.rpartition(".")[2]
            candidates = (name, *(f"{scope}.{last}" for scope in scopes), TYPES + last)
            classes = (
                entry
                for candidate in candidates
                if (entry := self._reader.entry(candidate)) and entry.kind == "class"
            )
            if first := next(classes, None):
                paths.append(first.path)
        return paths

    def returned(self, path: str) -> str:
        """The class of what a function returns; empty for none."""
        return self._returned(path)

    def _returned_class(self, path: str) -> str:
        symbol = self._reader.symbol(path)
        for result in symbol.returns if symbol else ():
            if classes := self.classes_in(result.type, path):
                return classes[0]
        return ""


def _of_python(entry: SymbolEntry) -> re.Match[str] | None:
    """The class of what a property holds that gives a list or tuple of Python's."""
    text = entry.type if entry.kind == "property" else ""
    return _SEQUENCE.fullmatch(SEQUENCES.get(entry.path) or SEQUENCES.get(text, text))
