"""Recognises which property wants so many items as a message says that were not given."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_serve.recognise.chains.chains import find_chains

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_MESSAGE = re.compile(
    r"sequences of dimension 0 should contain (?P<wanted>\d{1,4}) items, not (?P<given>\d+)"
)
_SURE = 0.99  # of what alone wants so many, whatever the code's variables are like
_LIKELY = 0.9  # … of what scripts set most that wants so many
_FEW = 3
# Number → what scripts set that wants so many, where nothing tells what was set.
_USUAL = {
    3: (f"{TYPES}Object.location", f"{TYPES}Light.color"),
    4: (f"{TYPES}NodeSocketColor.default_value", f"{TYPES}Material.diffuse_color"),
}
_COLOUR = (
    "The value has another number of items than the property: a colour with alpha has 4, one without 3; a place has 3, "
    "but a point of a poly or NURBS spline 4, `(x, y, z, 1)`."
)


class ItemCounts:
    """Finds in one base the properties that want a number of items."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def explain(self, query: str, recognition: Recognition) -> None:
        """Adds the property that the code beside the message sets, by its name and the number that it wants."""
        match = _MESSAGE.search(query)
        if match is None:
            return
        wanted = (int(match["wanted"]),)
        names = {chain.steps[-1].text for chain in find_chains(query) if chain.steps}
        paths = [
            entry.path
            for name in names
            for entry in self._reader.names.by_name(name)
            if entry.kind == "property"
        ]
        wanting = [path for path in paths if (one := self._reader.symbol(path)) and one.array == wanted]
        named = [match.id for match in recognition.matches if match.id in wanting]
        told = named[:1] or wanting
        if not 0 < len(told) <= _FEW:
            recognition.notes.append(_COLOUR)
            for rank, path in enumerate(_USUAL.get(wanted[0], ())):
                recognition.add(path, _LIKELY - 0.01 * rank, "error message")
            return
        listed = " or ".join(f"`{path}`" for path in told)
        recognition.notes.append(f"{listed} takes {match['wanted']} numbers, not {match['given']}.")
        for rank, path in enumerate(told):
            recognition.add(path, _SURE - 0.01 * rank, "error message")
