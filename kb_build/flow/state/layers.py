"""What a second reading of the same code finds, kept apart from what the first one found."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar, overload

if TYPE_CHECKING:
    import ast
    from collections.abc import Mapping

    from kb_build.flow.values.types import Type

_Default = TypeVar("_Default")


class TypesAbove(dict["ast.expr", "Type"]):
    """The types of one reading. ``get`` knows those of the reading below as well; only its own are in it."""

    def __init__(self, below: Mapping[ast.expr, Type]) -> None:
        super().__init__()
        self.below = below

    @overload
    def get(self, key: ast.expr, default: None = None, /) -> Type | None: ...

    @overload
    def get(self, key: ast.expr, default: Type, /) -> Type: ...

    @overload
    def get(self, key: ast.expr, default: _Default, /) -> Type | _Default: ...

    def get(self, key: ast.expr, default: object = None, /) -> object:
        """The type of an expression in this reading, or else in the one below."""
        return self[key] if key in self else self.below.get(key, default)
