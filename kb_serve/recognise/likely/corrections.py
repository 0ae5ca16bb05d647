"""Corrections of misspelt names."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import distinct_words, key, words
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.paths import socket_name
from kb_serve.recognise.chains.chains import Chain, ChainStep
from kb_serve.recognise.chains.variables import USUAL

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Mapping, Sequence

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.resolver import ResolvedChain, Resolver

LIKELY = 0.72  # similarity from which on a name is offered as a correction
_CONTAINED = 0.8  # for a name whose words are all in the other one: ``select`` and ``select_set``
_CUT_OFF = 6  # letters of what may be the beginning of a name
_SEVERAL = 2  # words of a name that may be made of two others
_READINGS = 3  # of a chain, of which one may lack a name that is only misspelt
_ROUNDS = 3
_LONG = 8  # letters of a name that is compared with all others
_CLOSE = 0.85
_FEW_BEGIN_SO, _FIRST_WORD = 3, 4  # names with the first word of one, and the letters that it has at least
_WORD = 3  # letters from which on a word says something
_UNDOES = ("dis", "un")  # how words begin that undo others; what selects deselects as well
_TYPO = 0.8  # similarity of a whole name from which on it may be misspelt
_LIKE_DICTIONARIES = frozenset({"get", "items", "keys", "pop", "values"})
_TYPO_ACROSS_WORDS = 0.88  # … where it has more or fewer words
_TYPO_IN_WORD = 0.6  # … and of each of its words


@dataclass(frozen=True, slots=True)
class Correction:
    """``written`` was read as ``meant``; ``similarity`` 0…1."""

    written: str
    meant: str
    similarity: float


class _Names(NamedTuple):
    """key → name of every member whose name has several words; and every word of some length in a name."""

    members: dict[str, str]
    words: set[str]


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
    if mine and all(word in right for word in mine) and mine <= (theirs := set(words(name))):
        alike = max(alike, _CONTAINED + 0.1 * len(mine) / len(theirs))
    elif len(written) >= _CUT_OFF and right.startswith(written):  # focus_dist, of focus_distance
        alike = max(alike, _CONTAINED + 0.1 * len(written) / len(right))
    elif share := _share(mine, name):
        alike = max(alike, _CONTAINED + 0.1 * share)
    return alike


def _share(mine: set[str], name: str) -> float:
    """Which share of a name's words another one is made of that has no others: ``hide_set`` of ``hide_set_viewport``.

    0 where it lacks more than one of them, or is a single word.
    """
    if len(mine) < _SEVERAL or name.partition("_")[0].lower() not in mine:
        return 0.0
    theirs = set(words(name))
    return len(theirs) / len(mine) if theirs < mine and len(theirs) >= len(mine) - 1 else 0.0


def nearest(written: str, names: Iterable[str], limit: int = 3) -> list[tuple[str, float]]:
    """The names that are similar enough to be meant, best first."""
    left, mine = key(written), set(words(written))
    scored = [(name, _alike(left, mine, name)) for name in names]
    likely = [row for row in scored if row[1] >= LIKELY and not are_opposite(written, row[0])]
    return sorted(likely, key=lambda row: (-row[1], len(row[0]), row[0]))[:limit]


def by_first_word(written: str, names: Iterable[str]) -> list[str]:
    """The names that begin with the first word of one, where they are few: ``resolution_max``."""
    first, *others = words(written) or [""]
    if len(first) < _FIRST_WORD or not others:
        return []
    found = [name for name in names if words(name)[:1] == [first]]
    return found if len(found) <= _FEW_BEGIN_SO else []


def shortened(written: str, names: Iterable[str]) -> list[str]:
    """The names of one word that a word begins with, or that begin with it, without their plural: ``verts`` for
    ``vertices``, and the other way round.
    """
    if "_" in written:
        return []
    short = written.removesuffix("s")
    found = [
        name
        for name in names
        if (len(name) > _FIRST_WORD and written.startswith(name.removesuffix("s")))
        or (len(short) >= _WORD and "_" not in name and name.startswith(short))
    ]
    return found if len(found) <= _FEW_BEGIN_SO else []


def are_opposite(name: str, other: str) -> bool:
    """Whether one of two names undoes what the other does: ``unsubscribe`` and ``subscribe``; not ``unselect`` and
    ``select_set``, which does both.
    """
    theirs = words(other)
    pairs = ((a, b) for a in words(name) for b in theirs)
    return "set" not in theirs and any(a == un + b or b == un + a for a, b in pairs for un in _UNDOES)


def is_misspelling(written: str, name: str, vocabulary: Container[str] = ()) -> bool:
    """Whether ``written`` can only be ``name`` with a slip of the fingers, not another word: ``location_x`` is no
    misspelt ``location_y``, and ``groups`` no ``node_groups``.

    A word of the ``vocabulary`` is hardly misspelt: ``tool_get`` is no ``tool_set``.
    """
    from rapidfuzz.distance import OSA  # noqa: PLC0415 - names that exist need no correction

    left, right = key(written), key(name)
    mine, theirs = words(written), words(name)
    alike = OSA.normalized_similarity(left, right)
    if alike in {0.0, 1.0}:
        return alike == 1.0
    if len(mine) != len(theirs):
        contained = set(mine) < set(theirs) or set(theirs) < set(mine)
        return alike >= _TYPO_ACROSS_WORDS and not contained
    pairs = [(a, b) for a, b in zip(mine, theirs, strict=True) if a != b]
    if are_opposite(written, name):
        return False
    if any(a in vocabulary and not (a.startswith(b) or b.startswith(a)) for a, b in pairs):
        return False
    if OSA.distance(left, right) == 1:
        return alike >= _TYPO and all(len(a + b) > 2 for a, b in pairs)  # one letter each: an axis, a number
    return alike >= _TYPO and all(OSA.normalized_similarity(a, b) >= _TYPO_IN_WORD for a, b in pairs)


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

    @cached_property
    def _names(self) -> _Names:
        """The names of members and classes. Their rows, megabytes of them, are not kept."""
        rows: list[tuple[str, bool]] = self._reader.rows(
            "SELECT name, max(kind != 'class') FROM symbols "
            "WHERE kind IN ('property', 'function', 'operator', 'class') GROUP BY name"
        )
        long = (name for name, of_member in rows if of_member and len(name) >= _LONG and "_" in name)
        found = distinct_words("\n".join(name for name, _ in rows))
        return _Names({key(name): name for name in long}, {word for word in found if len(word) >= _WORD})

    def root(self, written: str) -> Correction | None:
        """The class or module that a misspelt first name means."""
        if len(written) < 5:
            return None
        return _closest(written, self._roots, _TYPO, self._names.words)

    def member(self, written: str) -> Correction | None:
        """Corrects a name of several words, ``use_self_colision``, without its owner; not a variable's plural."""
        if len(written) < _LONG or "_" not in written:
            return None
        closest = _closest(written, self._names.members, _CLOSE, self._names.words)
        return None if closest and written.removesuffix("s") == closest.meant.removesuffix("s") else closest

    def parts(self, written: str) -> list[str]:
        """The members whose words are all but one of a name's: ``hide_set`` and ``hide_viewport``."""
        mine = set(words(written))
        return sorted(name for name in self._names.members.values() if _share(mine, name))

    def corrected(
        self, chain: Chain, readings: list[ResolvedChain]
    ) -> tuple[ResolvedChain, list[Correction]] | None:
        """A chain with its wrong names corrected, and the corrections; None if no likely ones were found.

        ``readings`` are the chain's, as it is.
        """
        corrections: list[Correction] = []
        may_be_class = chain.root[:1].isupper() and not chain.root.isupper()
        if may_be_class and (not readings or readings[0].fit < 1.0):
            root = self.root(chain.root)
            if root and root.similarity < 1.0:
                corrections.append(root)
                chain = chain._replace(root=root.meant)
                readings = self._resolver.resolve(chain)
        for _ in range(_ROUNDS):
            if not readings or readings[0].complete:
                break
            found = self._misspelt(chain, readings)
            if found is None:
                return None
            correction, place = found
            corrections.append(correction)
            chain = _with_step(chain, len(chain.steps) - place, correction.meant)
            readings = self._resolver.resolve(chain)
        if corrections and readings and readings[0].complete:
            return readings[0], corrections
        return None

    def _misspelt(self, chain: Chain, readings: Sequence[ResolvedChain]) -> tuple[Correction, int] | None:
        """The name that the first reading lacks, corrected, or else one that another lacks which leads as far; and how
        many steps there are from it on.
        """
        for resolved in readings[:_READINGS]:
            if resolved.steps_left != readings[0].steps_left:
                break
            if resolved.fit < USUAL <= readings[0].fit:
                continue  # what scripts call so lacks it
            behind = chain.steps[len(chain.steps) - resolved.steps_left + 1 :]
            names = names_meant(
                resolved.owner, self._reader, called=bool(behind) and behind[0].kind == "call"
            )
            for name, alike in nearest(resolved.missing, names, 1):
                if is_misspelling(resolved.missing, name, self._names.words):
                    return Correction(resolved.missing, name, alike), resolved.steps_left
        return None


