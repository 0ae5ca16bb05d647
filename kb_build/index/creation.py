"""The call that makes an instance of a class: ``obj.modifiers.new("Cloth", 'CLOTH')``.

Found in RNA alone. A collection whose own class has ``new`` makes its items; an enumeration or a type's name among the
call's arguments decides which subclass. What no collection makes is made by the operator of that name, or by a method
that all things have.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import key, terms
from kb_build.symbols.api_names import NEW_SOCKET, NODE, OPERATORS, TYPES
from kb_build.symbols.lines import held

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_build.symbols.records import EnumItem, NewValue, Parameter, Symbol

_MAKERS = ("new", "create", "add")
_NEW_KIND = "new_"
_BLOCKS = ("obj", "scene", "mesh", "mat", "tree", "curve")
_HOLDERS = {"BlendData": "bpy.data", "Mesh": "mesh", "Material": "mat", "NodeTree": "tree", "Curve": "curve"}

# Only nodes of a class that a script registers take sockets of their own.
_SOCKETS = (f"{TYPES}NodeInputs.new", f"{TYPES}NodeOutputs.new")
_USUAL_TREE = "geometry"  # which most scripts make groups of
_KIND_OF_TREE = re.compile(r"(\w+) node tree")  # as it is called that takes a value
_ARGUMENT = re.compile(r"(?<=, )\w+(?=[,)])")  # one that is no text
_SIZE = "8"  # pixels

# Class → the method that makes it, and a call.
_METHODS = {
    "Driver": (f"{TYPES}bpy_struct.driver_add", 'obj.driver_add("location", 2).driver'),
    "ShapeKey": (f"{TYPES}Object.shape_key_add", 'obj.shape_key_add(name="Key")'),
}


class Creation(NamedTuple):
    """How an instance is made: the call, the function or operator that is called, and what decides the type."""

    call: str
    maker: str
    choice: str = ""


def creation_calls(
    symbols: Iterable[Symbol], reached: Mapping[str, str], names: Mapping[str, str] | None = None
) -> dict[str, Creation]:
    """Path of a class → how an instance is made, for every class that has such a call.

    ``reached``: path of a class → an expression that gives an instance; ``names``: class, without its module → the name
    that Blender itself gives, by which such expressions find what was made.
    """
    return dict(_Calls(symbols, reached, names or {}).found())


def with_whole_calls(symbols: Sequence[Symbol], names: Mapping[str, str]) -> list[Symbol]:
    """The symbols; the calls that made what has their values, ``bpy.data.scenes.new()``, with all that these need.

    ``names``: as for ``creation_calls``.
    """
    calls = creation_calls(symbols, {}, names)
    makers = {symbol.path: symbol for symbol in symbols if symbol.kind == "function"}
    usual: dict[str, Creation] = {}
    for creation in sorted(calls.values(), key=lambda creation: bool(creation.choice)):
        usual.setdefault(creation.call.partition("(")[0], creation)
    return [
        replace(
            symbol, new_values=tuple(_whole(new, symbol, calls, usual, makers) for new in symbol.new_values)
        )
        if any(new.by for new in symbol.new_values)
        else symbol
        for symbol in symbols
    ]


def _whole(
    new: NewValue,
    symbol: Symbol,
    calls: Mapping[str, Creation],
    usual: Mapping[str, Creation],
    makers: Mapping[str, Symbol],
) -> NewValue:
    """A value with the whole call that makes what has it: of the symbol's own class, else of the usual one."""
    head = new.by.removesuffix("()")
    creation = calls.get(symbol.owner)
    if creation is None or not creation.call.startswith(f"{head}("):
        creation = usual.get(head)
    maker = makers.get(creation.maker) if creation else None
    if creation is None or maker is None:
        return new
    sizes = {given.name: _SIZE for given in maker.parameters if given.type.startswith("int")}
    return replace(new, by=_ARGUMENT.sub(lambda found: sizes.get(found[0], found[0]), creation.call))


