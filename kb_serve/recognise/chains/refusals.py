"""Whether a property or socket refuses what an expression is set to, by its type alone, and a function the keywords
and texts that it is called with.
"""

from __future__ import annotations

import ast
import math
from typing import TYPE_CHECKING

from kb_serve.recognise.chains.call_texts import arguments, texts_in
from kb_serve.signatures import places_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Parameter, Symbol
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain

# How many numbers a socket's value has, by its type; and of properties the types that are numbers.
_NUMBERS_OF_SOCKETS = {"value": 1, "int": 1, "boolean": 1, "rgba": 4, "vector": 3, "rotation": 3}
_NUMBERS = frozenset({"float", "int", "boolean"})
_TEXTS = frozenset({"enum", "string"})
_NO_NUMBERS = _TEXTS | {"pointer", "collection"}
_SET = ("property", "socket")


def is_listed(chain: Chain, path: str, reader: BaseReader) -> bool:
    """Whether a symbol lists the very text that a chain is set to."""
    symbol = reader.symbol(path) if chain.values else None
    return symbol is not None and any(item.identifier in chain.values for item in symbol.enum_items)


def refuses(symbol: Symbol, chain: Chain) -> bool:
    """Whether a property or socket can certainly not be set to what a chain is: a truth value to 256, an enumeration
    to another text.
    """
    if not chain.assigned or symbol.kind not in _SET:
        return False
    if chain.values:
        items = {item.identifier for item in symbol.enum_items}
        is_open = symbol.enum_computed or (symbol.type == "enum" and not items)
        return _numbers(symbol) > 0 or bool(
            items and not is_open and symbol.kind == "property" and items.isdisjoint(chain.values)
        )
    return bool(chain.literal) and _refuses_literal(symbol, chain)


def refuses_call(symbol: Symbol, chain: Chain) -> bool:
    """Whether a function has no argument of a name or at a place that it is given, or its enumeration lacks a text."""
    if symbol.kind != "function" or not chain.call:
        return False
    given = keywords(chain)
    taken = {parameter.name for parameter in symbol.parameters}
    if given and taken and not any(name.startswith("*") for name in taken) and not given <= taken:
        return True
    places = places_of(symbol)
    if places and sum(not name for name, _ in arguments(chain.call)) > len(places[0]):
        return True
    return any(
        len(parameter.enum_items) > 1 and value not in {item.identifier for item in parameter.enum_items}
        for parameter, value, _ in given_texts(symbol, chain.call)
    )


def given_texts(symbol: Symbol, call: str) -> Iterator[tuple[Parameter, str, str]]:
    """(argument, text, all that is given) of the texts that a call gives to enumerations."""
    by_name = {parameter.name: parameter for parameter in symbol.parameters}
    places = places_of(symbol) if symbol.kind == "function" else None
    left = iter(places[0] if places else ())
    for name, given in arguments(call):
        parameter = by_name.get(name or next(left, ""))
        if parameter and not parameter.is_open:
            yield from ((parameter, value, given) for value in texts_in(given))


def keywords(chain: Chain) -> set[str]:
    """The names of the arguments of the call that a chain ends with."""
    return {name for name, _ in arguments(chain.call or "") if name}


def _refuses_literal(symbol: Symbol, chain: Chain) -> bool:
    if symbol.kind == "socket" and chain.steps[-1].text != "default_value":
        return False  # another property of the socket
    try:
        value = ast.literal_eval(chain.literal)
    except SyntaxError:  # 007 is no number of Python's
        return False
    numbers = _numbers(symbol)
    if numbers == 0 or value is None:
        return numbers > 0 or symbol.type in (_TEXTS if value is None else _NO_NUMBERS)
    if isinstance(value, tuple):
        # Vectors of sockets have two to four numbers, matrices rows.
        is_open = (symbol.kind == "socket" and numbers > 1) or len(symbol.array) > 1
        return not is_open and chain.literal.rstrip(", )").count(",") + 1 != numbers
    is_wrong_truth = symbol.type == "boolean" and value not in {0, 1}
    return numbers > 1 or is_wrong_truth or (symbol.type == "int" and isinstance(value, float))


def _numbers(symbol: Symbol) -> int:
    """How many numbers, or truth values, are set; 0 for anything else."""
    if symbol.kind == "socket":
        return _NUMBERS_OF_SOCKETS.get(symbol.type, 0)
    return math.prod(symbol.array) if symbol.type in _NUMBERS else 0
