"""Since when a version has what it has: what its history says, without what that only seems to say.

A name may be new where what it stands for is not. Of these nothing is said: a member that moved from classes to their
base, the members of a class that was renamed, and operators that a build may lack which Blender of that version has.
"""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING

from kb_build.symbols.unlisted import OPTIONS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_build.symbols.records import Symbol
    from kb_build.versions.history import ApiHistory, Arrival
    from kb_build.versions.successors import Succession

_OPERATOR = re.compile(r"bpy\.ops\.\w+\.([a-z0-9]+)")
_MEMBER = re.compile(r"(bpy\.types\.\w+)\.(\w+)")
_SOCKET = '"]'


def told_arrivals(
    symbols: Sequence[Symbol], history: ApiHistory, version: str, table: Iterable[Succession]
) -> Iterator[tuple[str, str, str]]:
    """The rows of ``since`` (see schema.DDL) for a (minor) version and its symbols. ``table`` says what was renamed."""
    arrivals = {each.path: each for each in history.arrivals(version) if _is_told(each)}
    elsewhere = _Elsewhere(symbols, history, table)
    for symbol in symbols:
        arrival = arrivals.get(symbol.path)
        if arrival and not elsewhere.had(arrival):
            yield arrival.path, arrival.first, "" if arrival.is_sure else arrival.lacked


def _is_told(arrival: Arrival) -> bool:
    # Of what came back "since" would be half the truth; no version between 3.4 and 4.2 is known to have a socket.
    is_known = arrival.is_sure or not arrival.path.endswith(_SOCKET)
    return bool(arrival.lacked) and not arrival.is_return and is_known


class _Elsewhere:
    """Where else older versions had what has a new name, or may have had it."""

    def __init__(self, symbols: Iterable[Symbol], history: ApiHistory, table: Iterable[Succession]) -> None:
        self._history = history
        self._below: defaultdict[str, list[str]] = defaultdict(list)
        # The first words of what Blender can be built without.
        self._options: set[str] = set()
        for symbol in symbols:
            if symbol.kind == "class" and symbol.base:
                self._below[symbol.base].append(symbol.path)
            elif symbol.path.startswith(OPTIONS):
                self._options.add(symbol.path.removeprefix(OPTIONS).partition("_")[0])
        self._former: defaultdict[str, list[str]] = defaultdict(list)
        for row in table:
            for new in row.new:
                self._former[new].append(row.old)

    def had(self, arrival: Arrival) -> bool:
        """Whether a version before may have had what an arrival is the name of."""
        if found := _OPERATOR.match(arrival.path):
            return not arrival.is_sure and found[1] in self._options
        found = _MEMBER.fullmatch(arrival.path)
        if found is None:
            return False
        before = self._history.before(arrival.first)
        classes = (*self._classes_below(found[1]), *self._former.get(found[1], ()))
        return any(self._history.mask(f"{cls}.{found[2]}") & before for cls in classes)

    def _classes_below(self, cls: str) -> Iterator[str]:
        for below in self._below.get(cls, ()):
            yield below
            yield from self._classes_below(below)
