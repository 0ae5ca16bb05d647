"""Follows an expression through RNA's types: which symbol each step of a chain is."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_serve.reader import COLLECTION, TYPES, BaseReader, SymbolEntry

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kb_serve.recognise.chains import Chain, ChainStep

_MATH = {
    "TRANSLATION": "Vector", "XYZ": "Vector", "DIRECTION": "Vector", "VELOCITY": "Vector", "ACCELERATION": "Vector",
    "XYZ_LENGTH": "Vector", "EULER": "Euler", "QUATERNION": "Quaternion", "MATRIX": "Matrix", "COLOR": "Color",
    "COLOR_GAMMA": "Color",
}  # fmt: skip
_ROOTS = {
    "C": "bpy.context",
    "D": "bpy.data",
    "context": "bpy.context",
    "ops": "bpy.ops",
    "types": "bpy.types",
}
_INSTANCES = {"bpy.context": "bpy.types.Context", "bpy.data": "bpy.types.BlendData"}
_NUMBERED = re.compile(r"\.\d{3}$")
_CLASS_NAME = re.compile(r"\b(?:\w+\.)*[A-Z]\w+")
_ELEMENT_SUFFIXES = ("modifier", "constraint", "node", "settings")
_CUSTOMISABLE = frozenset({"ID", "Bone", "EditBone", "PoseBone", "PropertyGroup", "Strip", "ViewLayer"})
_COLLECTION_FIT = 0.7  # a variable called like a collection property and indexed is likely that collection
_USUAL = 0.05
_MAX_BRANCHES = 60
_OPERATOR_METHODS = frozenset({"poll", "idname", "idname_py", "get_rna_type", "bl_options"})


@dataclass(frozen=True, slots=True)
class ChainValue:
    """Where a walk stands: on an instance of ``cls``, on a collection of it, or on a module or function.

    ``origin`` is the class that the last attribute was read from, which may inherit it.
    """

    symbol: str
    cls: str = ""
    many: bool = False
    container: str = ""
    origin: str = ""


@dataclass(frozen=True, slots=True)
class ResolvedChain:
    """A chain as far as it could be followed.

    ``symbols`` are the ids of the steps that were found, in order; ``missing`` is the first name that the
    class ``owner`` does not have (empty when the whole chain resolved); ``fit`` tells how well a variable's
    name suits the class it was taken for, 0 to 1.
    """

    symbols: tuple[str, ...]
    missing: str = ""
    owner: str = ""
    fit: float = 1.0
    steps_left: int = 0

    @property
    def complete(self) -> bool:
        """Whether every step was found."""
        return bool(self.symbols) and not self.missing


def variable_fit(variable: str, cls: str) -> float:
    """How well a variable's name suits a class: ``obj`` Object, ``psys`` ParticleSystem, ``mat`` Material."""
    name, target = key(variable).rstrip("0123456789"), key(cls)
    if not name or not target:
        return 0.0
    if name == target:
        return 1.0
    if target.startswith(name) or name.startswith(target):
        return 0.9
    if target.endswith(name) or name.endswith(target):
        return 0.8
    letters = iter(target)
    if name[0] == target[0] and len(name) >= 3 and all(letter in letters for letter in name):
        return 0.6
    return 0.0


