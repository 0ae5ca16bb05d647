"""What makes instances of a class that is none of RNA's and is not called itself: ``BVHTree.FromObject``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import OF_CLASS, STATIC
from kb_build.symbols.lines import with_article
from kb_build.symbols.paths import last_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader

_MOST = 4
_WITHOUT_INSTANCE = frozenset({OF_CLASS, STATIC})


def told_makers(symbol: Symbol, reader: BaseReader) -> Iterator[str]:
    """What makes an instance of a class, or what a method or property is of, where there is such a call."""
    if symbol.kind == "class":
        if calls := _calls(symbol, reader):
            yield f"made by {calls}"
    elif symbol.kind in {"function", "property"} and _WITHOUT_INSTANCE.isdisjoint(symbol.flags):
        owner = reader.symbol(symbol.owner)
        if calls := _calls(owner, reader) if owner else "":
            name = last_name(symbol.owner)
            yield f"{with_article(name).removesuffix(name)}`{name}` is made by {calls}"


def _calls(cls: Symbol, reader: BaseReader) -> str:
    """The calls that make one, with what they require: the class's own, and its package's; empty for none, or for a
    class that is called itself.
    """
    if cls.kind != "class" or cls.signature or cls.path.startswith(TYPES):
        return ""
    calls = [_call(maker) for maker in _makers(cls, reader)]
    more = f" and {len(calls) - _MOST} more" if len(calls) > _MOST else ""
    return ", ".join(f"`{call}`" for call in calls[:_MOST]) + more


def _makers(cls: Symbol, reader: BaseReader) -> Iterator[Symbol]:
    gives = re.compile(rf"(?:[\w.]+\.)?{cls.name}")
    package = cls.path.partition(".")[0]
    for owner in (cls.path, package):
        for entry in reader.members(owner).values():
            symbol = reader.symbol(entry.path) if entry.kind == "function" else None
            if symbol is None or (owner == cls.path and _WITHOUT_INSTANCE.isdisjoint(symbol.flags)):
                continue
            if any(gives.fullmatch(result.type) for result in symbol.returns):
                yield symbol


def _call(function: Symbol) -> str:
    given = ", ".join(parameter.name for parameter in function.parameters if parameter.required)
    return f"{function.path}({given})"