def names_meant(owner: str, reader: BaseReader, *, called: bool) -> list[str]:
    """What a class has that may be meant by a name that it lacks. What all classes have, to be read like dictionaries,
    nobody means who reads a ``value`` and does not call it.
    """
    names = reader.member_names(owner) if owner else []
    return names if called else [name for name in names if name not in _LIKE_DICTIONARIES]


def _closest(
    written: str, names: Mapping[str, str], cutoff: float, vocabulary: Container[str]
) -> Correction | None:
    """The name whose key is most like what was written, if it is at least ``cutoff`` alike, and no other word."""
    from rapidfuzz import process  # noqa: PLC0415 - names that exist need no correction
    from rapidfuzz.distance import OSA  # noqa: PLC0415

    hit = process.extractOne(
        key(written), names.keys(), scorer=OSA.normalized_similarity, score_cutoff=cutoff
    )
    if hit is None or not is_misspelling(written, names[hit[0]].rpartition(".")[2], vocabulary):
        return None
    return Correction(written, names[hit[0]], hit[1])


def _with_step(chain: Chain, number: int, name: str) -> Chain:
    steps = list(chain.steps)
    steps[number] = ChainStep("key" if steps[number].kind == "key" else "attr", socket_name(name) or name)
    return chain._replace(steps=tuple(steps))