class _Calls:
    def __init__(
        self, symbols: Iterable[Symbol], reached: Mapping[str, str], names: Mapping[str, str]
    ) -> None:
        self._names = names
        self._symbols = {symbol.path: symbol for symbol in symbols}
        self._reached = reached
        self._below: dict[str, list[Symbol]] = defaultdict(list)
        # class of a collection → its functions that make one kind of element
        self._kinds: dict[str, list[Symbol]] = defaultdict(list)
        for symbol in self._symbols.values():
            if symbol.kind == "class" and symbol.base:
                self._below[symbol.base].append(symbol)
            elif symbol.kind == "function" and symbol.name.startswith(_NEW_KIND):
                self._kinds[symbol.owner].append(symbol)
        self._of_collections = {f"{TYPES}{holder.collection}" for holder in self._collections()}

    def found(self) -> Iterator[tuple[str, Creation]]:
        calls: dict[str, Creation] = dict(self._by_operators())
        for holder in sorted(self._collections(), key=self._far):
            for cls, creation in (*self._by_collection(holder), *self._by_kind(holder)):
                known = calls.get(cls)
                if (
                    known is None
                    or known.maker.startswith(OPERATORS)
                    or self._holds_alone(holder, cls, known)
                ):
                    calls[cls] = creation
        calls.update(self._of_interfaces())
        for name, (maker, call) in _METHODS.items():
            cls = f"{TYPES}{name}"
            is_better = cls not in calls or calls[cls].maker.startswith(OPERATORS)
            if is_better and {maker, cls} <= self._symbols.keys():
                calls[cls] = Creation(call, maker)
        yield from calls.items()

    def _holds_alone(self, holder: Symbol, cls: str, known: Creation) -> bool:
        """Whether a class is reached through a collection, not through that of a known call: IK through a bone's."""
        reached = held(self._reached.get(cls, ""))
        known_holder = known.call.partition("(")[0].rpartition(".")[0]
        is_in = reached.startswith(f"{self._owner(holder)}.{holder.name}[")
        return is_in and not reached.startswith(f"{known_holder}[")

    def _collections(self) -> Iterator[Symbol]:
        for symbol in self._symbols.values():
            if symbol.kind == "property" and symbol.type == "collection" and symbol.collection:
                yield symbol

    def _far(self, holder: Symbol) -> tuple[bool, bool, int, int]:
        """How far a collection is from being the one that a class is thought to be made by: ``fcurves`` of FCurve."""
        owner = holder.owner.removeprefix(TYPES)
        is_called_so = key(holder.name).removesuffix("s") == key(holder.target)
        return owner not in _HOLDERS, not is_called_so, self._owner(holder).count("."), len(holder.path)

    def _owner(self, holder: Symbol) -> str:
        name = holder.owner.removeprefix(TYPES)
        return _HOLDERS.get(name) or held(self._reached.get(holder.owner, name.lower()))

    def _head(self, holder: Symbol, maker: Symbol) -> str:
        """A call's beginning, up to its arguments."""
        return f"{self._owner(holder)}.{holder.name}.{maker.name}"

    def _by_collection(self, holder: Symbol) -> Iterator[tuple[str, Creation]]:
        for name in _MAKERS:
            maker = self._symbols.get(f"{TYPES}{holder.collection}.{name}")
            if maker is not None and maker.returns and maker.path not in _SOCKETS:
                break
        else:
            return
        base = self._symbols.get(f"{TYPES}{maker.returns[0].type}") or self._symbols.get(
            f"{TYPES}{holder.target}"
        )
        if base is None:
            return
        head, types, items = self._head(holder, maker), _types(maker), _kinds_of(maker)
        # What takes the name of any class is a string, or an enumeration whose items come at run time.
        are_classes = bool(items) and all(TYPES + item in self._symbols for item in items)
        by_name = types is not None and (types.type == "string" or items.keys() == {"DEFAULT"} or are_classes)
        block = next((name for name in _BLOCKS if head.startswith(f"{name}.")), "")
        for cls, alone in self._kinds_below(base):
            if base.path == NODE and not cls.trees:
                continue  # RNA has the class, and every tree refuses it
            if choice := cls.name if by_name else _choice(cls, base, items, alone=alone):
                given = self._arguments(maker, cls, choice, block=block)
                yield cls.path, Creation(f"{head}({given})", maker.path, choice)
        # Where a type must be told, only data-blocks are also made of the base class, and what has no kinds of its own.
        is_whole = holder.owner == f"{TYPES}BlendData" or base.path not in self._below
        if not items or (not by_name and is_whole):
            first = next(iter(items), "")
            given = self._arguments(maker, base, first, block=block)
            yield base.path, Creation(f"{head}({given})", maker.path)

    def _kinds_below(self, base: Symbol) -> Iterator[tuple[Symbol, bool]]:
        """The classes below one, and whether each has its label alone."""
        descendants = list(self._descendants(base.path))
        labels = Counter(key(cls.label) for cls in descendants)
        for cls in descendants:
            yield cls, labels[key(cls.label)] == 1

    def _by_kind(self, holder: Symbol) -> Iterator[tuple[str, Creation]]:
        """What functions for one kind each make: ``strips.new_image`` an ImageStrip, ``new_effect`` those by type."""
        base = self._symbols.get(TYPES + holder.target)
        for maker in self._kinds.get(f"{TYPES}{holder.collection}", ()):
            head, items = self._head(holder, maker), _kinds_of(maker)
            called = key(maker.name.removeprefix(_NEW_KIND) + holder.target)
            for cls, alone in self._kinds_below(base) if base else ():
                choice = _choice(cls, base, items, alone=alone) if base and items else ""
                if choice or (not items and key(cls.name) == called):
                    given = self._arguments(maker, cls, choice, block="")
                    yield cls.path, Creation(f"{head}({given})", maker.path, choice)

    def _of_interfaces(self) -> Iterator[tuple[str, Creation]]:
        """A group's sockets: the items of its interface, and what they become on its nodes."""
        maker = self._symbols.get(NEW_SOCKET)
        if maker is None:
            return
        for parameter in maker.parameters:
            for item in parameter.enum_items if parameter.name == "socket_type" else ():
                tree = _tree_taking(item)
                call = (
                    f"{tree}.interface.new_socket(\"Name\", in_out='INPUT', socket_type='{item.identifier}')"
                )
                made = f"NodeTreeInterface{item.identifier.removeprefix('Node')}"
                for cls, choice in ((made, item.identifier), (item.identifier, "")):
                    if TYPES + cls in self._symbols:
                        yield TYPES + cls, Creation(call, NEW_SOCKET, choice)

    def _arguments(self, maker: Symbol, cls: Symbol, choice: str, *, block: str) -> str:
        given = [
            self._argument(maker, parameter, cls, choice, block=block)
            for parameter in maker.parameters
            if parameter.required or (choice and parameter.name == "type")
        ]
        # Without these Blender refuses the choice, though they have defaults.
        wanted = [name for refusal in maker.refusals if choice in refusal.values for name in refusal.given]
        return ", ".join((*given, *(f"{name}={name}" for name in wanted)))

    def _argument(self, maker: Symbol, parameter: Parameter, cls: Symbol, choice: str, *, block: str) -> str:
        if parameter.name == "type" and choice:
            word = f"{parameter.name}=" if _by_name_only(maker, parameter) else ""
            return word + (f"'{choice}'" if parameter.enum_items else f'"{choice}"')
        if parameter.name == "name":
            label = cls.label or cls.name
            label = label.removesuffix(" Modifier").removesuffix(" Constraint")
            return f'"{self._names.get(cls.name, label)}"'
        if parameter.enum_items and block and f"{TYPES}ID.{parameter.name}" in self._symbols:
            return f"{block}.{parameter.name}"  # what every data-block has: ``obj.id_type``
        if parameter.enum_items:
            return f"'{parameter.enum_items[0].identifier}'"
        return parameter.name

    def _descendants(self, path: str) -> Iterator[Symbol]:
        for cls in self._below.get(path, ()):
            yield cls
            yield from self._descendants(cls.path)

    def _by_operators(self) -> Iterator[tuple[str, Creation]]:
        """Operators called ``…_add`` whose module and name, or name alone, are those of a class."""
        made: dict[str, Symbol] = {}
        for symbol in self._symbols.values():
            if symbol.kind == "operator" and symbol.name.endswith("add"):
                module = symbol.owner.rpartition(".")[2]
                name = symbol.name.removesuffix("_add")
                made.setdefault(key(name), symbol)
                made[key(module + name)] = symbol
        for symbol in self._symbols.values():
            operator = made.get(key(symbol.name))
            if (
                operator
                and symbol.kind == "class"
                and symbol.group == "data"
                and symbol.path.startswith(TYPES)
                and symbol.path not in self._below
                and symbol.path not in self._of_collections
            ):
                yield symbol.path, Creation(f"{operator.path}()", operator.path)


