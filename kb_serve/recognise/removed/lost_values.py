"""Finds what a known name gave or took in other versions: items of enumerations, arguments of functions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.recognise.chains.call_texts import arguments, texts_in

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbol, RemovedSymbolLookup


class LostValues:
    """Finds them against one base."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup) -> None:
        self._reader = reader
        self._removed = removed

    def in_values(self, chain: Chain, symbol: Symbol) -> Iterator[RemovedSymbol]:
        """What this version lost: values that a property is set to or compared with, a call's arguments and theirs."""
        for value in chain.values:
            if removed := self.value(symbol, value):
                yield removed
        if chain.call is not None and symbol.parameters:
            yield from self._arguments(chain.call, symbol)

    def value(self, symbol: Symbol, value: str) -> RemovedSymbol | None:
        """An item that an enumeration lost; where the items may depend on the build only what a source tells of."""
        if not symbol.enum_items or any(item.identifier == value for item in symbol.enum_items):
            return None
        removed = self._removed.of_part(symbol.path, f":{value}")
        if removed is None or removed.successors:
            return removed
        # Of a class that had another name all items are gone, and of an unlisted enumeration those of one build.
        same = removed.path.startswith(symbol.path)
        listed = removed.is_dated(self._reader.history.history_versions)
        return removed if same and listed and not symbol.enum_computed else None

    def _arguments(self, text: str, symbol: Symbol) -> Iterator[RemovedSymbol]:
        parameters = {parameter.name: parameter for parameter in symbol.parameters}
        positions = list(parameters) if symbol.kind == "function" else []
        given = list(arguments(text))
        too_many = sum(not keyword and value != "self" for keyword, value in given) > len(positions)
        for number, (keyword, value) in enumerate(given):
            # ``to_mesh(scene, …)``: called like the parameter that it is meant for.
            named = keyword or (value if too_many and value.isidentifier() else "")
            name = named or (positions[number] if number < len(positions) else "")
            if name not in parameters:
                if named and (removed := self._lost(symbol, named)):
                    yield removed
                continue
            known = {item.identifier for item in parameters[name].enum_items}
            for item in texts_in(value):
                # Of what Blender puts together while it runs, the items are not known.
                if known and item not in known:
                    yield from filter(None, (self._removed.of_part(symbol.path, f"({name}):{item}"),))

    def _lost(self, symbol: Symbol, keyword: str) -> RemovedSymbol | None:
        """A parameter that a function had before; not one that only newer versions have."""
        removed = self._removed.of_part(symbol.path, f"({keyword})")
        known = removed is not None and (
            removed.successors or removed.is_dated(self._reader.history.history_versions)
        )
        return removed if known else None
