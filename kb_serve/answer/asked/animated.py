"""How what a question asks for is animated, where it speaks of keyframes or drivers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import terms
from kb_build.symbols.api_names import STRUCT
from kb_build.symbols.flag_names import ANIMATABLE
from kb_build.symbols.lines import written
from kb_build.symbols.paths import last_name
from kb_serve.answer.budget import AnswerBlock

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader

# What a question says → the function that does it, and what it takes besides.
_FUNCTIONS = {"keyfram": ("keyframe_insert", ", frame=1"), "driver": ("driver_add", "")}
_FUNCTIONS_HEAD = f"{STRUCT}."
_LEAST = 1.0  # weight of a property that somebody animates


def animated(
    asked: Sequence[str], ids: Sequence[str], found: Iterable[str], reader: BaseReader
) -> Iterator[AnswerBlock]:
    """The line that animates the first of some symbols which a question names and which can be: a property or a
    socket's value, of a class the property that counts most. Where the first is the function that does it, of what
    was ``found`` as well.
    """
    functions = [call for word, call in _FUNCTIONS.items() if word in asked]
    if len(functions) != 1:
        return
    (function, more), *_ = functions
    for path in (*ids, *(found if ids[0] == _FUNCTIONS_HEAD + function else ())):
        if held := _held(path, frozenset(asked), reader):
            holder, name = held
            yield AnswerBlock(f'animated by `{holder}.{function}("{name}"{more})`', "how it is animated")
            return


def _held(
    path: str, asked: frozenset[str], reader: BaseReader, *, is_class: bool = False
) -> tuple[str, str] | None:
    """(the expression whose function animates a symbol, the name that it takes); None where nothing is."""
    entry = None if reader.manual.is_page(path) or path.startswith(_FUNCTIONS_HEAD) else reader.entry(path)
    if entry is None:
        return None
    if entry.kind == "class":
        if not frozenset(terms(entry.name)) <= asked:
            return None
        own = [one for one in reader.members(path).values() if one.kind == "property"]
        heaviest = reader.usage.heaviest(own, _LEAST)
        return _held(heaviest[0].path, asked, reader, is_class=True) if heaviest else None
    symbol = reader.symbol(path) if entry.kind in {"property", "socket"} else None
    owner = reader.symbol(symbol.owner) if symbol else None
    if symbol is None or owner is None or not owner.reached:
        return None
    if entry.kind == "property" and not is_class and not asked.issuperset(terms(entry.name)):
        return None
    return _expression(symbol, owner)


def _expression(symbol: Symbol, owner: Symbol) -> tuple[str, str] | None:
    if symbol.kind == "socket":
        return f"{owner.reached}.{written(symbol)[len(symbol.owner) + 1 :]}", "default_value"
    is_chosen = symbol.type == "enum"  # a choice, which is hardly what moves
    is_animated = ANIMATABLE in symbol.flags and not is_chosen
    return (owner.reached, last_name(symbol.path)) if is_animated else None
