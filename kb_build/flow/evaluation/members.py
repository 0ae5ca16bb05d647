"""Reads attributes of every type."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from itertools import takewhile
from typing import TYPE_CHECKING, ClassVar, Literal

from kb_build.flow.blender.api import ARRAY, operator_path
from kb_build.flow.blender.facts import (
    DERIVED_BY_SCRIPTS,
    HALF_KNOWN,
    OF_OBJECT,
    OF_OPERATOR,
    OF_STRUCT_SEQUENCES,
    OPEN_CLASSES,
    PYTHON_NAMES,
    STRUCT_SEQUENCES,
    VERSION,
)
from kb_build.flow.evaluation.items import Items, has_sockets_of_its_own
from kb_build.flow.state.core import ANY
from kb_build.flow.values.type_parts import unsure
from kb_build.flow.values.types import (
    FROM_VERSION,
    MOST_MEMBERS,
    UNKNOWN,
    Builtin,
    ClassObject,
    Collection,
    Function,
    Instance,
    LocalClass,
    LocalFunction,
    LocalInstance,
    LocalModule,
    Mapping,
    Module,
    NoneValue,
    Operator,
    Plain,
    Sequence,
    Tuple,
    Type,
    Union,
    union,
)
from kb_build.symbols.api_names import COLLECTION, GROUPS, SIDES, STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.unlisted import SOMETIMES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kb_build.symbols.records import Symbol

_GROUP_METHODS = frozenset({"add", "remove", "clear", "move"})
_ROWS: dict[str, type] = {"set": set, "deque": deque}
_PYTHON: dict[str, type] = {"str": str, "int": int, "float": float, "bool": bool, "bytes": bytes}
_TYPES = T.removesuffix(".")
_GROUP = f"{T}PropertyGroup"


@dataclass(slots=True)
class Lookup:
    """What an attribute was found to be, for each member of a union in turn (see types.Resolution).

    One is made for each attribute that is read: ``list`` is called in a tenth of the time of ``list[Type]``. Its
    ``use`` is ``keyword`` where a button's operator is set up.
    """

    types: list[Type] = field(default_factory=list)
    symbols: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    possible: list[str] = field(default_factory=list)
    sure: bool = True
    use: Literal["attribute", "keyword"] = "attribute"

    @property
    def type(self) -> Type:
        """The type of the attribute."""
        return self.types[0] if len(self.types) == 1 else union(self.types)


class Members(Items):
    """Reads attributes and items."""

    def attribute(self, kind: Type, name: str) -> Lookup:
        """An attribute of a value."""
        found = Lookup()
        if isinstance(kind, Union):
            lost: list[Type] = []
            for member in kind.members:
                if not isinstance(member, NoneValue):
                    lacking, known = len(found.missing), len(found.types)
                    self._read(member, name, found)
                    if len(found.missing) > lacking:
                        lost += found.types[known:]
                        del found.types[known:]
            if not found.types:  # else who goes on has a member that has it
                found.types += lost
            elif not (found.symbols or found.possible):
                found.missing.clear()  # the script's own thing has it
        else:
            self._read(kind, name, found)
        if not found.types:
            found.types.append(UNKNOWN)
        return found

    def _read(self, kind: Type, name: str, found: Lookup) -> None:
        reader = self._attribute_readers.get(type(kind))
        if reader is not None:
            reader(self, kind, name, found)
        else:
            found.types.append(UNKNOWN)

    def _of_instance(self, kind: Instance, name: str, found: Lookup) -> None:
        found.sure = found.sure and kind.sure
        member = self.api.member(kind.cls, name)
        if member is not None and (own := self._declared_over(member.symbol, kind.cls, name)) is not None:
            found.types.append(own)
            return
        if member is not None:
            found.symbols.append(member.symbol.path)
            trait = kind.trait(name)
            found.types.append(self.as_found(trait) if trait else self._held(member.type, kind, name))
            return
        if (extra := self._registered(kind.cls, name)) is not None:
            found.types.append(extra)
            return
        if isinstance(operator := kind.trait(OF_OPERATOR), Operator):
            self._of_button(operator, name, found)
            return
        is_data = kind.trait(OF_OBJECT) is not None
        if below := self.api.below_as_data(name) if is_data else self.api.below(kind.cls, name):
            found.possible += [member.symbol.path for _, member in below]
            kinds = [
                self._held(member.type, Instance(cls), name) for cls, member in below[: MOST_MEMBERS + 1]
            ]
            found.types.append(union(kinds) if len(kinds) <= MOST_MEMBERS else UNKNOWN)
            return
        if (
            not _is_unlisted(kind.cls, name)
            # What scripts may add to is not told of, but for what it had in another Blender.
            and (not self.is_open(kind.cls) or self.api.had(kind.cls, name))
            and not self.is_there_at_times(f"{kind.cls}.{name}")
        ):
            found.missing.append(kind.cls)
            found.sure = found.sure and kind.cls not in DERIVED_BY_SCRIPTS
            found.types.append(self._held(self.api.successor_type(kind.cls, name), kind, name))
            return
        found.types.append(UNKNOWN)

    def _of_button(self, operator: Operator, name: str, found: Lookup) -> None:
        """What a button calls an operator with: one of its keywords."""
        symbol = self.api.symbols.symbol(operator.path)
        parameter = symbol.parameter(name) if symbol else None
        found.use = "keyword"
        if parameter:
            found.symbols.append(f"{operator.path}({name})")
        elif symbol and not _is_pythons(name):
            found.missing.append(operator.path)
        found.types.append(self.api.keyword_type(operator.path, parameter) if parameter else UNKNOWN)

    def is_open(self, cls: str) -> bool:
        """Whether instances of a class have members that its symbols do not tell."""
        symbol = self.api.symbols.symbol(cls)
        if symbol is None or symbol.kind != "class" or symbol.is_of_interface or _half_known(cls):
            return True
        bases = [base for base in OPEN_CLASSES if self.api.descends(cls, base)]
        # What an add-on of Blender's declares (scene.cycles) is all that there is, until scripts declare more.
        is_declared = bases == [_GROUP] and cls != _GROUP and any(self.api.symbols.members(cls))
        return bool(bases) and not is_declared

    @staticmethod
    def is_there_at_times(path: str) -> bool:
        """Whether a name that the base lacks is there in another build, or in another place."""
        owner, _, name = path.rpartition(".")
        return any(fnmatchcase(name, pattern) for pattern in SOMETIMES.get(owner, ()))

    def _held(self, kind: Type, owner: Type, name: str) -> Type:
        """A member's type as it is read from its owner."""
        if isinstance(kind, Function):
            return Function(kind.path, owner)
        if isinstance(kind, Collection):
            return replace(kind, owner=owner)
        return self.api.as_held_by(kind, owner, name)

    def is_registered(self, cls: str, name: str) -> bool:
        """Whether the script gives a property of this name to a class of the API, or may."""
        return self._registered(cls, name) is not None

    def has(self, kind: Type, name: str) -> bool:  # noqa: PLR0911 - one return a type
        """Whether a value surely has an attribute, as long as it is not None, in this Blender."""
        match kind:
            case Instance():
                if not kind.sure or self.here.guessing:
                    return False
                member = self.api.member(kind.cls, name)
                return member is not None and member.symbol.kind != "context"
            case Module():
                is_operators = (
                    kind.path == _TYPES and self.api.symbols.symbol(operator_path(name)) is not None
                )
                return is_operators or self.api.member(kind.path, name) is not None
            case ClassObject():
                member = self.api.member(kind.cls, name)
                return member is not None and isinstance(member.type, Function)
            case Collection():
                return self.api.member(kind.container, name) is not None
            case Union():
                return all(self.has(member, name) for member in kind.members)
            case _:
                return False

    def has_socket(self, kind: Type, name: str) -> bool:
        """Whether a value is the sockets of a node's side, which surely has one of this name."""
        if (
            not isinstance(kind, Collection)
            or not isinstance(owner := kind.owner, Instance)
            or not owner.sure
        ):
            return False
        side = kind.path.rpartition(".")[2]
        if side not in SIDES or has_sockets_of_its_own(owner.cls) or self.here.guessing:
            return False
        subscript = f'{side}["{name}"]'
        return any(subscript in socket.subscripts for socket in self.api.sockets(owner.cls, side))

    def _declared_over(self, symbol: Symbol, cls: str, name: str) -> Type | None:
        """A property that the script gives to a class in the place of an inherited one."""
        if not self.registered or symbol.owner == cls:
            return None
        nearer = takewhile(lambda base: base != symbol.owner, self.api.lineage(cls))
        return next((self.registered[base, name] for base in nearer if (base, name) in self.registered), None)

    def _registered(self, cls: str, name: str) -> Type | None:
        """A property that the script gives to a class of the API."""
        if self.registered:
            for ancestor in self.api.lineage(cls):
                if (found := self.registered.get((ancestor, name))) is not None:
                    return found
            return self.registered.get((ANY, name))
        return None

    def _of_collection(self, kind: Collection, name: str, found: Lookup) -> None:
        own = self.api.member(kind.container, name)
        if own is None or own.symbol.owner == STRUCT:
            # What every struct has, as ``get``, a collection has of its own.
            own = self.api.member(COLLECTION, name) or own
        if own is not None:
            found.symbols.append(own.symbol.path)
            found.types.append(self._held(own.type, kind, name))
            return
        if kind.container == GROUPS and name in _GROUP_METHODS:
            found.types.append(Builtin(name, kind))  # not every Blender documents them
            return
        if not _is_pythons(name):
            found.missing.append(kind.path or kind.container)
        found.types.append(self._held(self.api.successor_type(kind.container, name), kind, name))

    def _of_module(self, kind: Module, name: str, found: Lookup) -> None:
        member = self.api.member(kind.path, name)
        if member is None:
            nested = self.api.symbols.symbol(f"{kind.path}.{name}")
            path = f"{kind.path}.{name}"
            if kind.path == "bpy.types" and (own := self.own_types.get(name)):
                found.types.append(own)
                return
            is_of_tuple = kind.path in STRUCT_SEQUENCES and name in OF_STRUCT_SEQUENCES
            known = nested is not None or name.startswith("_") or path in self.own_operators or is_of_tuple
            if not known and not _half_known(kind.path) and not self.is_there_at_times(path):
                found.missing.append(kind.path)
                found.types.append(self.api.successor_type(kind.path, name))
                return
            found.types.append(UNKNOWN)
            return
        found.symbols.append(member.symbol.path)
        found.types.append(self._of_version(member.symbol.path) or self._held(member.type, kind, name))

    def _of_version(self, path: str) -> Type | None:
        """What Blender tells of its version under a path: its numbers, or texts."""
        if not self.version or not path.startswith(VERSION):
            return None
        if path != VERSION:
            return Plain("str", None, FROM_VERSION)
        return Tuple(tuple(Plain("int", part, FROM_VERSION) for part in self.version))

    def local_module(self, name: str) -> Type:
        """A module of the files that are analysed together, which is read first; UNKNOWN for no such module."""
        if file := self.files.get(name):
            self.read_file(file)
        elif name not in self.folders:
            return UNKNOWN
        return LocalModule(name)

    def _of_local_module(self, kind: LocalModule, name: str, found: Lookup) -> None:
        file = self.files.get(kind.name)
        held = file.module.ever.get(name) if file else None
        found.types.append(held or self.local_module(f"{kind.name}.{name}"))

    def _of_class(self, kind: ClassObject, name: str, found: Lookup) -> None:
        member = self.api.member(kind.cls, name)
        if member is not None:
            found.symbols.append(member.symbol.path)
            found.types.append(
                Function(member.symbol.path, kind) if isinstance(member.type, Function) else UNKNOWN
            )
            return
        found.types.append(self._registered(kind.cls, name) or UNKNOWN)
        if not _is_unlisted(kind.cls, name) and not hasattr(type, name) and not self.is_open(kind.cls):
            found.missing.append(kind.cls)

    def _of_operator(self, kind: Operator, name: str, found: Lookup) -> None:
        found.types.append(Builtin(f"operator.{name}", kind))
        if not self.api.is_operator_method(name):
            found.missing.append(kind.path)

    def _of_local_class(self, kind: LocalClass, name: str, found: Lookup) -> None:
        if own := self.class_attribute(kind.number, name):
            held = self.bound(own[0], kind) if self._is_class_method(own[0]) else own[0]
            found.types.append(self._as_computed(held))
            return
        bases, known = self.api_bases(kind.number)
        self._of_bases([ClassObject(base) for base in bases], name, found, known=known)

    def _is_class_method(self, kind: Type) -> bool:
        return isinstance(kind, LocalFunction) and self.functions[kind.number].is_class_method

    def _of_local_instance(self, kind: LocalInstance, name: str, found: Lookup) -> None:
        if own := self.class_attribute(kind.number, name):
            held = self._as_computed(self.bound(own[0], kind))
            found.types.append(union((held, *self._overriding(kind.number, name, own[0]))))
            return
        bases, known = self.api_bases(kind.number)
        self._of_bases([Instance(base) for base in bases], name, found, known=known)

    def _as_computed(self, held: Type) -> Type:
        """What an attribute holds, where a script may give it something else by a name that it computes."""
        return unsure(held) if any(file.computes_attributes for file in self.sources) else held

    def _overriding(self, number: int, name: str, own: Type) -> Iterator[Type]:
        """What the classes that derive from one have in the place of its attribute."""
        for other in self.derived.get(number, ()):
            found = self.classes[other].attributes.get(name)
            if found is not None and found != own:
                yield self.bound(found, LocalInstance(other))

    def _of_bases(self, bases: list[Type], name: str, found: Lookup, *, known: bool) -> None:
        inner = Lookup()
        for base in bases:
            one = Lookup()
            self._read(base, name, one)
            if one.symbols:
                found.symbols += one.symbols
                found.types += one.types
                return
            inner.missing += one.missing
            inner.types += one.types
        # What a class of the script lacks may be set by whoever makes it: only its API bases are told.
        found.types.append(inner.type if inner.types else UNKNOWN)
        if known and bases and inner.missing:
            found.missing += inner.missing
            found.sure = False

    def _of_value(self, kind: Type, name: str, found: Lookup) -> None:
        if isinstance(kind, Sequence) and kind.kind == "array" and (member := self.api.member(ARRAY, name)):
            found.symbols.append(member.symbol.path)
            found.types.append(self._held(member.type, kind, name))
        elif hasattr(_python_class(kind), name):
            found.types.append(Builtin(name, kind))

    @staticmethod
    def of_python(path: str) -> Type:
        """A module, a function or a class of Python's library by its path, where more is known of it."""
        return Builtin(path) if path in PYTHON_NAMES else UNKNOWN

    def _of_python_module(self, kind: Builtin, name: str, found: Lookup) -> None:
        found.types.append(self.of_python(f"{kind.name}.{name}") if kind.receiver is None else UNKNOWN)

    _attribute_readers: ClassVar[dict[type, Callable[..., None]]] = {
        Instance: _of_instance,
        Collection: _of_collection,
        Module: _of_module,
        LocalModule: _of_local_module,
        ClassObject: _of_class,
        Operator: _of_operator,
        Builtin: _of_python_module,
        LocalClass: _of_local_class,
        LocalInstance: _of_local_instance,
        Plain: _of_value,
        Sequence: _of_value,
        Tuple: _of_value,
        Mapping: _of_value,
    }


def _half_known(path: str) -> bool:
    """Whether a module or class may have more than its symbols tell."""
    return path.partition(".")[0] in HALF_KNOWN


def _is_pythons(name: str) -> bool:
    """Whether everything has an attribute of this name, or may have."""
    return name in {"bl_rna", "rna_type"} or (name.startswith("__") and name.endswith("__"))


def _is_unlisted(cls: str, name: str) -> bool:
    """Whether a class may have an attribute that its symbols do not tell: one for all, or a private one of a module's
    class. RNA has no private ones.
    """
    return _is_pythons(name) or (name.startswith("_") and not cls.startswith(T))


def _python_class(kind: Type) -> type:
    """The class of Python that a value is of."""
    if isinstance(kind, Mapping):
        return dict
    if isinstance(kind, Plain):
        return _PYTHON.get(kind.kind, str)
    if isinstance(kind, Tuple):
        return list  # or a tuple, which has less
    return _ROWS.get(kind.kind, list) if isinstance(kind, Sequence) else list
