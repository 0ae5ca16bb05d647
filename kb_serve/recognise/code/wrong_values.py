"""Says which values in code an enumeration does not take: assigned to a property, or given to a function."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flags import never_taken
from kb_build.symbols.unlisted import FEWEST_VALUES, MORE_VALUES
from kb_serve.recognise.code.wrong_arguments import places_of
from kb_serve.recognise.names.likely_values import likely_items
from kb_serve.recognise.resolving.call_texts import arguments, texts_in

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from kb_build.symbols.records import EnumItem, Parameter, Symbol
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.resolving.chains import Chain

NO_VALUE = r" is no(?:t a)? value of "  # how notes say that something is none, as a pattern
_QUOTES = ("'", '"')
_MOST = 8  # items that are all named
# To which add-ons add, or view layers.
_OPEN = frozenset({f"{TYPES}RenderSettings.engine", f"{TYPES}CompositorNodeCryptomatteV2.layer_name"})


def wrong_values(chain: Chain, symbol: Symbol, removed: Collection[str], reader: BaseReader) -> Iterator[str]:
    """Sentences on what a chain gives that is no item; but on ``removed`` items, given by path."""
    if symbol.kind in {"property", "socket"}:
        for value in chain.values:
            if not symbol.enum_computed and f"{symbol.path}:{value}" not in removed:
                yield from _wrong(symbol.path, value, symbol.enum_items, reader)
    elif chain.call is not None and symbol.kind in {"function", "operator"}:
        for parameter, value, given in _given(symbol, chain.call):
            owner = f"{symbol.path}({parameter.name})"
            if parameter.type.startswith("set[") and given[:1] in _QUOTES and value in _names(parameter):
                yield f"`{parameter.name}` of `{symbol.path}` takes a set: `{{{value!r}}}`."
            if f"{owner}:{value}" not in removed:
                yield from _wrong(
                    owner, value, parameter.enum_items, reader, never_taken(symbol, parameter.name)
                )


def _names(parameter: Parameter) -> set[str]:
    return {item.identifier for item in parameter.enum_items}


def _given(symbol: Symbol, text: str) -> Iterator[tuple[Parameter, str, str]]:
    """(argument, text, all that is given) of the texts that a call gives to enumerations."""
    by_name = {parameter.name: parameter for parameter in symbol.parameters}
    places = places_of(symbol) if symbol.kind == "function" else None
    left = iter(places[0] if places else ())
    for name, given in arguments(text):
        parameter = by_name.get(name or next(left, ""))
        if parameter and not parameter.is_open:
            yield from ((parameter, value, given) for value in texts_in(given))


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
    yield f"`'{value}'` is not a value of `{owner}`. {told}"


def _quoted(item: EnumItem, *, by_setting: bool = False) -> str:
    """An item with where it is taken; or only if that is ``by_setting``, which the code can make right."""
    where = item.where if item.where and (item.where.settings or not by_setting) else None
    return f"`'{item.identifier}'`{f' ({where.text})' if where else ''}"
