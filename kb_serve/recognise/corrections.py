"""Corrections of names that do not exist, and symbols that only other versions have."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, words
from kb_serve.reader import TYPES, BaseReader
from kb_serve.recognise.chains import Chain, ChainStep

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kb_serve.recognise.resolver import ResolvedChain, Resolver

LIKELY = 0.72  # similarity from which on a name is offered as a correction
_CONTAINED = 0.8  # for a name whose words are all in the other one: ``select`` and ``select_set``
_ROUNDS = 3
_LONG = 8  # letters of a name that is compared with all others
_CLOSE = 0.85


@dataclass(frozen=True, slots=True)
class Correction:
    """``written`` was read as ``meant``; ``similarity`` 0…1."""

    written: str
    meant: str
    similarity: float


@dataclass(frozen=True, slots=True)
class RemovedSymbol:
    """A symbol that only other versions have: its path, their first and last, and replacements in this version."""

    path: str
    first: str
    last: str
    instead: tuple[tuple[str, float], ...]


def similarity(written: str, name: str) -> float:
    """How similar two names are: 1 if only their spelling differs, else by edits and by shared words."""
    return _alike(key(written), set(words(written)), name)


def _alike(written: str, mine: set[str], name: str) -> float:
    from rapidfuzz.distance import OSA  # noqa: PLC0415 - names that exist need no correction

    right = key(name)
    if written == right:
        return 1.0
    alike = OSA.normalized_similarity(written, right)
    # Only names that may contain all the words are split: that is slow for thousands of names.
    if mine and all(word in right for word in mine) and mine < (theirs := set(words(name))):
        alike = max(alike, _CONTAINED + 0.1 * len(mine) / len(theirs))
    return alike


def nearest(written: str, names: Iterable[str], limit: int = 3) -> list[tuple[str, float]]:
    """The names that are similar enough to be meant, best first."""
    left, mine = key(written), set(words(written))
    scored = [(name, _alike(left, mine, name)) for name in names]
    likely = [row for row in scored if row[1] >= LIKELY]
    return sorted(likely, key=lambda row: (-row[1], len(row[0]), row[0]))[:limit]


class Corrector:
    """Corrects the wrong names in a chain."""

    def __init__(self, reader: BaseReader, resolver: Resolver) -> None:
        self._reader = reader
        self._resolver = resolver

    @cached_property
    def _roots(self) -> dict[str, str]:
        """key → name of everything that code starts with: classes and modules."""
        rows = self._reader.rows(
            "SELECT name, path FROM symbols WHERE kind IN ('class', 'module') AND grp NOT IN ('ui', 'operator') "
            "ORDER BY kind DESC"  # of ``bpy.ops.collection`` and ``Collection`` keep the class
        )
        return {key(name): path.removeprefix(TYPES) for name, path in rows}

    def root(self, written: str) -> Correction | None:
        """The class or module that a misspelt first name means."""
        if len(written) < 5:
            return None
        return _closest(written, self._roots, 0.8)

    @cached_property
    def _members(self) -> dict[str, str]:
        """key → name of every member whose name has several words."""
        rows = self._reader.rows(
            "SELECT DISTINCT name FROM symbols WHERE kind IN ('property', 'function', 'operator')"
        )
        return {key(name): name for (name,) in rows if len(name) >= _LONG and "_" in name}

    def member(self, written: str) -> Correction | None:
        """Corrects a name of several words, ``use_self_colision``, without its owner."""
        if len(written) < _LONG or "_" not in written:
            return None
        return _closest(written, self._members, _CLOSE)

    def member_names(self, owner: str) -> list[str]:
        """The members of a class, inherited ones included, or of a module."""
        names: dict[str, None] = {}
        for ancestor in self._reader.lineage(owner):
            names.update(dict.fromkeys(self._reader.members(ancestor.path)))
        if not names:
            names.update(dict.fromkeys(self._reader.members(owner)))
        return list(names)

    def corrected(self, chain: Chain) -> tuple[ResolvedChain, list[Correction]] | None:
        """A chain with its wrong names corrected, and the corrections; None if no likely ones were found."""
        corrections: list[Correction] = []
        readings = self._resolver.resolve(chain)
        if not readings or readings[0].fit < 1.0:
            root = self.root(chain.root)
            if root and root.similarity < 1.0 and chain.root[:1].isupper():
                corrections.append(root)
                chain = replace(chain, root=root.meant)
                readings = self._resolver.resolve(chain)
        for _ in range(_ROUNDS):
            if not readings or readings[0].complete:
                break
            resolved = readings[0]
            similar = nearest(resolved.missing, self.member_names(resolved.owner), 1)
            if not similar:
                break
            name, alike = similar[0]
            corrections.append(Correction(resolved.missing, name, alike))
            chain = _with_step(chain, len(chain.steps) - resolved.steps_left, name)
            readings = self._resolver.resolve(chain)
        if corrections and readings and readings[0].complete:
            return readings[0], corrections
        return None


def _closest(written: str, names: Mapping[str, str], cutoff: float) -> Correction | None:
    """The name whose key is most like what was written, if it is at least ``cutoff`` alike."""
    from rapidfuzz import process  # noqa: PLC0415 - names that exist need no correction
    from rapidfuzz.distance import OSA  # noqa: PLC0415

    hit = process.extractOne(
        key(written), names.keys(), scorer=OSA.normalized_similarity, score_cutoff=cutoff
    )
    return Correction(written, names[hit[0]], hit[1]) if hit else None


def _with_step(chain: Chain, number: int, name: str) -> Chain:
    steps = list(chain.steps)
    steps[number] = ChainStep(
        "key" if steps[number].kind == "key" else "attr", name.partition('["')[2].rstrip('"]') or name
    )
    return replace(chain, steps=tuple(steps))


class RemovedSymbolLookup:
    """Looks up symbols that only other versions have."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def of_member(self, owner: str, name: str) -> RemovedSymbol | None:
        """A removed member of a class, of its bases, or of a module."""
        for ancestor in [entry.path for entry in self._reader.lineage(owner)] or [owner]:
            if removed := self.of_path(f"{ancestor}.{name}"):
                return removed
        return None

    def of_socket(self, owner: str, name: str, variable: str) -> RemovedSymbol | None:
        """A removed socket, ``inputs["Subsurface"]``, of a node below ``owner``: the variable may tell which."""
        paths = [path for path in self._reader.removed_by_key(key(name)) if '["' in path]
        below = [
            path
            for path in paths
            if self._reader.descends(path.partition('puts["')[0].rpartition(".")[0], owner)
        ]
        below.sort(key=lambda path: (key(variable) not in key(path), path))
        return self.of_path(below[0]) if below else None

    def of_variables_socket(self, chain: Chain) -> RemovedSymbol | None:
        """A removed socket, ``bsdf.inputs["Transmission"]``, of a node known only by the variable's name."""
        for before, step in pairwise(chain.steps[:2]):
            if step.kind == "key" and before.text in {"inputs", "outputs"}:
                paths = self._reader.removed_by_key(key(f'{before.text}["{step.text}"]'))
                named = [path for path in paths if key(chain.root) in key(path.partition('puts["')[0])]
                return self.of_path(named[0]) if named else None
        return None

    def of_path(self, path: str) -> RemovedSymbol | None:
        """A removed symbol by its exact path."""
        span = self._reader.removed(path)
        if span is None:
            return None
        successors = tuple((row.target, 1.0) for row in self._reader.successors(path) if row.target)
        return RemovedSymbol(path, *span[:2], successors or tuple(self._reader.similar_names(path)))

    def spelled(self, text: str) -> Iterator[RemovedSymbol]:
        """Removed symbols in any usual spelling; bare enum items only as code writes them."""
        for path in self._reader.removed_by_key(key(text)):
            if (
                ":" in path
                and "." not in text
                and not (text.isupper() and not self._reader.enum_owners(key(text)))
            ):
                continue
            if removed := self.of_path(path):
                yield removed
