"""The settings of a topic: those that the labels on its page stand for, and those that have it as a value."""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbol_lines import written
from kb_serve.answer.budget import clip
from kb_serve.reader import TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_serve.reader import BaseReader, SymbolEntry

_CODE = re.compile(r"`([^`]+)`")
_KINDS = ("property", "socket")
_LINE_TOKENS = 50
_VALUES = 3
_LEAST_SHARE = 0.3  # of the weight of the heaviest setting with a value
_LEAST_WEIGHT = 3.0


class TopicSettings:
    """The settings of one base's topics."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def labelled(self, slug: str) -> list[SymbolEntry]:
        """The properties and sockets that are named beside a page's labels, in its order, each once."""
        nodes = [path for path in self._reader.symbols_of_page(slug) if path.startswith(TYPES)]
        names = [name for text in self._reader.label_names(slug).values() for name in _CODE.findall(text)]
        # A socket stands there without its node, where the page is about one.
        paths = [
            f"{owner}{name}"
            for name in names
            for owner in (TYPES, *(f"{node}." for node in nodes if name.startswith("inputs[")))
        ]
        self._reader.entry.load(paths)
        entries = (self._reader.entry(path) for path in dict.fromkeys(paths))
        return [entry for entry in entries if entry is not None and entry.kind in _KINDS]

    def lines(self, settings: Sequence[SymbolEntry]) -> Iterator[str]:
        """A line for each class of settings, and below it one for each of them, indented."""
        by_owner: dict[str, list[SymbolEntry]] = defaultdict(list)
        for entry in settings:
            by_owner[entry.owner].append(entry)
        for owner, entries in by_owner.items():
            symbol = self._reader.symbol(owner)
            name = owner.removeprefix(TYPES)
            yield f"on `{symbol.reached}` (`{name}`):" if symbol and symbol.reached else f"of `{name}`:"
            yield from (f"  {clip(entry.line, _LINE_TOKENS)}" for entry in entries)

    def as_value(self, text: str) -> Iterator[str]:
        """The calls, then the assignments with the value that a text names, heaviest first: ``light.type = 'SUN'``."""
        owners = {owner: value for owner, value, _ in self._reader.enum_owners(key(text))}
        weights = self._reader.weights([owner.partition("(")[0] for owner in owners])
        heavy = {owner: weights.get(owner.partition("(")[0], 0.0) for owner in owners}
        least = max(_LEAST_WEIGHT, _LEAST_SHARE * max(heavy.values(), default=0.0))
        written = [
            line
            for owner in sorted(owners, key=lambda owner: ("(" not in owner, -heavy[owner]))
            if heavy[owner] >= least and (line := self._written(owner, owners[owner]))
        ]
        yield from written[:_VALUES]

    def _written(self, owner: str, value: str) -> str:
        """A value where it is given; empty where it cannot be set."""
        path, _, parameter = owner.partition("(")
        if parameter:
            return f"`{path.removeprefix(TYPES)}({parameter.removesuffix(')')}={value!r})`"
        entry = self._reader.entry(path)
        if entry is None or entry.is_read_only:
            return ""
        holder = self._reader.symbol(entry.owner)
        reached = holder.reached if holder and holder.reached else entry.owner.removeprefix(TYPES)
        symbol = self._reader.symbol(path) if entry.kind == "socket" else None
        subscript = (written(symbol) if symbol else path)[len(entry.owner) + 1 :]
        subscript += ".default_value" if symbol else ""
        return f"`{reached}.{subscript} = {value!r}`"
