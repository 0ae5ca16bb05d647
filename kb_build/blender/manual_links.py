"""Links from symbols to pages of the manual, by Blender's own table of patterns."""

from __future__ import annotations

import fnmatch
import re
from collections import defaultdict
from functools import cache
from typing import TYPE_CHECKING

from kb_build.known_prefixes import KnownPrefixes
from kb_build.symbols.api_names import ID, TYPES
from kb_build.symbols.lineages import lineage
from kb_build.symbols.records import Link

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_build.symbols.records import Symbol

_INDEXABLE = re.compile(r"[\[*?]")
_FAR = 4  # pointers that lead from a data-block to what belongs to it


def manual_links(symbols: Sequence[Symbol], table: Sequence[tuple[str, str]]) -> Iterator[Link]:
    """Applies Blender's table (fnmatch pattern over lower-case ids → page) to every symbol; first match wins.

    Left out is what the pattern for a data-block takes by the letters of its name alone, as ``Key*`` does KeyingSet.
    """
    # Nearly all patterns are a name with a star after it: only the others need regular expressions.
    starred: dict[str, int] = {}
    others: dict[str, list[int]] = defaultdict(list)
    for rank, (pattern, _) in enumerate(table):
        lowered = pattern.lower()
        prefix = _INDEXABLE.split(lowered, maxsplit=1)[0]
        if lowered == f"{prefix}*":
            starred.setdefault(prefix, rank)
        else:
            others[prefix].append(rank)

    @cache
    def matcher(rank: int) -> re.Pattern[str]:
        return re.compile(fnmatch.translate(table[rank][0].lower()))

    known = KnownPrefixes((*starred, *others))
    namesakes = _namesakes(symbols, starred.keys())
    for symbol in symbols:
        if not symbol.path.startswith("bpy.") or symbol.kind == "socket":
            continue
        path = symbol.path.lower()
        own = namesakes.get(".".join(symbol.path.split(".")[:3]), ())
        prefixes = [prefix for prefix in known.of(path) if prefix not in own]
        first = min((starred[prefix] for prefix in prefixes if prefix in starred), default=len(table))
        for prefix in prefixes:
            for rank in others.get(prefix, ()):
                if rank >= first:
                    break
                if matcher(rank).match(path):
                    first = rank
        if first < len(table):
            page = table[first][1]
            yield Link(symbol.path, page.removesuffix(".html").replace(".html#", "#"), "manual")


def _namesakes(symbols: Sequence[Symbol], prefixes: Iterable[str]) -> dict[str, set[str]]:
    """Class → the prefixes, names of data-blocks, that its name begins with though it does not belong to these."""
    bases = {symbol.path: symbol.base for symbol in symbols if symbol.kind == "class"}
    blocks = {path.lower(): path for path in bases if ID in lineage(path, bases)}
    leading = _leading(symbols, bases)
    pointed_at = {target for targets in leading.values() for target in targets}
    found: dict[str, set[str]] = defaultdict(set)
    for prefix in prefixes:
        if (block := blocks.get(prefix)) and block != ID:
            belonging = _reached(block, leading, blocks.values())
            for path in bases:
                rest = path[len(block) :]
                if not path.startswith(block) or not rest or block in lineage(path, bases):
                    continue
                is_cut = rest[0].islower() and (rest != "s" or ID in lineage(path, bases))
                is_of_others = not rest.startswith("_") and path in pointed_at and path not in belonging
                if is_cut or is_of_others:
                    found[path].add(prefix)
    return found


def _leading(symbols: Iterable[Symbol], bases: Mapping[str, str]) -> dict[str, set[str]]:
    """Class → the classes of what its pointers and collections have, and of those that inherit from them."""
    below: dict[str, set[str]] = defaultdict(set)
    for path in bases:
        for base in lineage(path, bases):
            below[base].add(path)
    found: dict[str, set[str]] = defaultdict(set)
    for symbol in symbols:
        if symbol.kind == "property":
            for target in (symbol.target, symbol.collection):
                if target:
                    found[symbol.owner] |= below.get(TYPES + target, {TYPES + target})
    return found


def _reached(block: str, leading: Mapping[str, set[str]], blocks: Iterable[str]) -> set[str]:
    """The classes of what belongs to a data-block, as far as a few pointers lead; not through other data-blocks."""
    found, last = {block}, {block}
    for _ in range(_FAR):
        last = {target for path in last for target in leading.get(path, ())}.difference(found, blocks)
        found |= last
    return found
