"""Operators by the words of their names."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import stem, words
from kb_build.symbols.api_names import OPERATORS

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_serve.reader import BaseReader

_FEW = 3
# Verbs that say the same of operators; of each the first stands for all.
_VERBS = (("add", "create", "make", "new"), ("move", "translate"), ("open", "load", "read"))
_SAME = {stem(word): stem(verbs[0]) for verbs in _VERBS for word in verbs}
_SAYS_LITTLE = frozenset(map(stem, ("all", "by", "the")))  # where nothing is called so
_OF_ALL = frozenset({stem("object")})
_LONG = 4  # letters of a word that may stand at the end of another: ``file``, of ``mainfile``


class _Words(NamedTuple):
    """The stems of an operator's words and of its module's."""

    own: frozenset[str]
    module: frozenset[str]


class OperatorWords:
    """The operators of one base, by their words."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def having(self, owner: str, name: str) -> list[str]:
        """The operators, of whatever module, that have all words of an operator's name: ``export_scene.fbx`` for
        ``wm.fbx_export``, ``object.camera_add`` for ``camera.add``. Those with the fewest words besides, and that lack
        the fewest of the module's; none where too many are alike.
        """
        if not f"{owner}.".startswith(OPERATORS):
            return []
        said = _stems(self._joined(words(name)))
        # Of objects much is done by operators of other modules.
        module = _stems(words(owner.removeprefix(OPERATORS.rstrip(".")))) - _OF_ALL
        # One that is called so as a whole is nearer than one without the words that say little.
        nearest = (self._nearest(meant, module) for meant in (said, said - _SAYS_LITTLE))
        cost, found = min(nearest, key=lambda one: one[0])
        found = self._heaviest(found)
        found.sort(key=lambda path: not path.startswith(f"{owner}."))
        # Of a module that is not there one is meant, whichever operator of it.
        is_one_module = not self._reader.entry(owner) and len({path.split(".")[2] for path in found}) == 1
        return found[:_FEW] if len(found) <= _FEW or not cost[0] or is_one_module else []

    def _joined(self, spoken: list[str]) -> list[str]:
        """The words of a name, two of them as one where a module is called so: ``rigid``, ``body``."""
        for place, pair in enumerate(pairwise(spoken)):
            if "".join(pair) in self._modules:
                return [*spoken[:place], "".join(pair), *spoken[place + 2 :]]
        return spoken

    @cached_property
    def _modules(self) -> frozenset[str]:
        return frozenset(path.split(".")[2] for path in self._own_words)

    def _heaviest(self, paths: list[str]) -> list[str]:
        """Operators, those first that count most; of a module's with the same words the shorter one counts as much."""
        weights = self._reader.usage.weights(paths)
        alike: dict[tuple[frozenset[str], frozenset[str]], float] = {}
        for path in paths:
            key = self._words[path].own, self._words[path].module
            alike[key] = max(alike.get(key, 0.0), weights.get(path, 0.0))
        return sorted(
            paths, key=lambda path: (-alike[self._words[path].own, self._words[path].module], len(path))
        )

    def _nearest(self, said: frozenset[str], module: frozenset[str]) -> tuple[tuple[int, int], list[str]]:
        """How many words are too many or too few at best, how many of these too few, and the operators."""
        costs: dict[str, tuple[int, int]] = {}
        for path in sorted(frozenset.intersection(*map(self._saying, said))) if said else ():
            own = self._words[path]
            lacking = len(module - own.own - own.module)
            costs[path] = lacking + len(own.own - said - module - _OF_ALL), lacking
        best = min(costs.values(), default=(len(said | module), 0))
        found = [path for path, cost in costs.items() if cost == best]
        return best, found

    def _saying(self, word: str) -> frozenset[str]:
        """The operators that have a stem among their words or their module's, or at the end of a word."""
        found = self._by_stem.get(word, frozenset())
        if len(word) < _LONG:
            return found
        return found.union(*(paths for other, paths in self._by_word.items() if other.endswith(word)))

    def beginning(self, name: str) -> list[str]:
        """The operators whose own names begin with the words of a name: ``ptcache.bake_all`` for ``bake``."""
        said = words(name)
        return [path for path, own in self._own_words.items() if own[: len(said)] == said]

    @cached_property
    def _own_words(self) -> dict[str, list[str]]:
        rows = self._reader.rows("SELECT path FROM symbols WHERE kind = 'operator' ORDER BY path")
        return {path: words(path.rpartition(".")[2]) for (path,) in rows}

    @cached_property
    def _words(self) -> dict[str, _Words]:
        return {
            path: _Words(_stems(own), _stems(words(path.split(".")[2])))
            for path, own in self._own_words.items()
        }

    @cached_property
    def _by_stem(self) -> dict[str, frozenset[str]]:
        return _grouped((word, path) for path, own in self._words.items() for word in own.own | own.module)

    @cached_property
    def _by_word(self) -> dict[str, frozenset[str]]:
        return _grouped((word, path) for path, own in self._own_words.items() for word in own)


def same_operator_words(one: str, other: str) -> bool:
    """Whether two names of operators have the same words, in whatever order: ``add_modifier``, ``modifier_add``."""
    return _stems(words(one)) == _stems(words(other))


def _stems(spoken: Iterable[str]) -> frozenset[str]:
    return frozenset(_SAME.get(one, one) for one in map(stem, spoken))


def _grouped(pairs: Iterable[tuple[str, str]]) -> dict[str, frozenset[str]]:
    """What stands with each first one of some pairs."""
    found: dict[str, set[str]] = {}
    for key, value in pairs:
        found.setdefault(key, set()).add(value)
    return {key: frozenset(values) for key, values in found.items()}
