"""Names of the API in its own descriptions that lead nowhere, as a function of another module is called a method."""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.paths import last_name

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kb_build.symbols.records import Symbol

_NAMED = re.compile(rf"(?<=`){re.escape(TYPES)}\w+\.\w+(?=`)")


def with_true_references(symbols: Mapping[str, Symbol]) -> dict[str, Symbol]:
    """The same symbols, with members that no class has replaced by the only symbol of that name in descriptions."""
    lost = {
        name
        for symbol in symbols.values()
        if f"`{TYPES}" in symbol.description
        for name in _NAMED.findall(symbol.description)
        if name not in symbols
    }
    homes: dict[str, list[str]] = defaultdict(list)
    for path in symbols if lost else ():
        homes[last_name(path)].append(path)
    meant = {name: paths[0] for name in lost if len(paths := homes[last_name(name)]) == 1}
    return {
        path: replace(symbol, description=_NAMED.sub(lambda m: meant.get(m[0], m[0]), symbol.description))
        if any(name in symbol.description for name in meant)
        else symbol
        for path, symbol in symbols.items()
    }