def _by_name_only(maker: Symbol, parameter: Parameter) -> bool:
    """Whether a function takes an argument as a keyword only: it stands behind ``*``."""
    _, star, after = maker.signature.partition("*, ")
    return bool(star) and re.search(rf"\b{parameter.name}\b", after) is not None


def _types(maker: Symbol) -> Parameter | None:
    """The argument of a function that decides which class it makes."""
    return next((parameter for parameter in maker.parameters if parameter.name == "type"), None)


def _kinds_of(maker: Symbol) -> dict[str, str]:
    """Identifier → name of what that argument can be."""
    types = _types(maker)
    return {item.identifier: item.name for item in types.enum_items} if types else {}


def _tree_taking(socket: EnumItem) -> str:
    """``tree``, or ``geometry_tree`` where not every kind of tree takes a socket."""
    where = socket.where
    kinds = {found[1] for found in map(_KIND_OF_TREE.fullmatch, where.things if where else ()) if found}
    if where is None or not kinds:
        return "tree"
    takes_usual = (_USUAL_TREE in kinds) != (where.how == "not")
    return f"{_USUAL_TREE if takes_usual else min(kinds)}_tree"


def _choice(cls: Symbol, base: Symbol, items: Mapping[str, str], *, alone: bool = False) -> str:
    """The item of the maker's enumeration that stands for a subclass: ``CLOTH`` for ClothModifier.

    ``alone``: no other subclass has its label.
    """
    name = key(cls.name.removesuffix(base.name).removeprefix(base.name))
    label = key(cls.label.removesuffix(base.label))
    firsts = {identifier.partition("_")[0] for identifier in items}
    shared = f"{firsts.pop()}_" if len(firsts) == 1 else ""  # FX of FX_BLUR
    by_identifier = {key(identifier.removeprefix(shared)): identifier for identifier in items}
    for wanted in (key(cls.name), name, key(_between(cls.name, base.name))):
        if wanted in by_identifier:
            return by_identifier[wanted]
    # Several classes may have one label, as the modifiers of meshes and of drawings.
    for identifier, text in items.items():
        is_called_so = text and key(text) in {label, key(cls.label)}
        if is_called_so and (alone or key(identifier) in key(cls.name)):
            return identifier
    # The item may say more, or less: Inverse Kinematics makes a Kinematic Constraint, Speed a Speed Control Strip.
    own = set(terms(cls.label.removesuffix(base.label)))
    said = {identifier: set(terms(text)) for identifier, text in items.items()}
    fuller = [identifier for identifier, words in said.items() if own and own < words]
    shorter = [identifier for identifier, words in said.items() if words and words < own]
    return next((found[0] for found in (fuller, shorter) if alone and len(found) == 1), "")


def _between(name: str, base: str) -> str:
    """What a name has within its base's: ``Keyframe`` of ActionKeyframeStrip, an ActionStrip."""
    before = next((n for n, (a, b) in enumerate(zip(name, base, strict=False)) if a != b), len(base))
    after = base[before:]
    return name[before : len(name) - len(after)] if name.endswith(after) else ""
