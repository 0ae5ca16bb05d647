"""Names that do not exist: what was probably meant, and what other versions had."""

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
_CONTAINED = 0.8  # of a name whose words are all in the other: ``select`` and ``select_set``
_ROUNDS = 3
_LONG = 8  # letters of a name that is looked for among all others
_CLOSE = 0.85


@dataclass(frozen=True, slots=True)
class Correction:
    """``written`` was read as ``meant``; ``similarity`` 0…1."""

    written: str
    meant: str
    similarity: float


@dataclass(frozen=True, slots=True)
class RemovedSymbol:
    """A symbol of another version: its path, first and last version, and what this version has instead."""

    path: str
    first: str
    last: str
    instead: tuple[tuple[str, float], ...]


def similarity(written: str, name: str) -> float:
    """How alike two names are: 1 when only the spelling differs, else by edits and by shared words."""
    return _alike(key(written), set(words(written)), name)


def _alike(written: str, mine: set[str], name: str) -> float:
    from rapidfuzz.distance import OSA  # noqa: PLC0415 - names that exist need no correction

    right = key(name)
    if written == right:
        return 1.0
    alike = OSA.normalized_similarity(written, right)
    # Only names that may hold all the words are taken apart: that is what costs among thousands of names.
    if mine and all(word in right for word in mine) and mine < (theirs := set(words(name))):
        alike = max(alike, _CONTAINED + 0.1 * len(mine) / len(theirs))
    return alike


def nearest(written: str, names: Iterable[str], limit: int = 3) -> list[tuple[str, float]]:
    """The most similar names that are likely meant, best first."""
    left, mine = key(written), set(words(written))
    scored = [(name, _alike(left, mine, name)) for name in names]
    likely = [row for row in scored if row[1] >= LIKELY]
    return sorted(likely, key=lambda row: (-row[1], len(row[0]), row[0]))[:limit]


class Corrector:
    """Finds what a chain with a wrong name in it was meant to be."""

    def __init__(self, reader: BaseReader, resolver: Resolver) -> None:
        self._reader = reader
        self._resolver = resolver

    @cached_property
    def _roots(self) -> dict[str, str]:
        """key → name for everything that code starts with: classes and modules."""
        rows = self._reader.rows(
            "SELECT name, path FROM symbols WHERE kind IN ('class', 'module') AND grp NOT IN ('ui', 'operator') "
            "ORDER BY kind DESC"  # of ``bpy.ops.collection`` and ``Collection`` the class stays
        )
        return {key(name): path.removeprefix(TYPES) for name, path in rows}

    def root(self, written: str) -> Correction | None:
        """A class or module that a misspelt first name stands for."""
        if len(written) < 5:
            return None
        return _closest(written, self._roots, 0.8)

    @cached_property
    def _members(self) -> dict[str, str]:
        """key → name for everything that has an owner, and a name of several words."""
        rows = self._reader.rows(
            "SELECT DISTINCT name FROM symbols WHERE kind IN ('property', 'function', 'operator')"
        )
        return {key(name): name for (name,) in rows if len(name) >= _LONG and "_" in name}

    def member(self, written: str) -> Correction | None:
        """A name of several words, ``use_self_colision``, whose owner was not given."""
        if len(written) < _LONG or "_" not in written:
            return None
        return _closest(written, self._members, _CLOSE)

    def member_names(self, owner: str) -> list[str]:
        """The names that may follow after ``owner``: own, inherited, and its contents for a module."""
        names: dict[str, None] = {}
        for ancestor in self._reader.lineage(owner):
            names.update(dict.fromkeys(self._reader.members(ancestor.path)))
        if not names:
            names.update(dict.fromkeys(self._reader.members(owner)))
        return list(names)

    def corrected(self, chain: Chain) -> tuple[ResolvedChain, list[Correction]] | None:
        """A chain read with its wrong names replaced by likely ones; None when nothing likely was found."""
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
            found = nearest(resolved.missing, self.member_names(resolved.owner), 1)
            if not found:
                break
            corrections.append(Correction(resolved.missing, found[0][0], found[0][1]))
            chain = _with_step(chain, len(chain.steps) - resolved.steps_left, found[0][0])
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


class RemovedSymbols:
    """Looks up symbols that other versions had."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def of_member(self, owner: str, name: str) -> RemovedSymbol | None:
        """A former member of a class, of its bases, or of a module."""
        for ancestor in [entry.path for entry in self._reader.lineage(owner)] or [owner]:
            if removed := self.of_path(f"{ancestor}.{name}"):
                return removed
        return None

    def of_socket(self, owner: str, name: str, variable: str) -> RemovedSymbol | None:
        """A former socket, ``inputs["Subsurface"]``, of a node below ``owner``: the variable may tell which."""
        paths = [path for path in self._reader.removed_by_key(key(name)) if '["' in path]
        below = [
            path
            for path in paths
            if self._reader.descends(path.partition('puts["')[0].rpartition(".")[0], owner)
        ]
        below.sort(key=lambda path: (key(variable) not in key(path), path))
        return self.of_path(below[0]) if below else None

    def of_variables_socket(self, chain: Chain) -> RemovedSymbol | None:
        """A former socket, ``bsdf.inputs["Transmission"]``, of a node that only the variable's name tells of."""
        for before, step in pairwise(chain.steps[:2]):
            if step.kind == "key" and before.text in {"inputs", "outputs"}:
                paths = self._reader.removed_by_key(key(f'{before.text}["{step.text}"]'))
                named = [path for path in paths if key(chain.root) in key(path.partition('puts["')[0])]
                return self.of_path(named[0]) if named else None
        return None

    def of_path(self, path: str) -> RemovedSymbol | None:
        """A symbol of another version by its exact path."""
        span = self._reader.removed(path)
        return RemovedSymbol(path, *span, tuple(self._reader.replacements(path))) if span else None

    def spelled(self, text: str) -> Iterator[RemovedSymbol]:
        """Symbols of other versions under any usual spelling; enum items alone only as code writes them."""
        for path in self._reader.removed_by_key(key(text)):
            if (
                ":" in path
                and "." not in text
                and not (text.isupper() and not self._reader.enum_owners(key(text)))
            ):
                continue
            if removed := self.of_path(path):
                yield removed
