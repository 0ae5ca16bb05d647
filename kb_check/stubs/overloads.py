"""Functions whose result a literal decides: ``modifiers.new("x", 'CLOTH')`` gives a ClothModifier."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import NODE
from kb_build.symbols.api_names import TYPES as T
from kb_check.stubs.enums import values_of
from kb_check.stubs.names import is_writable

if TYPE_CHECKING:
    from kb_build.symbols.records import Parameter, Symbol
    from kb_check.stubs.annotations import Annotations
    from kb_check.stubs.functions import Functions

_DECIDING = ("type", "socket_type", "effect_type")
_BY_CLASS = (NODE, f"{T}NodeTree")
# Families whose members are called after their class unless somebody renames them.
_LABELLED = (NODE, f"{T}Modifier", f"{T}Constraint")


class Overloads:
    """Writes functions with a result for each literal."""

    def __init__(self, annotations: Annotations, functions: Functions) -> None:
        self._annotations = annotations
        self._api = annotations.api
        self._functions = functions

    def define(self, symbol: Symbol, owner: str) -> str:
        """A method's definitions: one for each class that a literal means, and one for all else."""
        found = self._classes(symbol)
        if found is None:
            return self._functions.define(symbol, owner)
        parameter, classes = found
        functions = self._functions
        signature = functions.signature(symbol)
        rows = [
            functions.definition(
                symbol, owner, signature.replaced(parameter.name, f"typing.Literal[{', '.join(map(repr, values))}]"),
                cls, docs=False,
            )
            for cls, values in sorted(classes.items())
        ]  # fmt: skip
        rows.append(functions.definition(symbol, owner, signature, functions.result(symbol, owner)))
        return "\n".join(f"@typing.overload\n{row}" for row in rows)

    def _classes(self, symbol: Symbol) -> tuple[Parameter, dict[str, list[str]]] | None:
        """The parameter that decides, and the values for each class; None if nothing does."""
        if len(symbol.returns) != 1:
            return None
        base = self._api.class_named(symbol.returns[0].type, symbol.path)
        parameter = next((p for p in symbol.parameters if p.name in _DECIDING), None)
        if not base or parameter is None or not self._api.descendants(base):
            return None
        values = values_of(parameter.enum_items)
        if not values:
            # The names of classes: of nodes and trees, or of sockets for what makes their interface.
            of = base if base in _BY_CLASS else f"{T}NodeSocket"
            values = tuple(path.removeprefix(T) for path in self._api.descendants(of))
        found: dict[str, list[str]] = {}
        for value in values:
            cls = self._api.literals.class_of_value(base, value)
            if cls:
                found.setdefault(cls, []).append(value)
        return (parameter, found) if found else None

    def items(self, element: str) -> str:
        """``__getitem__`` of a collection whose items are found by the name of their class; empty where none are."""
        if element not in _LABELLED:
            return ""
        labels: dict[str, list[str]] = {}
        for path in self._api.descendants(element):
            symbol = self._api.symbols.symbol(path)
            if symbol and symbol.group == "data" and not self._api.descendants(path):
                label = symbol.label.removesuffix(" Modifier").removesuffix(" Constraint")
                labels.setdefault(label, []).append(path)
        rows = [
            f"@typing.overload\ndef __getitem__(self, key: typing.Literal[{label!r}], /) -> {paths[0]}: ..."
            for label, paths in sorted(labels.items())
            if len(paths) == 1 and label and is_writable(paths[0].removeprefix(T))
        ]
        every = self._annotations.instance(element)
        rows.append(f"@typing.overload\ndef __getitem__(self, key: int | str, /) -> {every}: ...")
        rows.append(f"@typing.overload\ndef __getitem__(self, key: slice, /) -> list[{every}]: ...")
        return "\n".join(rows)
