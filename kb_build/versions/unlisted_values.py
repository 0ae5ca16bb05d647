"""Values that functions of Python modules take and their reference does not list: those that a later version lost.

The table of successors tells of them. A reference that leaves some out may leave out others, so none is refused.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS, TYPES
from kb_build.symbols.paths import argument_of, item_of, plain_path
from kb_build.symbols.records import EnumItem
from kb_build.symbols.taken import Taken
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.symbols.records import Parameter, Symbol
    from kb_build.versions.successors import Succession


def with_values_until(symbols: Iterable[Symbol], table: Iterable[Succession], version: str) -> list[Symbol]:
    """The symbols of a version (minor); arguments that list values have those that go later as well, said to be so."""
    later: defaultdict[str, dict[str, EnumItem]] = defaultdict(dict)
    for row in table:
        argument, item = argument_of(row.old), item_of(row.old)
        # RNA lists all that it takes.
        if argument and item and version_key(row.version) > version_key(version):
            path = plain_path(row.old)
            if not path.startswith((TYPES, OPERATORS)):
                later[f"{path}({argument})"][item] = EnumItem(
                    item, where=Taken("before", version=row.version)
                )

    def completed(symbol: Symbol, parameter: Parameter) -> Parameter:
        known = {item.identifier for item in parameter.enum_items}
        more = later.get(f"{symbol.path}({parameter.name})", {}) if known else {}
        added = tuple(item for name, item in more.items() if name not in known)
        return replace(parameter, enum_items=(*parameter.enum_items, *added)) if added else parameter

    functions = {path.partition("(")[0] for path in later}
    return [
        replace(symbol, parameters=tuple(completed(symbol, one) for one in symbol.parameters))
        if symbol.path in functions
        else symbol
        for symbol in symbols
    ]