class Resolver:
    """Resolves chains against one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._returned = lru_cache(maxsize=500)(self._returned_class)

    def member(self, cls: str, name: str) -> SymbolEntry | None:
        """A class's own or inherited member."""
        for ancestor in self._reader.lineage(cls):
            found = self._reader.members(ancestor.path).get(name)
            if found:
                return found
        return None

    def resolve(self, chain: Chain) -> list[ResolvedChain]:
        """Every reading of a chain, best first: most steps found, then the likelier class for a variable."""
        readings = [
            replace(self._follow(place, chain.steps[used:]), fit=fit)
            for place, used, fit in self._starts(chain)
        ]
        unique = {
            (resolved.symbols[-1:], resolved.missing): resolved
            for resolved in reversed(self._ranked(readings))
        }
        return self._ranked(unique.values())

    @staticmethod
    def _ranked(readings: Iterable[ResolvedChain]) -> list[ResolvedChain]:
        return sorted(readings, key=lambda w: (w.steps_left, -w.fit, -len(w.symbols)))

    def _starts(self, chain: Chain) -> Iterator[tuple[ChainValue, int, float]]:
        """(place, steps used, fit) for everything that the chain's root can stand for."""
        exact = self._rooted(chain)
        if exact:
            yield exact
            return
        first = next((step.text for step in chain.steps if step.kind == "attr"), "")
        seen: set[str] = set()
        for cls, fit in self._typed_variables(chain.root):
            if cls not in seen:
                seen.add(cls)
                yield ChainValue(cls, cls), 0, fit
        if chain.steps:
            for entry in self._reader.by_name(chain.root)[:_MAX_BRANCHES]:
                if (
                    entry.kind == "property"
                    and (place := self._place(entry)).many
                    and self._has(place, chain)
                ):
                    usual = self._reader.descends(
                        entry.owner, f"{TYPES}ID"
                    )  # an Object's modifiers, not an FCurve's
                    yield place, 0, _COLLECTION_FIT + (_USUAL if usual else 0.0)
        if chain.steps and first:
            for entry in self._reader.by_name(first)[:_MAX_BRANCHES]:
                owner = self._reader.entry(entry.owner)
                if owner and owner.kind == "class" and entry.owner not in seen:
                    seen.add(entry.owner)
                    yield ChainValue(owner.path, owner.path), 0, 0.3 * variable_fit(chain.root, owner.name)

    def _has(self, place: ChainValue, chain: Chain) -> bool:
        """Whether a collection can be what a variable of its name is: indexed, or asked for what only it has."""
        step = chain.steps[0]
        return step.kind in {"key", "index"} or (
            step.kind == "attr" and self.member(place.container, step.text) is not None
        )

    def _rooted(self, chain: Chain) -> tuple[ChainValue, int, float] | None:
        """The longest leading part that is a path of its own: a module, a class, ``bpy.context``."""
        names = chain.dotted.split(".")
        names[:1] = _ROOTS.get(names[0], names[0]).split(".")
        extra = len(names) - len(chain.dotted.split("."))
        for length in range(len(names), 0, -1):
            path = ".".join(names[:length])
            for candidate in (path, TYPES + path):
                entry = self._reader.entry(candidate)
                if entry and not (length == 1 and entry.kind not in {"module", "class"}):
                    return self._place(entry), max(0, length - 1 - extra), 1.0
        return None

    def _typed_variables(self, name: str) -> Iterator[tuple[str, float]]:
        """Classes a bare variable may stand for: context members and properties of that name, similar classes."""
        for entry in self._reader.by_name(name):
            if entry.target and entry.kind == "context":
                yield TYPES + entry.target, 1.0
        for entry in self._reader.by_name(name):
            if entry.target and entry.kind == "property" and entry.type == "pointer":
                yield TYPES + entry.target, 0.85
        for entry in self._reader.members("bpy.types.BlendData").values():
            if entry.type == "collection" and (fit := variable_fit(name, entry.target)) > 0:
                yield TYPES + entry.target, fit
        for _, identifier in self._reader.by_key(key(name)):
            entry = self._reader.entry(identifier)
            if entry and entry.kind == "class":
                yield entry.path, 0.9

    def _place(self, entry: SymbolEntry, came_from: str = "") -> ChainValue:  # noqa: PLR0911 - one return a kind
        """Where one stands after a step to ``entry``."""
        if entry.path in _INSTANCES:
            return ChainValue(entry.path, _INSTANCES[entry.path])
        if entry.kind in {"module", "class"}:
            return ChainValue(entry.path, entry.path)
        if entry.kind == "socket":
            return ChainValue(entry.path, self._socket_class(entry))
        if entry.type == "collection":
            container = TYPES + entry.collection if entry.collection else COLLECTION
            return ChainValue(entry.path, TYPES + entry.target, many=True, container=container)
        if entry.target and entry.kind != "operator":
            return ChainValue(entry.path, TYPES + entry.target)
        if entry.kind == "function":
            return ChainValue(entry.path, container=came_from)
        if found := self._classes_in(entry.type, entry.path, whole=True):
            return self._sequence(entry.path, found)
        return ChainValue(entry.path, self._value_class(entry))

    def _socket_class(self, entry: SymbolEntry) -> str:
        """A socket's own class: what the record calls its target may be the data-block that it takes."""
        own = f"{TYPES}NodeSocket{entry.type.title()}"
        return (
            own
            if not entry.target.startswith("NodeSocket") and self._reader.entry(own)
            else TYPES + entry.target
        )

    def _value_class(self, entry: SymbolEntry) -> str:
        """The class of a plain property's value: mathutils for coordinates and colours."""
        symbol = self._reader.symbol(entry.path)
        if symbol and symbol.subtype in _MATH:
            return f"mathutils.{_MATH[symbol.subtype]}"
        return ""

    def _classes_in(self, text: str, path: str, *, whole: bool = False) -> list[str]:
        """The classes that a type in words names, ``BMElemSeq[BMEdge]``; those nearest to ``path`` first.

        ``whole`` asks for a type that is a class itself, not Python's list or tuple of one.
        """
        found: list[str] = []
        if whole and not _CLASS_NAME.match(text):
            return found
        for name in _CLASS_NAME.findall(text):
            places = [path[:at] for at in range(len(path), 0, -1) if path[at : at + 1] == "."]
            last = name.rpartition(".")[2]
            candidates = (name, *(f"{place}.{last}" for place in places), TYPES + last)
            classes = (
                entry for one in candidates if (entry := self._reader.entry(one)) and entry.kind == "class"
            )
            if first := next(classes, None):
                found.append(first.path)
        return found

    def _sequence(self, symbol: str, classes: list[str]) -> ChainValue:
        """An instance of the first class; where that is a sequence, its elements are what it names or makes."""
        first, *others = classes
        if first.endswith("Seq"):
            makes = self.member(first, "new")
            element = others[0] if others else self._returned(makes.path) if makes else ""
            return ChainValue(symbol, element, many=True, container=first)
        return ChainValue(symbol, first)

    def _follow(self, place: ChainValue, steps: tuple[ChainStep, ...]) -> ResolvedChain:
        """One step after the other; alternatives are tried where a base class stands for its descendants."""
        symbols = [place.symbol]
        places = [place]
        for number, step in enumerate(steps):
            following = [after for before in places for after in self._step(before, step)]
            if not following:
                missing, owner = self._lost(places[0], step)
                return ResolvedChain(tuple(symbols), missing, owner, steps_left=len(steps) - number)
            places = following[:_MAX_BRANCHES]
            if step.kind == "attr" or places[0].symbol != symbols[-1]:
                symbols.append(places[0].symbol)
        return ResolvedChain(tuple(symbols))

    @staticmethod
    def _lost(place: ChainValue, step: ChainStep) -> tuple[str, str]:
        """(name, owner) of a step that leads nowhere; a socket is missing on its node, not on its collection."""
        if step.kind == "key" and place.many:
            return f'{place.symbol.rpartition(".")[2]}["{step.text}"]', place.origin or place.cls
        return step.text, place.cls or place.symbol

    def _step(self, place: ChainValue, step: ChainStep) -> Iterator[ChainValue]:
        if step.kind == "attr":
            yield from self._attribute(place, step.text)
        elif step.kind == "call":
            yield self._call(place)
        elif place.many:
            yield from self._item(place, step)
        elif step.kind == "index":
            yield replace(place, cls="")  # an element of a vector
        elif not place.cls or self._takes_custom_properties(place.cls):
            yield replace(place, cls="")

    def _takes_custom_properties(self, cls: str) -> bool:
        return any(entry.name in _CUSTOMISABLE for entry in self._reader.lineage(cls))

    def _attribute(self, place: ChainValue, name: str) -> Iterator[ChainValue]:
        if place.many:
            found = self.member(place.container, name) or self.member(COLLECTION, name)
            if found:
                yield self._place(found, place.cls)
            return
        if name in _OPERATOR_METHODS and place.symbol.startswith("bpy.ops."):
            yield place
            return
        socket = place.symbol if "puts[" in place.symbol else ""
        found = self.member(place.cls, name) if place.cls else self._reader.members(place.symbol).get(name)
        if found:
            yield replace(self._place(found, place.cls), symbol=socket or found.path, origin=place.cls)
            return
        if not place.cls and hasattr(list, name) and self._is_list(place.symbol):
            yield place
        if place.cls.startswith(TYPES):
            for entry in self._reader.by_name(name):
                if entry.kind != "socket" and self._reader.descends(entry.owner, place.cls):
                    yield self._place(entry, entry.owner)

    def _is_list(self, path: str) -> bool:
        entry = self._reader.entry(path)
        return entry is not None and entry.type.startswith("list")

    def _item(self, place: ChainValue, step: ChainStep) -> Iterator[ChainValue]:
        """An element of a collection; the name in the brackets may tell its class or its socket."""
        declared, _, side = place.symbol.rpartition(".")
        owner = place.origin or declared
        if step.kind == "key" and side in {"inputs", "outputs"}:
            yield from self._socket(owner, side, step.text)
            return
        named = set(self._named_classes(place.cls, step.text)) if step.kind == "key" else set[str]()
        for path in self._in_tree(sorted(named, key=lambda path: (len(path), path)), owner):
            yield ChainValue(path, path)
        if not named:
            yield ChainValue(place.symbol, place.cls)

    def _in_tree(self, nodes: list[str], tree: str) -> list[str]:
        """Of nodes that share a name, those that the tree takes; all where that does not tell them apart."""
        if len(nodes) < 2:
            return nodes
        name = tree.removeprefix(TYPES)
        trees = {
            path: node.trees for path in nodes if (node := self._reader.symbol(path)) and name in node.trees
        }
        return sorted(trees, key=lambda path: len(trees[path])) or nodes

    def _named_classes(self, cls: str, text: str) -> Iterator[str]:
        """Descendants of ``cls`` (or itself) whose elements are called ``text`` by default."""
        wanted = key(_NUMBERED.sub("", text))
        for suffix in ("", *_ELEMENT_SUFFIXES):
            for _, identifier in self._reader.by_key(wanted + suffix):
                if identifier.startswith(TYPES) and self._reader.descends(identifier, cls):
                    yield identifier

    def _socket(self, owner: str, side: str, name: str) -> Iterator[ChainValue]:
        """The sockets of that name: of the node's own class, or of every node where only ``Node`` is known."""
        for entry in self._reader.by_name(name):
            on_side = entry.kind == "socket" and entry.path.startswith(f"{entry.owner}.{side}[")
            if on_side and self._reader.descends(entry.owner, owner):
                yield self._place(entry)

    def _call(self, place: ChainValue) -> ChainValue:
        """What a call returns; a function that promises some ID returns what it was called on."""
        entry = self._reader.entry(place.symbol)
        if entry is None or entry.kind != "function":
            return replace(place)
        returned = self._returned(place.symbol)
        if (
            place.container
            and returned
            and any(base.path == returned for base in self._reader.lineage(place.container))
        ):
            returned = place.container
        return ChainValue(place.symbol, returned)

    def _returned_class(self, path: str) -> str:
        symbol = self._reader.symbol(path)
        for result in symbol.returns if symbol else ():
            if found := self._classes_in(result.type, path):
                return found[0]
        return ""
