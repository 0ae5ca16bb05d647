"""Explains what is set on the properties of an operator, ``layout.operator("object.select_all").action``, and is no
argument of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS
from kb_serve.recognise.code.wrong_arguments import unknown_keywords

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbolLookup

_NAMED = 0.98  # how sure an operator is whose properties are asked for


def explain_properties(
    chains: Iterable[Chain], recognition: Recognition, removed: RemovedSymbolLookup, reader: BaseReader
) -> None:
    """Adds, in place of each name that an operator lacks, what became of that argument, or which is meant."""
    if not any(missing.owner.startswith(OPERATORS) for missing in recognition.missing):
        return
    values = {
        chain.attributes[-1]: repr(chain.values[0]) for chain in chains if chain.attributes and chain.values
    }
    left = []
    for missing in recognition.missing:
        symbol = reader.symbol(missing.owner) if missing.owner.startswith(OPERATORS) else None
        if symbol is None or symbol.kind != "operator":
            left.append(missing)
            continue
        recognition.add(symbol.path, _NAMED, "expression")
        if lost := removed.of_part(symbol.path, f"({missing.name})"):
            recognition.add_removed(lost)
        else:
            recognition.notes += unknown_keywords(
                symbol, {missing.name: values.get(missing.name, "")}, reader
            )
    recognition.missing = left
