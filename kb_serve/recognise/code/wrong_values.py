"""Says which values in code an enumeration does not take: assigned to a property, or given to a function."""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flags import never_taken
from kb_build.symbols.unlisted import FEWEST_VALUES, MORE_VALUES
from kb_serve.recognise.chains.call_texts import arguments, texts_in
from kb_serve.recognise.chains.refusals import given_texts
from kb_serve.recognise.likely.likely_keywords import likely_parameters
from kb_serve.recognise.likely.likely_values import likely_items

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from kb_build.symbols.records import EnumItem, Parameter, Symbol
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain

NO_VALUE = r" is no(?:t a)? value of "  # how notes say that something is none, as a pattern
NONE_RENAMED: Mapping[str, str] = MappingProxyType({})
_QUOTES = ("'", '"')
_PLAIN = re.compile(r"True|False|-?\d+")
_MOST = 8  # items that are all named
# To which add-ons add, or view layers.
_OPEN = frozenset({f"{TYPES}RenderSettings.engine", f"{TYPES}CompositorNodeCryptomatteV2.layer_name"})


def wrong_values(
    chain: Chain,
    symbol: Symbol,
    removed: Collection[str],
    reader: BaseReader,
    renamed: Mapping[str, str] = NONE_RENAMED,
) -> Iterator[str]:
    """Sentences on what a chain gives that is no item; but on ``removed`` items, given by path. ``renamed`` are what
    took the place of keywords, by name: these may take other values.
    """
    if symbol.kind in {"property", "socket"}:
        for value in chain.values:
            if not symbol.enum_computed and f"{symbol.path}:{value}" not in removed:
                yield from _wrong(symbol.path, value, symbol.enum_items, reader)
    elif chain.call is not None and symbol.kind in {"function", "operator"}:
        for parameter, value, given in given_texts(symbol, chain.call):
            owner = f"{symbol.path}({parameter.name})"
            if parameter.type.startswith("set[") and given[:1] in _QUOTES and value in _names(parameter):
                yield f"`{parameter.name}` of `{symbol.path}` takes a set: `{{{value!r}}}`."
            if f"{owner}:{value}" not in removed:
                yield from _wrong(
                    owner, value, parameter.enum_items, reader, never_taken(symbol, parameter.name)
                )
        for parameter, given in _renamed(symbol, chain.call, renamed):
            for value in texts_in(given) or ([given] if _PLAIN.fullmatch(given) else []):
                yield from _wrong(f"{symbol.path}({parameter.name})", value, parameter.enum_items, reader)


def _renamed(symbol: Symbol, call: str, renamed: Mapping[str, str]) -> Iterator[tuple[Parameter, str]]:
    """(the argument in the place of a keyword that is not taken, what is given to it), where only one may be meant."""
    by_name = {parameter.name: parameter for parameter in symbol.parameters}
    for name, given in arguments(call):
        if not name or name in by_name:
            continue
        meant = [renamed[name]] if name in renamed else likely_parameters(symbol, name, given)
        if len(meant) == 1 and (parameter := by_name.get(meant[0])) and not parameter.is_open:
            yield parameter, given


def _names(parameter: Parameter) -> set[str]:
    return {item.identifier for item in parameter.enum_items}


def _wrong(
    owner: str,
    value: str,
    items: Sequence[EnumItem],
    reader: BaseReader,
    refused: frozenset[str] = frozenset(),
) -> Iterator[str]:
    names = [item.identifier for item in items]
    if len(names) < FEWEST_VALUES or value in names or value in MORE_VALUES.get(owner, ()) or owner in _OPEN:
        return
    if all(reader.entry(TYPES + name) for name in names):  # classes, of which add-ons have some as well
        return
    taken = [item for item in items if item.identifier not in refused and item.is_taken]
    if closest := likely_items(value, taken, reader):
        of_name = {item.identifier: item for item in taken}
        told = f"Closest: {', '.join(_quoted(of_name[name], by_setting=True) for name in closest)}."
    else:
        # What is taken somewhere only stands behind what is taken everywhere.
        taken.sort(key=lambda item: bool(item.where))
        told = f"It takes {', '.join(map(_quoted, taken[:_MOST]))}{' …' if len(taken) > _MOST else ''}."
    written = value if _PLAIN.fullmatch(value) else f"'{value}'"
    yield f"`{written}` is not a value of `{owner}`. {told}"


def _quoted(item: EnumItem, *, by_setting: bool = False) -> str:
    """An item with where it is taken; or only if that is ``by_setting``, which the code can make right."""
    where = item.where if item.where and (item.where.settings or not by_setting) else None
    return f"`'{item.identifier}'`{f' ({where.text})' if where else ''}"
