"""Properties as the declarations of a stub.

One that takes what it gives is a variable. Read-only ones are properties without a setter; a vector gives a
``mathutils.Vector`` and takes any row of numbers; a pointer takes None where it may be None.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.flow.blender.api import ARRAY
from kb_build.flow.blender.facts import DERIVED_BY_SCRIPTS, OPEN_CLASSES
from kb_build.flow.values.types import Instance, Sequence
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import NEVER_NONE, READ_ONLY
from kb_build.symbols.records import RNA_TYPES
from kb_check.stubs.annotations import ANY, ITEMS, MAYBE_NONE
from kb_check.stubs.families import OBJECT_DATA_FAMILY
from kb_check.stubs.names import docstring

if TYPE_CHECKING:
    from kb_build.flow.values.types import Type
    from kb_build.symbols.records import Symbol
    from kb_check.stubs.annotations import Annotations

# What a context always has, as a window or none is open, and what Blender gives to whatever it draws or runs.
_NEVER_NONE = frozenset(
    {
        *(
            f"{T}Context.{name}"
            for name in (
                "scene", "view_layer", "window_manager", "preferences", "blend_data", "tool_settings", "collection",
                "layer_collection",
            )
        ),
        *(f"{T}{cls}.layout" for cls in ("Operator", "Panel", "Menu", "Header")),
    }
)  # fmt: skip
_MATH = frozenset({"mathutils.Vector", "mathutils.Color"})
_SIZED = {"mathutils.Euler", "mathutils.Quaternion"}


class Properties:
    """Writes properties."""

    def __init__(self, annotations: Annotations, *, with_docs: bool) -> None:
        self._annotations = annotations
        self._with_docs = with_docs

    def declare(self, symbol: Symbol) -> str:
        """A property's declaration."""
        member = self._annotations.api.member(symbol.owner, symbol.name)
        assert member is not None, symbol.path
        given, taken = self._types(symbol, member.type)
        said = docstring(symbol.label, symbol.description) if self._with_docs else ""
        name = symbol.name
        if self._is_read_only(symbol):
            return _getter(name, given, said)
        if given == taken:
            return f"{name}: {given}" + (f"\n{said}" if said else "")
        setter = f"@{name}.setter\ndef {name}(self, value: {taken}, /) -> None: ..."
        return f"{_getter(name, given, said)}\n{setter}"

    @staticmethod
    def _is_read_only(symbol: Symbol) -> bool:
        # What a script's own class sets when it is defined.
        is_own = symbol.owner in DERIVED_BY_SCRIPTS and symbol.name.startswith("bl_")
        return READ_ONLY in symbol.flags and not is_own

    def _types(self, symbol: Symbol, kind: Type) -> tuple[str, str]:
        """What a property gives, and what it takes."""
        if symbol.path == f"{T}Object.data":
            return f"{OBJECT_DATA_FAMILY} | {ANY}", f"{T}ID | None"
        if symbol.type not in RNA_TYPES:
            return self._spelled(symbol, kind)
        given = self._annotations.value(kind, symbol)
        if isinstance(kind, Instance) and symbol.type == "pointer":
            return self._pointer(symbol, kind.cls, given)
        if symbol.type == "collection" or not symbol.array:
            return given, given
        return given, _array(kind, symbol)

    def _pointer(self, symbol: Symbol, cls: str, given: str) -> tuple[str, str]:
        if given == ANY:
            return ANY, ANY
        if NEVER_NONE in symbol.flags:
            return given, cls
        sure = symbol.path in _NEVER_NONE or "|" in given
        return (given if sure else f"{given} | {MAYBE_NONE}"), f"{cls} | None"

    def _spelled(self, symbol: Symbol, kind: Type) -> tuple[str, str]:
        """What is documented in words, by Python's own classes and by what is found while it runs."""
        given = self._annotations.text(symbol.type, symbol.path) if symbol.type else ANY
        if given == ANY and symbol.kind == "context":
            given = self._annotations.value(kind, symbol)
            return (given, given) if given in {ANY} or "|" in given else (f"{given} | {MAYBE_NONE}", given)
        return given, f"{ITEMS}[float]" if given in _MATH | _SIZED else given


def _getter(name: str, given: str, said: str) -> str:
    return f"@property\ndef {name}(self) -> {given}:" + (f"\n    {said}" if said else " ...")


def _array(kind: Type, symbol: Symbol) -> str:
    """What is taken for an array: rows of numbers, as deep as it is."""
    scalar = {"boolean": "bool", "int": "int"}.get(symbol.type, "float")
    depth = len(symbol.array)
    assert isinstance(kind, (Instance, Sequence)), (symbol.path, ARRAY)
    return f"{ITEMS}[" * depth + scalar + "]" * depth


def open_class_body(cls: str) -> str:
    """What lets a class have whatever a script gave it; empty for the others."""
    if cls not in OPEN_CLASSES:
        return ""
    return (
        "def __getattr__(self, name: str, /) -> typing.Any: ...\n"
        "def __setattr__(self, name: str, value: typing.Any, /) -> None: ..."
    )
