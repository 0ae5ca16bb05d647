"""Words what it is whose value a method of Python's own is read of: ``bpy.app.version_string.split``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.python_values import on_changing, python_class

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader

_OTHERS = (list, dict, set, tuple, int, float)
_OF_TEXTS_ALONE = frozenset(dir(str)).difference(*map(dir, _OTHERS))


def note_on_method(symbol: Symbol, method: str) -> str:
    """A sentence on a method that is read of what a property or constant holds; empty where nothing is known of it."""
    if told := on_changing(symbol, method):
        return told
    kind = python_class(symbol)
    if kind is None or re.match(rf"{kind.__name__}\b", symbol.type):  # the answer names the type itself
        return ""
    return f"`{symbol.path}` is a Python `{kind.__name__}`, which has `{method}`."


def is_method_of_python(name: str, symbol: Symbol) -> bool:
    """Whether the last name of an expression that leads to a symbol is a method of Python's own, not the symbol's."""
    return name != symbol.name and symbol.kind != "function" and hasattr(python_class(symbol), name)


def is_of_texts(name: str, reader: BaseReader) -> bool:
    """Whether a name is a method of Python's texts and of nothing else, Blender's things among it: ``upper``."""
    return name in _OF_TEXTS_ALONE and not any(
        entry.kind == "function" for entry in reader.names.by_name(name)
    )
