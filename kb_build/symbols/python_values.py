"""Which of the values that Blender gives are Python's own: texts, numbers, and the lists that the context makes."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.flag_names import ENUM_FLAG

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol

_FIRST_WORD = re.compile(r"\w+")
# The first word of a type, RNA's or Python's → what its values are.
_CLASSES: dict[str, type] = {
    "string": str, "enum": str, "int": int, "float": float, "boolean": bool, "mappingproxy": dict,
    **{kind.__name__: kind for kind in (str, bytes, tuple, list, dict, set, frozenset, bool)},
}  # fmt: skip
_ORDERING = frozenset({"reverse", "sort"})
METHODS = frozenset(
    name for kind in _CLASSES.values() for name in dir(kind) if not name.startswith("_")
)  # of any of them
_CHANGING = frozenset(
    {"add", "append", "clear", "discard", "extend", "insert", "pop", "remove", "reverse", "sort", "update"}
)  # those that change a list or a set


def is_new_list(kind: str, type_: str) -> bool:
    """Whether what has a kind and a type is a list that each reading makes anew: what an editor puts together."""
    return kind == "context" and type_ == "collection"


def on_changing(symbol: Symbol, method: str) -> str:
    """A sentence on a method that changes a list or set which each reading makes anew; empty for any other."""
    is_list = is_new_list(symbol.kind, symbol.type)
    if method not in _CHANGING or not (is_list or (symbol.type == "enum" and ENUM_FLAG in symbol.flags)):
        return ""
    kind = "list" if is_list else "set"
    told = f"Each reading of `{symbol.path}` makes a new {kind}: `{method}` changes that one only."
    if not is_list:
        return f"{told} Assign the whole set."
    if symbol.name.startswith("selected_objects") and method not in _ORDERING:
        return f"{told} Select an object with `select_set(True)`, deselect it with `select_set(False)`."
    return f"{told} Keep it in a variable to change it."


def python_class(symbol: Symbol) -> type | None:
    """The class of Python's own that a property's or constant's value is of; None for any other."""
    if is_new_list(symbol.kind, symbol.type):
        return list
    if symbol.array or symbol.target or symbol.kind not in {"property", "data", "context"}:
        return None
    if symbol.subtype == "BYTE_STRING":
        return bytes
    if symbol.type == "enum" and ENUM_FLAG in symbol.flags:
        return set
    first = _FIRST_WORD.match(symbol.type)
    return _CLASSES.get(first[0]) if first else None
