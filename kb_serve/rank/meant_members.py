"""Finds by the search what is meant by a name that a class lacks: ``Light.intensity`` is ``PointLight.energy``.

Who invents a name mostly says in other words what the class has; the phrases that things are asked for by have them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import stem, stems_of, words
from kb_build.symbols.api_names import ID, STRUCT
from kb_build.symbols.paths import last_name, split_path
from kb_serve.recognise.likely.corrections import are_opposite, is_misspelling
from kb_serve.recognise.likely.likely_keywords import EMPTY_WORDS

if TYPE_CHECKING:
    from collections.abc import Iterator, Set

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.rank.search import Searcher
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import MissingName

_MOST = 3
_SHORTEST = 2  # letters of a name that says something
_MOST_CASES = 8  # a class with more below it has a member of any name in one of them
_NEAR = 0.6  # share of the best member's score below which another one is not meant
_LEAST = 0.4  # share of the best score of all below which none is
_CLEAR = 0.7  # … from which on the best member is clearly meant
_OTHER_KIND = 0.6  # what a function counts that is assigned to, or a property that is called
_UNCALLED = 0.85  # … and a function of which nothing is known but its name
_SHARED = 0.5  # what it adds that a member has the words of a name
_LABEL_ENDS = 0.5  # … of which so much if only its label ends with one of them
_OF_ALL = 1 / 2  # the share of these words from which on what everything has is meant
_FUNCTIONS = frozenset({"function", "operator"})


class MeantMembers(NamedTuple):
    """The paths of the few members that a name may mean, best first, and whether the first is clearly meant."""

    paths: tuple[str, ...] = ()
    clear: bool = False


def meant_members(missing: MissingName, searcher: Searcher, reader: BaseReader) -> MeantMembers:
    """The members of a class, of its bases and of its cases that a name may mean which it lacks; none for a name that
    says nothing, or that misspells one of them.
    """
    owner, name = missing.owner, missing.name
    names = reader.member_names(owner)
    if len(name) < _SHORTEST or f"active_{name}" in names or any(is_misspelling(name, one) for one in names):
        return MeantMembers()
    owners = frozenset(_owners(owner, reader))
    said = stems_of(name) - EMPTY_WORDS
    found: dict[str, float] = {}
    scored: dict[str, float] = {}
    # Of an object's data no more may be known than that it is a data-block.
    cls = "object data" if owner == ID else last_name(owner)
    for ref, score in searcher.found(f"{cls} {name}"):
        found.setdefault(ref, score)
        entry = reader.entry(ref) if split_path(ref)[0] in owners else None
        if entry is not None and not are_opposite(name, entry.name):
            fit = _fit_of_kind(entry, missing)
            shared = _shared(said, entry)
            if entry.owner != STRUCT or shared >= _OF_ALL:
                scored[ref] = score * fit * (1 + _SHARED * shared)
    ranked = sorted(scored, key=lambda ref: -scored[ref])[:_MOST]
    best = max(found.values(), default=0.0)
    least = max(_LEAST * best, _NEAR * max(scored.values(), default=0.0))
    paths = tuple(ref for ref in ranked if scored[ref] >= least)
    return MeantMembers(paths, bool(paths) and found[paths[0]] >= _CLEAR * best)


def _fit_of_kind(entry: SymbolEntry, missing: MissingName) -> float:
    """How well a member's kind fits what is done with the name."""
    if entry.kind in _FUNCTIONS:
        return 1.0 if missing.called else _OTHER_KIND if missing.assigned else _UNCALLED
    return _OTHER_KIND if missing.called else 1.0


def _shared(said: Set[str], entry: SymbolEntry) -> float:
    """The share of the words of a name and of a member's that both have; a label says what it ends with."""
    own = stems_of(entry.name) - EMPTY_WORDS
    label = words(entry.label)
    by_label = _LABEL_ENDS if label and stem(label[-1]) in said else 0.0
    return max(len(said & own) / max(1, len(said | own)), by_label)


def _owners(owner: str, reader: BaseReader) -> Iterator[str]:
    """What has members that are meant of a class: itself, its bases, and its few cases."""
    yield owner
    for data in reader.object_data.values() if owner == ID else ():
        yield data
        yield from (entry.path for entry in reader.descendants(data))
    yield from (entry.path for entry in reader.lineage(owner))
    cases = [entry.path for entry in reader.descendants(owner)]
    yield from cases if len(cases) <= _MOST_CASES else ()
