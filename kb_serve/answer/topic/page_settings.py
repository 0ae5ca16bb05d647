"""The settings of a topic: those that the labels on its page stand for, and those that have it as a value."""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.lines import held, written
from kb_build.symbols.paths import argument_of, last_name, plain_path
from kb_serve.answer.budget import clip
from kb_serve.answer.steps.scene.new_scene import NewScene
from kb_serve.answer.steps.setting.choices import choice_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

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
        nodes = [path for path in self._reader.manual.symbols_of_page(slug) if path.startswith(TYPES)]
        names = [
            name for text in self._reader.manual.label_names(slug).values() for name in _CODE.findall(text)
        ]
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
            reached = symbol.reached if symbol else ""
            choice = choice_of(reached, self._reader) if reached else None
            after = f", after `{choice.code}`" if choice else ""
            yield f"on `{reached}` (`{name}`){after}:" if reached else f"of `{name}`:"
            yield from (f"  {clip(entry.line, _LINE_TOKENS)}" for entry in entries)

    def as_value(self, text: str, slug: str) -> Iterator[str]:
        """The calls, then the assignments with the value that a page's title names, heaviest first, of what the part of
        the manual explains that the page is in: ``light.type = 'SUN'``.
        """
        owners = {owner: value for owner, value, _ in self._reader.names.enum_owners(key(text))}
        weights = self._reader.usage.weights([plain_path(owner) for owner in owners])
        heavy = {owner: weights.get(plain_path(owner), 0.0) for owner in owners}
        near = {_name(owner) for owner in owners if self._is_near(owner, slug)}
        owners = {owner: value for owner, value in owners.items() if _name(owner) in near}
        least = max(_LEAST_WEIGHT, _LEAST_SHARE * max(map(heavy.__getitem__, owners), default=0.0))
        written = [
            line
            for owner in sorted(owners, key=lambda owner: ("(" not in owner, -heavy[owner]))
            if heavy[owner] >= least and (line := self._written(owner, owners[owner]))
        ]
        yield from written[:_VALUES]

    def _is_near(self, owner: str, slug: str) -> bool:
        """Whether the part of the manual that a page is in explains what has a value."""
        path = plain_path(owner)
        links = self._reader.manual.manual_links(path) or self._reader.manual.manual_links(
            path.rpartition(".")[0]
        )
        return slug.partition("/")[0] in {link.partition("/")[0] for link in links}

    def _written(self, owner: str, value: str) -> str:
        """A value where it is given; empty where it cannot be set."""
        path, parameter = plain_path(owner), argument_of(owner)
        if parameter:
            return f"`{path.removeprefix(TYPES)}({parameter}={value!r})`"
        entry = self._reader.entry(path)
        if entry is None or entry.is_read_only:
            return ""
        holder = self._reader.symbol(entry.owner)
        reached = holder.reached if holder and holder.reached else entry.owner.removeprefix(TYPES)
        ready = NewScene(self._reader).pointers.reach(held(reached)) if holder and holder.reached else None
        first = "; ".join(ready.steps) if ready else ""
        if ready and first:
            reached = ready.expression
        symbol = self._reader.symbol(path) if entry.kind == "socket" else None
        subscript = (written(symbol) if symbol else path)[len(entry.owner) + 1 :]
        subscript += ".default_value" if symbol else ""
        return f"{first}{', then ' if first else ''}`{reached}.{subscript} = {value!r}`"


def _name(owner: str) -> str:
    """The property's or the argument's name of what has a value."""
    return argument_of(owner) or last_name(owner)
