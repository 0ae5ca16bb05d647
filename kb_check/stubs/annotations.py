"""Types as the annotations of a stub: of values that are read, and of values that Blender takes.

Names are written in full (``bpy.types.Object``); :func:`names.shorten` fits them to a module.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.blender.api import ARRAY
from kb_build.flow.blender.facts import DERIVED_BY_SCRIPTS, ELEMENT, OPEN_CLASSES
from kb_build.flow.values.types import (
    Collection,
    Instance,
    NoneValue,
    Plain,
    Sequence,
    Tuple,
    Type,
    Union,
)
from kb_build.symbols.api_names import COLLECTION, GROUPS
from kb_build.symbols.api_names import TYPES as T
from kb_check.stubs.enums import Enums, values_of
from kb_check.stubs.python_protocols import GENERIC

if TYPE_CHECKING:
    from kb_build.flow.blender.api import Api
    from kb_build.symbols.records import Parameter, Symbol
    from kb_check.stubs.families import Families

ANY = "typing.Any"
MAYBE_NONE = "bpy._typing.MaybeNone"
ITEMS = "bpy._typing.Items"
FLOATS = "collections.abc.Iterable[float]"

# RNA's names of types, as functions' parameters have them.
RNA_TYPES = {
    "boolean": "bool", "string": "str", "int": "int", "float": "float", "double": "float", "enum": "str",
}  # fmt: skip
_PYTHON = {
    "str": "str", "int": "int", "float": "float", "bool": "bool", "bytes": "bytes", "None": "None",
    "object": "object", "complex": "complex", "type": "type[typing.Any]", "dict": "dict[typing.Any, typing.Any]",
    "list": "list[typing.Any]", "set": "set[typing.Any]", "frozenset": "frozenset[typing.Any]",
    "tuple": "tuple[typing.Any, ...]", "slice": "slice", "ModuleType": "types.ModuleType",
    "Self": "typing_extensions.Self",
    "Callable": "collections.abc.Callable[..., typing.Any]", "Sequence": "collections.abc.Sequence[typing.Any]",
    "Iterable": "collections.abc.Iterable[typing.Any]", "Iterator": "collections.abc.Iterator[typing.Any]",
}  # fmt: skip
_GENERIC = {
    "list": "list", "List": "list", "set": "set", "Set": "set", "frozenset": "frozenset", "dict": "dict",
    "Dict": "dict", "tuple": "tuple", "Tuple": "tuple", "type": "type", "Callable": "collections.abc.Callable",
    "Sequence": "collections.abc.Sequence", "Iterable": "collections.abc.Iterable",
    "Iterator": "collections.abc.Iterator", "Mapping": "collections.abc.Mapping",
    "MutableSequence": "collections.abc.MutableSequence", "Generator": "collections.abc.Generator",
}  # fmt: skip
# Blender's functions loop over what is documented as a list or a sequence.
_LISTS = frozenset({"list", "collections.abc.Sequence", "collections.abc.MutableSequence"})
_ARITY = {
    "dict": 2,
    "collections.abc.Mapping": 2,
    "collections.abc.Generator": 3,
    "collections.abc.Callable": 2,
}
_ROWS = frozenset({"mathutils.Vector", "mathutils.Color"})
_ARRAY = re.compile(r"^(float|int|boolean|bool)((?:\[\d+\])+)$")
_LIST_OF = re.compile(r"^(?:[Ll]ist|[Ss]equence|[Tt]uple) of ([\w.]+)$")
# Enumerations of which functions take or return sets, recognized by values that only they have.
_SETS = (frozenset({"RUNNING_MODAL", "FINISHED", "CANCELLED"}), frozenset({"INFO", "WARNING", "ERROR"}))
_ALWAYS_GIVEN = frozenset({f"{T}Context", f"{T}Event"})
_DEEPEST = 30


class Annotations:
    """The annotations of one Blender's API."""

    def __init__(self, api: Api, enums: Enums, families: Families) -> None:
        self.api = api
        self.enums = enums
        self.families = families

    # What is read.

    def instance(self, cls: str) -> str:
        """An instance of a class of the API. One of many classes that derive from it has the members of all."""
        if not cls or cls == f"{T}AnyType" or not self.api.is_class(cls):
            return ANY
        family = self.families.name(cls)
        if family:
            return f"{family} | {ANY}"
        return f"{cls}[{ANY}]" if cls in GENERIC and "[bpy" in GENERIC[cls] else cls

    def value(self, kind: Type, symbol: Symbol) -> str:  # noqa: PLR0911 - one return a type
        """What reading a property gives."""
        match kind:
            case Instance(cls=cls) if cls == ARRAY:
                element = kind.trait(ELEMENT)
                return f"{ARRAY}[{self.value(element, symbol) if element else ANY}]"
            case Instance():
                return self.instance(kind.cls)
            case Collection():
                return self._collection(kind, self.value(kind.element, symbol))
            case Sequence(kind="set"):
                return f"set[{self.enums.text(symbol.enum_items)}]"
            case Sequence(kind="array"):
                return f"{ARRAY}[{self.value(kind.element, symbol)}]"
            case Sequence():
                return f"list[{self.value(kind.element, symbol)}]"
            case Tuple():
                return f"tuple[{', '.join(self.value(item, symbol) for item in kind.items)}]"
            case Union():
                return " | ".join(dict.fromkeys(self.value(member, symbol) for member in kind.members))
            case NoneValue():
                return "None"
            case Plain(kind="str") if symbol.enum_items and not symbol.enum_computed:
                return self.enums.text(symbol.enum_items)
            case Plain():
                return kind.kind
            case _:
                return ANY

    def _collection(self, kind: Collection, element: str) -> str:
        if not self.api.is_class(kind.container):
            # Not every Blender documents the class of the collections that add-ons register.
            return f"{COLLECTION}[{element}]"
        is_generic = kind.container in {COLLECTION, GROUPS}
        return f"{kind.container}[{element}]" if is_generic else kind.container

    # What is spelled.

    def text(self, text: str, scope: str, *, taken: bool = False) -> str:
        """The type that the text of a record spells, seen from a symbol; ``taken``: as an argument."""
        text = text.removesuffix(", optional").strip()
        if text in RNA_TYPES:
            return RNA_TYPES[text]
        if found := _ARRAY.match(text):
            return self._array(RNA_TYPES.get(found[1], found[1]), found[2].count("["), text, taken=taken)
        if found := _LIST_OF.match(text):
            element = self.text(found[1], scope, taken=taken)
            return f"collections.abc.Iterable[{element}]" if taken else f"list[{element}]"
        try:
            tree = ast.parse(text, mode="eval")
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            return ANY
        return self._read(tree.body, scope, taken, 0)

    @staticmethod
    def _array(scalar: str, dimensions: int, text: str, *, taken: bool) -> str:
        if taken:
            return f"{ITEMS}[" * dimensions + scalar + "]" * dimensions
        if text == "float[3]":
            return "mathutils.Vector"
        if text in {"float[4][4]", "float[3][3]"}:
            return "mathutils.Matrix"
        return ANY  # a tuple, or a class of mathutils: the records do not say which

    def _read(self, node: ast.expr, scope: str, taken: bool, depth: int) -> str:  # noqa: PLR0911 - one return a form
        if depth > _DEEPEST:
            return ANY
        match node:
            case ast.Constant(value=None):
                return "None"
            case ast.Name() | ast.Attribute():
                return self._named(ast.unparse(node), scope, taken)
            case ast.BinOp(op=ast.BitOr()):
                sides = [self._read(side, scope, taken, depth + 1) for side in (node.left, node.right)]
                if taken or depth:
                    return " | ".join(dict.fromkeys(sides))
                # One of several: which one depends on what a type checker cannot see.
                return f"{sides[sides[0] == 'None']} | {MAYBE_NONE}" if "None" in sides else ANY
            case ast.Subscript():
                return self._subscript(node, scope, taken, depth + 1)
            case ast.List():
                return f"[{', '.join(self._read(item, scope, taken, depth + 1) for item in node.elts)}]"
            case ast.Constant(value=value) if value is ...:
                return "..."
            case _:
                return ANY

    def _named(self, name: str, scope: str, taken: bool) -> str:
        last = name.rpartition(".")[2]
        if last in _PYTHON and name in {last, f"collections.abc.{last}", f"typing.{last}", f"types.{last}"}:
            return _PYTHON[last]
        cls = self.api.class_named(name, scope)
        if not taken:
            return self.instance(cls)
        if cls in _ROWS:
            return FLOATS
        return ANY if not cls or cls == f"{T}AnyType" else self._of_any(cls)

    @staticmethod
    def _of_any(path: str) -> str:
        return f"{path}[{ANY}]" if "bpy._typing.T]" in GENERIC.get(path, "") else path

    def _subscript(self, node: ast.Subscript, scope: str, taken: bool, depth: int) -> str:  # noqa: PLR0911
        head = ast.unparse(node.value)
        last = head.rpartition(".")[2]
        inside = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if last == "Literal":
            plain = all(isinstance(item, ast.Constant) for item in inside)
            return f"typing.Literal[{', '.join(map(ast.unparse, inside))}]" if plain else ANY
        parts = [self._read(item, scope, taken, depth) for item in inside]
        if last == "Optional":
            return f"{parts[0]} | {'None' if taken else MAYBE_NONE}"
        if last == "Union":
            return " | ".join(dict.fromkeys(parts))
        if last == "type" and taken:
            return _PYTHON["type"]  # which classes can be registered is told incompletely
        generic = _GENERIC.get(last)
        if generic is None:
            cls = self.api.class_named(head, scope)
            if cls and "Generic" in GENERIC.get(cls, ""):
                return f"{cls}[{parts[0]}]"
            return self._named(head, scope, taken)
        if taken and generic in _LISTS:
            generic = "collections.abc.Iterable"
        is_unclear = generic == "tuple" and "..." in parts and (len(parts) != 2 or parts[1] != "...")
        if is_unclear or len(parts) != _ARITY.get(generic, len(parts)):
            return _PYTHON.get(last, ANY)
        if generic == "collections.abc.Callable" and not (parts[0] == "..." or parts[0].startswith("[")):
            return _PYTHON["Callable"]
        return f"{generic}[{', '.join(parts)}]"

    # Parameters and results.

    def parameter(self, parameter: Parameter, scope: str) -> str:
        """The annotation of a parameter."""
        if parameter.is_open:
            text = "str"
        elif parameter.enum_items:
            text = self.enums.text(parameter.enum_items)
            if isinstance(parameter.default, list) or parameter.type.startswith("set") or _is_set(parameter):
                text = f"set[{text}]"
        else:
            text = self.text(parameter.plain_type, scope, taken=True)
            if self._is_callback(scope) and text.startswith(T):
                text = self.instance(text)
            elif self._may_be_none(parameter, text, scope):
                text += " | None"
        is_none = parameter.default is None and not parameter.required and parameter.type != "string"
        return f"{text} | None" if is_none and text != ANY and not text.endswith("None") else text

    @staticmethod
    def _is_callback(scope: str) -> bool:
        """Whether Blender calls the function itself, as the script wrote it."""
        owner = scope.rpartition(".")[0]
        return owner in DERIVED_BY_SCRIPTS or owner in OPEN_CLASSES

    @staticmethod
    def _may_be_none(parameter: Parameter, text: str, scope: str) -> bool:
        """Whether None can be given for a text, or for a pointer, of which RNA does not tell."""
        if text.startswith(T):
            return not parameter.required or (scope.startswith(T) and text not in _ALWAYS_GIVEN)
        return parameter.takes_none

    def results(self, symbol: Symbol, absent: str) -> str:
        """What a function returns; ``absent`` where the records tell nothing."""
        parts = [self._result(row, symbol) for row in symbol.returns]
        if not parts:
            return absent
        return parts[0] if len(parts) == 1 else f"tuple[{', '.join(parts)}]"

    def _result(self, row: Parameter, symbol: Symbol) -> str:
        if row.enum_items:
            text = self.enums.text(row.enum_items)
            return f"set[{text}]" if _is_set(row) else text
        return self.text(row.type, symbol.path)


def _is_set(row: Parameter) -> bool:
    values = set(values_of(row.enum_items))
    return not isinstance(row.default, str) and any(known <= values for known in _SETS)
