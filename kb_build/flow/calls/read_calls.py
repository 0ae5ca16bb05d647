"""A call whose arguments were read."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.flow.values.types import UNKNOWN, Type

if TYPE_CHECKING:
    import ast
    from collections.abc import Mapping, Sequence

    Keywords = Mapping[str, Type]


class ReadCall(NamedTuple):
    """A call, and what it is given: by place, and by name, with "" for what stands behind two stars."""

    node: ast.Call
    arguments: Sequence[Type]
    keywords: Keywords

    def argument(self, place: int) -> Type:
        """What is given at a place; UNKNOWN where nothing is."""
        return self.arguments[place] if place < len(self.arguments) else UNKNOWN
