"""Which of Python's errors Blender raises for what is wrong: a script may be ready for them, or only for others."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.symbols.api_names import OPERATORS
from kb_build.symbols.api_names import TYPES as T

if TYPE_CHECKING:
    from kb_build.flow.values.types import Resolution, ResolutionKind

_MODULE = "bpy.ops"
LACKS = ("AttributeError",)
LACKS_KEY = ("KeyError",)
# A value that is refused; a sequence of the wrong length is a ValueError.
REFUSES = ("TypeError", "ValueError")
REFUSES_ENUM = ("TypeError",)
_BY_KIND: dict[ResolutionKind, tuple[str, ...]] = {
    "attribute": LACKS,
    "store": LACKS,
    "name": ("ImportError", "ModuleNotFoundError"),
    "item": LACKS_KEY,
    "keyword": ("TypeError",),
    "product": REFUSES,
}


def refusing_class(function: str) -> tuple[str, ...]:
    """The errors of a function that does not know a class by its name: nodes are looked up, sockets are listed."""
    return ("RuntimeError",) if function.startswith(f"{T}Nodes.") else REFUSES_ENUM


def raised_by(row: Resolution) -> tuple[str, ...]:
    """The errors that one of what is missing raises, by the names of their classes; none where that is not known."""
    owners = row.missing
    if row.kind == "attribute" and any(owner.startswith(_MODULE) for owner in owners):
        return LACKS_KEY if _asks_for_type(row) else LACKS
    if row.kind == "value":
        return REFUSES_ENUM if all(owner.startswith((T, OPERATORS)) for owner in owners) else ()
    if row.kind == "class":
        return refusing_class(owners[0])
    return _BY_KIND.get(row.kind, ())


def _asks_for_type(row: Resolution) -> bool:
    """Whether an operator is asked for its type, as a dictionary of all would be."""
    return any(
        isinstance(node, ast.Attribute) and node.attr == "get_rna_type"
        for node in walk(row.statement or row.node)
    )
