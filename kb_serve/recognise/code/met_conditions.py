"""Whether the code of a question meets the condition under which an enumeration takes a value."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flags import usual_default
from kb_build.symbols.paths import last_name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.symbols.taken import Setting, Taken
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain

_WORD = re.compile(r"\w+")


def is_met(owner: str, where: Taken, query: str, chains: Sequence[Chain], reader: BaseReader) -> bool:
    """Whether nothing has to be said of ``where`` a property takes a value: what that depends on is set so by the
    ``chains``, or so from the start; the query names the kind of tree, or does not name what alone does not take it.
    """
    if where.there or where.in_some_modes:
        return False
    if where.places:
        return where.how == "only" and not set(_WORD.findall(query)).isdisjoint(where.places)
    if where.settings and not where.things:
        return any(_agrees(where.how, setting, owner, chains, reader) for setting in where.settings)
    if where.beside:
        return where.how == "not" and _agrees("not", where.beside.mode, owner, chains, reader)
    return where.how == "not" and bool(where.things) and not _names_one(query, where.things)


def _agrees(how: str, setting: Setting, owner: str, chains: Sequence[Chain], reader: BaseReader) -> bool:
    """Whether a setting is as it must be, or is something else than it must ``not`` be, at least at times."""
    name = last_name(setting.name)
    given = {value for chain in chains if chain.attributes[-1:] == (name,) for value in chain.values}
    if not given:
        path = TYPES + setting.name if "." in setting.name else f"{owner.rpartition('.')[0]}.{name}"
        symbol = reader.symbol(path)
        given = {value for value in (usual_default(symbol) if symbol else None,) if isinstance(value, str)}
    given -= dict(setting.also).keys()
    return bool(given - set(setting.values) if how == "not" else given.intersection(setting.values))


def _names_one(query: str, things: Sequence[str]) -> bool:
    """Whether a query has some word of what something is called: ``CompositorNodeOutputFile``, ``empty object``."""
    said = {word.casefold() for word in _WORD.findall(query)}
    return any(not said.isdisjoint(thing.casefold().split()) for thing in things)
