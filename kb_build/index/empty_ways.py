"""What on the way to instances of a class is None, or an empty collection, on new things, or only read by a loop."""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import NARROWER
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import (
    EMPTY,
    EMPTY_AT_START,
    ITERATED,
    NONE_ON_SOME,
    WITHOUT_AREA,
    WITHOUT_SHOWN,
)
from kb_build.symbols.flags import empty_when_new
from kb_build.symbols.lineages import lineage

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kb_build.symbols.records import Symbol

_WAY = re.compile(r"(?P<before>.+)\.(?P<name>\w+)(?P<key>\[[^\]]+\])?")
_FIRST = (None, "[0]")  # of a collection whose elements have no names; who asks for a name has made it
_EMPTY = frozenset({EMPTY, EMPTY_AT_START, NONE_ON_SOME})
_CONTEXT = "bpy.context"
_ABSENT = frozenset(
    {WITHOUT_AREA, WITHOUT_SHOWN}
)  # of members of the context that scripts hardly find filled
_FAR = 3  # dots of what leads through another pointer than those to what is always there: ``bpy.context.scene.world``


class EmptyWays:
    """The ways to classes; ``reached`` is the path of a class → the expression that leads to an instance."""

    def __init__(self, symbols: Iterable[Symbol], reached: Mapping[str, str]) -> None:
        self._reached = {path.removeprefix(TYPES): expression for path, expression in reached.items()}
        self._bases: dict[str, str] = {}
        self._below: dict[str, list[str]] = defaultdict(list)
        # (name, class that it leads to, or of the collection itself) → properties
        self._leading: dict[tuple[str, str], list[Symbol]] = defaultdict(list)
        self._holding: dict[tuple[str, str], list[Symbol]] = defaultdict(list)
        # name of a member of the context that is None for most scripts → its path
        self._absent: dict[str, str] = {}
        # class → the property whose elements of that class only a loop gives
        self._looped: dict[str, str] = {}
        for symbol in symbols:
            if symbol.kind == "class" and symbol.base:
                name, base = (path.removeprefix(TYPES) for path in (symbol.path, symbol.base))
                self._bases[name] = base
                self._below[base].append(name)
            elif symbol.kind == "property" and symbol.target:
                target = NARROWER.get(symbol.path, symbol.target)
                self._leading[symbol.name, target].append(symbol)
                if ITERATED in symbol.flags:
                    self._looped[target] = symbol.path
                if symbol.collection:
                    self._holding[symbol.name, symbol.collection].append(symbol)
            elif symbol.kind == "context" and not _ABSENT.isdisjoint(symbol.flags):
                self._absent[symbol.name] = symbol.path

    def last_empty(self, cls: str) -> str:
        """The path of the last pointer on the way to a class, given by its name, that is None on a new thing, or of the
        collection whose first or active element is taken and that is empty there, or whose elements a loop alone gives;
        empty for none.
        """
        way = _WAY.fullmatch(self._reached.get(cls, ""))
        if way is None:
            return self._looped.get(cls, "")
        before, name, key = way.groups()
        if before == _CONTEXT and name in self._absent:
            return self._absent[name]
        is_far = before.count(".") >= _FAR
        if key not in _FIRST and not is_far:
            return ""
        steps = [step for base in lineage(cls, self._bases) for step in self._leading.get((name, base), ())]
        for step in steps:
            owner = step.owner.removeprefix(TYPES)
            if self._reached.get(owner) == before:
                is_empty = key in _FIRST and (empty_when_new(step) or not _EMPTY.isdisjoint(step.flags))
                return step.path if is_empty else self._empty_collection(owner) or self.last_empty(owner)
        if is_far and len(steps) == 1:
            below = self._descendants(steps[0].owner.removeprefix(TYPES))
            owner = next((each for each in below if self._reached.get(each) == before), "")
            return self.last_empty(owner) if owner else ""
        return ""

    def _empty_collection(self, cls: str) -> str:
        """The path of the property which has a collection of this class that is empty on a new thing; empty for none:
        ``vertex_groups`` of ``vertex_groups.active``.
        """
        way = _WAY.fullmatch(self._reached.get(cls, ""))
        if way is None:
            return ""
        holding = self._holding.get((way["name"], cls), ())
        owned = (
            each for each in holding if self._reached.get(each.owner.removeprefix(TYPES)) == way["before"]
        )
        return next((each.path for each in owned if EMPTY in each.flags), "")

    def _descendants(self, cls: str) -> Iterator[str]:
        for each in self._below.get(cls, ()):
            yield each
            yield from self._descendants(each)
