"""Resolves expressions through RNA's types: which symbol each step of a chain is."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import islice
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, words
from kb_serve.reader import COLLECTION, PROPERTIES, STRUCT, TYPES, BaseReader, SymbolEntry
from kb_serve.recognise.owners import Owners
from kb_serve.recognise.subscripts import CustomProperties
from kb_serve.recognise.values import SEQUENCES, VALUES
from kb_serve.recognise.variables import Variables

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_serve.recognise.chains import Chain, ChainStep

_MATH = {
    "TRANSLATION": "Vector", "XYZ": "Vector", "DIRECTION": "Vector", "VELOCITY": "Vector", "ACCELERATION": "Vector",
    "XYZ_LENGTH": "Vector", "EULER": "Euler", "QUATERNION": "Quaternion", "MATRIX": "Matrix", "COLOR": "Color",
    "COLOR_GAMMA": "Color",
}  # fmt: skip
ROOTS = {
    "C": "bpy.context",
    "D": "bpy.data",
    "context": "bpy.context",
    "ops": "bpy.ops",
    "types": "bpy.types",
}
# Whose classes and modules scripts import by name.
_IMPORTED = ("mathutils.", "bmesh.types.", "bpy_extras.")
_OBJECT_DATA = f"{TYPES}Object.data"
# What every class and instance tells of itself, and what that is.
_RNA, _STRUCT_OF_ALL = ("bl_rna", "rna_type"), f"{TYPES}Struct"
_ARRAY = f"{TYPES}bpy_prop_array"
_MATRIX, _ROW = "mathutils.Matrix", "mathutils.Vector"
_LINKS = "links"  # of a socket, which lead elsewhere
_ROWS = {f"{_MATRIX}.col", f"{_MATRIX}.row"}
_PROPERTIES_OF_OPERATORS = f"{TYPES}OperatorProperties"
_GROUP, _GROUPS = f"{TYPES}PropertyGroup", f"{TYPES}bpy_prop_collection_idprop"
_INSTANCE = "self"  # of a class of the script's own, whose attributes are like variables
_ELEMENT, _LAYERS = "bmesh.types.BM", "bmesh.types.BMLayerAccess"
_INSTANCES = {"bpy.context": "bpy.types.Context", "bpy.data": "bpy.types.BlendData"}
_NUMBERED = re.compile(r"\.\d{3}$")
_QUOTED = re.compile(r"""(["'])([\w.]+)\1""")
_SEQUENCE = re.compile(r"(?:list|set|tuple)\[(?:bpy\.types\.)?([A-Z]\w*)(?:, \.\.\.)?\]")
_CLASS_NAME = re.compile(r"\b(?:\w+\.)*[A-Z]\w+")
_ELEMENT_SUFFIXES = ("modifier", "constraint", "node", "settings")
_NAMED_LIKE_A_MODULE = 0.9  # fit of a class that a variable is named after, which is no module then
_MODULE_THAT_LACKS = 0.6  # … of a module that lacks what is read, by its last name
_COLLECTION_FIT = 0.7  # of a variable with the name of a collection property that is used as one
_USUAL = 0.05
_LIGHTER = 0.0005  # for each that counts more
LEAST_OF_COLLECTION = _COLLECTION_FIT - _USUAL
_MAX_BRANCHES = 60
_MOST_NAMES = 8  # in the longest path
_OPERATOR_METHODS = frozenset({"poll", "idname", "idname_py", "get_rna_type", "bl_options"})


@dataclass(frozen=True, slots=True)
class ChainValue:
    """What a chain stands for up to a step: an instance of ``cls``, a collection of it, a module or a function.

    ``origin`` is the class that the last attribute was read from, which may inherit it; ``keyed`` the class whose
    custom property this is.
    """

    symbol: str
    cls: str = ""
    many: bool = False
    container: str = ""
    origin: str = ""
    keyed: str = ""


@dataclass(frozen=True, slots=True)
class ResolvedChain:
    """A chain as far as it could be resolved.

    ``symbols`` are the ids of the resolved steps, in order; ``missing`` is the first name that the class ``owner``
    does not have (empty if the whole chain resolved); ``fit`` tells how well a variable's name suits the class
    that was assumed for it, 0 to 1; ``keyed`` is the class whose custom property the chain reaches,
    ``cls`` the class of what a complete one gives, where that is known, and ``alike`` are the members of the last
    step's name that other cases of its class have, those that count most first.
    """

    symbols: tuple[str, ...]
    missing: str = ""
    owner: str = ""
    fit: float = 1.0
    steps_left: int = 0
    keyed: str = ""
    cls: str = ""
    alike: tuple[str, ...] = ()

    @property
    def complete(self) -> bool:
        """Whether every step was resolved."""
        return bool(self.symbols) and not self.missing


def _of_python(entry: SymbolEntry) -> re.Match[str] | None:
    """The class of what a property holds that gives a list or tuple of Python's."""
    text = entry.type if entry.kind == "property" else ""
    return _SEQUENCE.fullmatch(SEQUENCES.get(entry.path) or SEQUENCES.get(text, text))


def _first_name(chain: Chain) -> str:
    return next(iter(chain.attributes), "")


class Resolver:
    """Resolves chains against one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._variables = Variables(reader)
        self._owners = Owners(reader)
        self._custom = CustomProperties(reader)
        self._returned = lru_cache(maxsize=500)(self._returned_class)
        self._named = lru_cache(maxsize=64)(self._named_classes)

    def member(self, cls: str, name: str) -> SymbolEntry | None:
        """A class's own or inherited member."""
        return self._reader.member_of(cls, name)

    def resolve(self, chain: Chain) -> list[ResolvedChain]:
        """Every reading of a chain, best first: most steps resolved, then the likelier class for a variable."""
        readings = [
            replace(self._follow(value, chain.steps[used:]), fit=fit)
            for value, used, fit in self._starts(chain)
        ]
        unique = {
            (resolved.symbols[-1:], resolved.missing): resolved
            for resolved in reversed(self._ranked(readings))
        }
        return self._ranked(unique.values())

    def onward(self, path: str, steps: tuple[ChainStep, ...]) -> ResolvedChain:
        """Follows steps from a symbol, as if an expression had led there."""
        entry = self._reader.entry(path)
        return self._follow(self._value_of(entry), steps) if entry else ResolvedChain(())

    @staticmethod
    def _ranked(readings: Iterable[ResolvedChain]) -> list[ResolvedChain]:
        return sorted(readings, key=lambda reading: (reading.steps_left, -reading.fit, -len(reading.symbols)))

    def _starts(self, chain: Chain) -> Iterator[tuple[ChainValue, int, float]]:
        """(value, steps used, fit) for everything that the chain's root can stand for."""
        if self._is_of_the_instance(chain):
            own = replace(chain, root=chain.steps[0].text, steps=chain.steps[1:])
            yield from ((value, used + 1, fit) for value, used, fit in self._starts(own))
        elif (exact := self._rooted(chain)) and self._may_be_variable(chain, exact[0].symbol):
            named = self._named_like_a_module(chain.root, _first_name(chain))
            for rank, cls in enumerate(named):
                yield ChainValue(cls, cls), 0, _NAMED_LIKE_A_MODULE - 0.001 * rank
            if not named:
                yield from ((value, 0, fit) for value, fit in self._of_variable(chain))
            yield exact[0], exact[1], _MODULE_THAT_LACKS
        elif exact:
            yield exact
        else:
            yield from ((value, 0, fit) for value, fit in self._of_variable(chain))

    def _is_of_the_instance(self, chain: Chain) -> bool:
        """Whether a chain goes on from an attribute that only a script's own class can have: ``self.obj.location``."""
        if chain.root != _INSTANCE or not chain.steps[1:] or chain.steps[0].kind != "attr":
            return False
        return not any(entry.group == "ui" for entry in self._reader.by_name(_first_name(chain)))

    def _of_variable(self, chain: Chain) -> Iterator[tuple[ChainValue, float]]:
        """(value, fit) for everything that a variable can stand for: by its name, then by the member that it has."""
        seen: set[str] = set()
        for cls, fit in self._variables.classes(chain.root):
            if cls not in seen:
                seen.add(cls)
                yield ChainValue(cls, cls), fit
        if not chain.steps:
            return
        named = self._owners.heaviest(self._reader.by_name(chain.root)[:_MAX_BRANCHES])
        for rank, entry in enumerate(named):
            if (
                entry.kind == "property"
                and (value := self._value_of(entry)).many
                and self._is_used_as(value, chain)
            ):
                # An Object's modifiers are likelier than an FCurve's.
                is_usual = self._reader.descends(entry.owner, f"{TYPES}ID")
                yield value, _COLLECTION_FIT + (_USUAL if is_usual else 0.0) - _LIGHTER * rank
        for cls, fit in self._owners.of(chain):
            if cls not in seen:
                seen.add(cls)
                yield ChainValue(cls, cls), fit

    def _may_be_variable(self, chain: Chain, module: str) -> bool:
        """Whether a root is called like a module that scripts import by its last name, and that lacks what is read."""
        entry = self._reader.entry(module)
        short = entry is not None and entry.kind == "module" and module != chain.root
        if not (chain.attributes and short and module.endswith(f".{chain.root}")) or module.startswith(
            "bpy."
        ):
            return False
        name = _first_name(chain)
        return bool(self._reader.by_name(name)) and self._reader.entry(f"{module}.{name}") is None

    def _named_like_a_module(self, variable: str, member: str) -> list[str]:
        """The classes that have a member and are called like a variable: ``noise.outputs`` is of a noise texture."""
        owners = {entry.owner for entry in self._reader.by_name(member)[:_MAX_BRANCHES]}
        below = (cls.path for owner in owners for cls in self._reader.descendants(owner))
        named = {path for path in (*owners, *below) if variable in words(path.rpartition(".")[2])}
        return sorted(named, key=lambda path: (len(path), path))

    def _is_used_as(self, value: ChainValue, chain: Chain) -> bool:
        """Whether a variable with a collection's name is used as one: indexed, or with a member of the collection."""
        step = chain.steps[0]
        return step.kind in {"key", "index"} or (
            step.kind == "attr" and self.member(value.container, step.text) is not None
        )

    def _rooted(self, chain: Chain) -> tuple[ChainValue, int, float] | None:
        """The longest leading part that is a path itself: a module, a class, ``bpy.context``."""
        names = chain.dotted.split(".")
        names[:1] = ROOTS.get(names[0], names[0]).split(".")
        extra = len(names) - len(chain.dotted.split("."))
        paths = [".".join(names[:length]) for length in range(min(len(names), _MOST_NAMES), 0, -1)]
        packages = ("", PROPERTIES, TYPES, *_IMPORTED)
        self._reader.entry.load(package + path for path in paths for package in packages)
        for length, path in zip(range(len(paths), 0, -1), paths, strict=True):
            for package in packages:
                entry = self._reader.entry(package + path)
                is_imported = package or length > 1
                if entry and (is_imported or entry.kind in {"module", "class"}):
                    return self._value_of(entry), max(0, length - 1 - extra), 1.0
        return None

    def _value_of(self, entry: SymbolEntry, came_from: str = "") -> ChainValue:  # noqa: PLR0911 - one return a kind
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
        if entry.type == "collection":
            container = TYPES + entry.collection if entry.collection else COLLECTION
            return ChainValue(entry.path, TYPES + entry.target, many=True, container=container)
        if entry.target and entry.kind != "operator":
            return ChainValue(entry.path, TYPES + entry.target)
        if entry.kind == "function":
            return ChainValue(entry.path, container=came_from)
        if classes := self._classes_in(entry.type, entry.path, whole=True):
            return self._sequence(entry.path, classes)
        return ChainValue(entry.path, self._value_class(entry))

    def _socket_class(self, entry: SymbolEntry) -> str:
        """A socket's own class: the target in its record may be the data-block that it takes."""
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
        return _ARRAY if symbol and symbol.array else ""

    def _classes_in(self, text: str, path: str, *, whole: bool = False) -> list[str]:
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

    def _sequence(self, symbol: str, classes: list[str]) -> ChainValue:
        """An instance of the first class; of a sequence, the elements are of the class that it names or creates."""
        first, *others = classes
        if first.endswith(("Seq", "Slice")):
            makes = self.member(first, "new")
            element = others[0] if others else self._returned(makes.path) if makes else ""
            return ChainValue(symbol, element, many=True, container=first)
        return ChainValue(symbol, first)

    def _follow(self, value: ChainValue, steps: tuple[ChainStep, ...]) -> ResolvedChain:
        """Resolves step after step; a base class is tried as each of its descendants."""
        symbols = [value.symbol]
        values = [value]
        alike: tuple[str, ...] = ()
        for number, step in enumerate(steps):
            branches = (after for before in values for after in self._step(before, step))
            following = list(islice(branches, _MAX_BRANCHES))
            if not following:
                missing, owner = self._unresolved(values[0], step)
                return ResolvedChain(tuple(symbols), missing, owner, steps_left=len(steps) - number)
            alike = tuple(after.symbol for after in following[1:]) if len(values) == 1 else ()
            values = following
            if step.kind == "attr" or values[0].symbol != symbols[-1]:
                symbols.append(values[0].symbol)
        return ResolvedChain(tuple(symbols), keyed=values[0].keyed, cls=values[0].cls, alike=alike)

    @staticmethod
    def _unresolved(value: ChainValue, step: ChainStep) -> tuple[str, str]:
        """(name, owner) of an unresolved step; a socket is missing on its node, not on its collection."""
        if step.kind == "key" and value.many:
            return f'{value.symbol.rpartition(".")[2]}["{step.text}"]', value.origin or value.cls
        if step.kind == "key":
            return f'["{step.text}"]', value.cls or value.symbol
        if value.many and step.kind == "attr":
            return step.text, value.container
        return step.text, value.cls or value.symbol

    def _step(self, value: ChainValue, step: ChainStep) -> Iterator[ChainValue]:
        if step.kind == "attr":
            yield from self._attribute(value, step.text)
        elif step.kind == "call":
            yield self._call(value, step.text)
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
                yield value
            elif entry := self._of_collection(value, name):
                yield self._value_of(entry, value.cls)
            return
        if name in _RNA and value.cls.startswith(TYPES):
            yield ChainValue(_STRUCT_OF_ALL, _STRUCT_OF_ALL)
            return
        if name in _OPERATOR_METHODS and value.symbol.startswith("bpy.ops."):
            yield value
            return
        if value.cls.startswith("bpy.ops.") and self._has_parameter(value.cls, name):
            yield ChainValue(value.cls)
            return
        own = self.member(value.cls, name) if value.cls else self._reader.member((value.symbol,), name)
        if own:
            after = self._value_of(own, value.cls)
            is_of_socket = "puts[" in value.symbol and not after.many and name != _LINKS
            yield replace(after, symbol=value.symbol if is_of_socket else own.path, origin=value.cls)
            return
        if not value.cls and hasattr(list, name) and self._is_list(value.symbol):
            yield value
        if value.cls.startswith(TYPES):
            below = [
                entry
                for entry in self._reader.by_name(name)
                if entry.kind != "socket" and self._reader.descends(entry.owner, value.cls)
            ]
            if value.symbol == _OBJECT_DATA:
                below = [entry for entry in below if self._reader.is_object_data(entry.owner)] or below
            for entry in self._owners.heaviest(below):
                yield self._value_of(entry, entry.owner)

    def _has_parameter(self, path: str, name: str) -> bool:
        symbol = self._reader.symbol(path)
        return symbol is not None and any(parameter.name == name for parameter in symbol.parameters)

    def _of_collection(self, value: ChainValue, name: str) -> SymbolEntry | None:
        """A member of a collection: of its own class, of all collections, or of those of property groups."""
        own = self.member(value.container, name)
        if own and own.owner != STRUCT:  # ``get`` of a collection is no struct's
            return own
        of_groups = self._reader.descends(value.cls, _GROUP) and self.member(_GROUPS, name)
        return self.member(COLLECTION, name) or of_groups or own

    def _is_list(self, path: str) -> bool:
        entry = self._reader.entry(path)
        return entry is not None and entry.type.startswith("list")

    def _item(self, value: ChainValue, step: ChainStep) -> Iterator[ChainValue]:
        """An element of a collection; the key may tell its class or socket."""
        declared, _, side = value.symbol.rpartition(".")
        owner = value.origin or declared
        if step.kind == "key" and side in {"inputs", "outputs"}:
            yield from self._socket(owner, side, step.text)
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
            for held in self._classes_in(layers.type.partition("[")[2], layers.path):
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
            path for suffix in ("", *_ELEMENT_SUFFIXES) for _, path in self._reader.by_key(key(name) + suffix)
        )
        found: dict[str, None] = {}
        for paths in (self._reader.made_as(name), labelled):
            named = {path for path in paths if path.startswith(TYPES) and self._reader.descends(path, cls)}
            found |= dict.fromkeys(sorted(named, key=lambda path: (len(path), path)))
        return tuple(found)

    def _socket(self, owner: str, side: str, name: str) -> Iterator[ChainValue]:
        """The sockets of that name: of the node's own class, or of every node where only ``Node`` is known."""
        for entry in self._reader.by_name(name):
            on_side = entry.kind == "socket" and entry.path.startswith(f"{entry.owner}.{side}[")
            if on_side and self._reader.descends(entry.owner, owner):
                yield self._value_of(entry)

    def _call(self, value: ChainValue, arguments: str) -> ChainValue:
        """What a call returns; a function that returns a base class of its owner returns the owner's class, and one
        that makes several classes that which its arguments say.
        """
        entry = self._reader.entry(value.symbol)
        if entry is None or entry.kind != "function":
            return replace(value)
        for _, choice in _QUOTED.findall(arguments):
            for cls, maker in self._reader.made_by_choice(choice):
                if maker == value.symbol:
                    return ChainValue(value.symbol, cls)
        returned = self._returned(value.symbol)
        if returned == _PROPERTIES_OF_OPERATORS and (operator := self._operator_in(arguments)):
            return ChainValue(value.symbol, operator)
        if (
            value.container
            and returned
            and any(base.path == returned for base in self._reader.lineage(value.container))
        ):
            returned = value.container
        return ChainValue(value.symbol, returned)

    def _operator_in(self, arguments: str) -> str:
        """The path of the operator that is called by its name in a text: ``layout.operator("mesh.delete")``."""
        paths = (f"bpy.ops.{name}" for _, name in _QUOTED.findall(arguments) if "." in name)
        return next((path for path in paths if self._reader.entry(path)), "")

    def _returned_class(self, path: str) -> str:
        symbol = self._reader.symbol(path)
        for result in symbol.returns if symbol else ():
            if classes := self._classes_in(result.type, path):
                return classes[0]
        return ""
