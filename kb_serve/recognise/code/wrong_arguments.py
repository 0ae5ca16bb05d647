"""Finds wrong arguments in calls of operators and functions."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.paths import split_path
from kb_serve.recognise.by_words.set_elsewhere import set_elsewhere
from kb_serve.recognise.chains.call_texts import arguments
from kb_serve.recognise.code.contexts import NO_OVERRIDE, with_context
from kb_serve.recognise.likely.likely_keywords import likely_parameters
from kb_serve.signatures import places_of
from simworlds.counting import counted
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain

_FEW = 4  # arguments that are all named
_WITHOUT_CONTEXTS = (4, 0)  # the version since which operators take no dictionary
_VALUE = re.compile(r"""(["'])[^"']*\1|-?[\d.]+""")  # a text, a number
_NUMBER = re.compile(r"-?(?:\d+\.?\d*|\.\d+)")
# Types of parameters as RNA and as docstrings call them.
_TEXTS, _TRUTHS, _NUMBERS = {"string", "str"}, {"boolean", "bool"}, {"int", "float"}
_FRACTION = re.compile(r"-?(?:\d+\.\d*|\.\d+)")
_EXECUTION_CONTEXT = re.compile(r"(?:INVOKE|EXEC)_\w+")


def unknown_keywords(symbol: Symbol, given: Mapping[str, str], reader: BaseReader) -> Iterator[str]:
    """A sentence for each keyword that is not a parameter of ``symbol``, with the most similar parameters, or where
    else that is set. ``given``: name → what is written for it, or nothing.
    """
    known = [parameter.name for parameter in symbol.parameters]
    for name, value in given.items():
        if name in known or any(other.startswith("*") for other in known):
            continue
        takes = f"takes no `{name}`" if known else "takes no arguments"
        if closest := likely_parameters(symbol, name, value):
            yield f"`{symbol.path}` {takes}; closest: {', '.join(f'`{other}`' for other in closest)}."
        else:
            told = set_elsewhere(symbol, name, reader) or _all_of(known)
            yield f"`{symbol.path}` {takes}. {told}".rstrip()


def _all_of(names: Sequence[str]) -> str:
    """A sentence that names all arguments, where they are few."""
    return f"It takes {', '.join(f'`{name}`' for name in names)}." if 0 < len(names) <= _FEW else ""


def wrong_arguments(
    chain: Chain, symbol: Symbol, reader: BaseReader, removed: Collection[str] = ()
) -> Iterator[str]:
    """Sentences on the wrong arguments of a call, as far as its text shows; but on ``removed`` ones, given by path."""
    is_method = symbol.kind in {"operator", "function"} and not symbol.name.startswith("__")
    if chain.call is None or not is_method:
        return
    text = chain.call
    once = {name for above, mark, name in map(split_path, removed) if mark == "(" and above == symbol.path}
    takes_contexts = version_key(reader.meta.get("minor", "")) < _WITHOUT_CONTEXTS
    of_context = (
        symbol.kind == "operator"
        and not takes_contexts
        and _gives_context(text, once.union(one.name for one in symbol.parameters))
    )
    if of_context and not chain.attributes:
        return  # a function of the script's own that is called as an operator is: ``add_object(self, context)``
    if of_context:
        line = with_context(chain)
        yield f"{NO_OVERRIDE} Write `{line}`." if line else NO_OVERRIDE
    elif symbol.kind == "operator":
        yield from _by_place_to_operator(symbol, text)
    elif chain.attributes:  # what is called by its name alone may be the script's own
        yield from _by_place(symbol, text)
    if symbol.kind == "operator" or symbol.path.startswith("bmesh.ops.") or places_of(symbol) is not None:
        given = {name: written for name, written in arguments(text) if name}
        yield from unknown_keywords(
            symbol, {name: given[name] for name in given if f"{symbol.path}({name})" not in removed}, reader
        )


def _by_place_to_operator(symbol: Symbol, text: str) -> Iterator[str]:
    """Operators take by place an execution context and a truth value alone."""
    given = next((written for name, written in arguments(text) if not name), "")
    if any(one.name == given for one in symbol.parameters):
        yield f"`{symbol.path}` takes its arguments by name only: `{given}={given}`."
    if not _VALUE.fullmatch(given) or _EXECUTION_CONTEXT.fullmatch(given[1:-1]):
        return
    named = [
        one.name for one in symbol.parameters if given[1:-1] in {item.identifier for item in one.enum_items}
    ]
    if (
        given[:1] not in "'\""
    ):  # Blender takes a whole number for whether to push an undo step, and says nothing
        how = f"; `{given}` sets none of them"
    else:
        how = f": `{named[0]}={given}`" if len(named) == 1 else ""
    yield f"`{symbol.path}` takes its arguments by name only{how}."


def _by_place(symbol: Symbol, text: str) -> Iterator[str]:
    """More arguments by place than a function has places for."""
    written = [*arguments(text)]
    given = [argument for name, argument in written if not name]
    if (
        any(argument.startswith(("*", "...", "…")) for argument in given)
        or (places := places_of(symbol)) is None
    ):
        return
    by_place, by_name = places
    whole = {one.name for one in symbol.parameters if one.type == "int"}
    for name, argument in (*zip(by_place, given, strict=False), *written):
        if name in whole and _FRACTION.fullmatch(argument):
            yield f"`{name}` of `{symbol.path}` is a whole number: `{argument}` is refused."
    if len(given) <= len(by_place):
        return
    rest = [name for name in by_name if name not in {name for name, _ in written}]
    fitting = [name for name in rest if _may_be(given[-1], symbol, name)]
    if len(given) == len(by_place) + 1 and rest:
        how = f": `{fitting[0]}={given[-1]}`" if fitting else ""
        names = ", ".join(f"`{name}`" for name in rest)
        yield f"`{symbol.path}` takes {names} by name only{how}."
    else:
        yield f"`{symbol.path}` takes {counted_arguments(len(by_place))} by place: `{symbol.signature}`."


def _may_be(written: str, symbol: Symbol, name: str) -> bool:
    """Whether an argument may be meant by what is written at a place behind the last one: a literal of its type."""
    kind = next((one.type for one in symbol.parameters if one.name == name), "")
    if written[:1] in "'\"":
        return kind in _TEXTS
    if written in {"True", "False"}:
        return kind in _TRUTHS
    return bool(_NUMBER.fullmatch(written)) and kind in _NUMBERS


def counted_arguments(places: int) -> str:
    """So many arguments, in words."""
    return counted(places, "argument") if places else "no arguments"


def _gives_context(arguments: str, parameters: Collection[str]) -> bool:
    """Whether the first argument is a dictionary, or what is read from a variable that is not just the name of a
    parameter.
    """
    first = arguments.strip()
    variable = re.match(r"([a-z_]\w*)(?:\.\w+|\[[^\]]*\])*(?:\.copy\(\))?\s*(?:,|$)", first)
    return bool(re.match(r"\{|dict\(", first)) or (variable is not None and variable[1] not in parameters)
