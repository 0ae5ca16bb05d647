"""Finds the removed names in code whose variables tell no class: what only removed symbols can be, or what is far
likelier one of those than what a seldom used class has today.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import words
from kb_build.symbols.api_names import OBJECT, SIDES, TYPES
from kb_build.symbols.paths import socket_node
from kb_serve.recognise.chains.call_texts import texts_given
from kb_serve.recognise.chains.chain_starts import ROOTS
from kb_serve.recognise.chains.chains import ChainStep
from kb_serve.recognise.chains.refusals import is_listed, refuses
from kb_serve.recognise.chains.variables import classes_of_parts, usual_classes
from kb_serve.recognise.elsewhere.members_within import members_within

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbol, RemovedSymbolLookup
    from kb_serve.recognise.resolver import ResolvedChain

_NAMED = 0.5  # fit of a class that a variable's name tells
_FAR_LIKELIER = 1.3  # so much more than what has a name today must count what had it
_USED = 10.0  # weight of a class that scripts use much
_LAST_OF_ENGINE = "2.79"
_HELD_BY = (TYPES, "bmesh.types.")
_THEME = f"{TYPES}Theme"  # its hundreds of colours are called like everything else
_DATA = f"{TYPES}Object.data"
# Instances of the script's own classes, and what a button calls its operator with: no class of Blender's lost theirs.
_INSTANCES = frozenset({"self", "cls", "props", "op"})


class LostName(NamedTuple):
    """A removed symbol that a chain may name, and the number of its steps up to that name."""

    removed: RemovedSymbol
    steps: int


def _is_made(chain: Chain, node: str) -> bool:
    """Whether a call in a chain says which node it makes."""
    name = node.removeprefix(TYPES)
    return bool(name) and name in texts_given(chain)


class LostNames:
    """Finds them against one base."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup) -> None:
        self._reader = reader
        self._removed = removed

    def of_named_data(self, chain: Chain) -> LostName | None:
        """What the data lost of an object that is called like its data: ``cam.data.cycles`` is of a Camera."""
        match chain.steps:
            case (ChainStep("attr", "data"), ChainStep("attr", name), *_):
                classes = usual_classes(chain.root)
            case _:
                return None
        for cls in classes if OBJECT in classes else ():
            if not self._reader.is_object_data(cls):
                continue
            if any(self._reader.member_of(kind, name) for kind in self._kinds(cls)):
                return None
            if removed := self._removed.of_member(cls, name):
                return LostName(removed, 2)
        return None

    def _kinds(self, cls: str) -> tuple[str, ...]:
        """A class and all below it."""
        return (cls, *(entry.path for entry in self._reader.descendants(cls)))

    def socket(self, chain: Chain, readings: Sequence[ResolvedChain]) -> LostName | None:
        """A socket that no node has on that side any more, ``b.inputs["Emission"]``, or only nodes that count far less
        and that nothing in the chain tells.
        """
        for number, (side, name) in enumerate(pairwise(chain.steps), 2):
            if side.text not in SIDES or name.kind != "key":
                continue
            path = self._likeliest(self._removed.of_sockets(side.text, name.text), socket_node)
            removed = self._removed.of_path(path) if path else None
            if removed is None or self._is_on_a_node(chain, readings, side.text, name.text, removed):
                return None
            return LostName(removed, number)
        return None

    def _is_on_a_node(
        self, chain: Chain, readings: Sequence[ResolvedChain], side: str, name: str, removed: RemovedSymbol
    ) -> bool:
        """Whether a node has a socket today that the chain tells, or that may well be meant."""
        best = readings[0] if readings and readings[0].complete else None
        node = socket_node(best.symbols[-1]) if best else ""
        if best and (node in best.symbols or _is_made(chain, node)):
            return True
        sockets = [
            entry
            for entry in self._reader.names.by_name(name)
            if entry.path.startswith(f"{entry.owner}.{side}[")
        ]
        if sockets and not removed.gone:
            return True  # what another node got later is hardly meant
        symbols = [symbol for entry in sockets if (symbol := self._reader.symbol(entry.path))]
        if any(is_listed(chain, entry.path, self._reader) for entry in sockets):
            return True
        nodes = [symbol.owner for symbol in symbols if not refuses(symbol, chain)]
        lost = socket_node(removed.path)
        weights = self._reader.usage.weights([*nodes, lost])
        most = max((weights.get(node, 0.0) for node in nodes), default=0.0)
        return bool(nodes) and not weights.get(lost, 0.0) > _FAR_LIKELIER * most

    def reached(self, chain: Chain, readings: Sequence[ResolvedChain]) -> LostName | None:
        """What the class lost that a chain leads to, whatever its variable is: ``x.animation_data.action.fcurves``."""
        left = min((reading.steps_left for reading in readings), default=0)
        if chain.root in _INSTANCES or not 0 < left < len(chain.steps):
            return None
        for reading in readings:
            if reading.steps_left != left or not reading.owner:
                continue
            if removed := self._of_owner(reading, chain.root):
                return LostName(removed, len(chain.steps) - left + 1)
        return None

    def _of_owner(self, reading: ResolvedChain, variable: str) -> RemovedSymbol | None:
        if removed := self._removed.of_member(reading.owner, reading.missing):
            return removed
        if "[" in reading.missing or not is_telling(reading.missing):
            return None
        if members_within(reading.owner, reading.missing, self._reader):
            return None  # what has it today is meant
        paths = self._removed.paths_below(reading.owner, reading.missing)
        if reading.symbols[-1] == _DATA:
            paths = [path for path in paths if self._reader.is_object_data(_owner_of(path))]
        named = set(words(variable))
        alike = [path for path in paths if named & set(words(_owner_of(path)))]
        path = self._likeliest(alike or paths, _owner_of)
        return self._removed.of_path(path) if path else None

    def likelier(self, chain: Chain, readings: Sequence[ResolvedChain]) -> LostName | None:
        """What is far likelier meant than all that has the name today, or what alone can take what is set."""
        found = self._against_today(chain, readings)
        if found is None:
            return None
        removed, lost, today = found
        if self._lists(readings, chain):
            return None
        least = max(today, default=0.0)
        # What went with the game engine, without a successor, is hardly meant today.
        is_told = bool(removed.targets) or removed.last != _LAST_OF_ENGINE
        is_far_likelier = is_told and lost >= _USED and lost > _FAR_LIKELIER * least
        return LostName(removed, 1) if is_far_likelier or (not today and self._took(removed, chain)) else None

    def _took(self, removed: RemovedSymbol, chain: Chain) -> bool:
        """Whether what was lost may have taken what a chain is set to: of a text it must be known."""
        return not chain.values or any(
            self._removed.of_path(f"{removed.path}:{value}") for value in chain.values
        )

    def alike(self, chain: Chain, readings: Sequence[ResolvedChain]) -> RemovedSymbol | None:
        """What may be meant as well as what has the name today: of a class that counts more, or of another one that the
        variable is usually of.
        """
        if len(chain.steps) != 1:
            return None
        if removed := self._of_usual_class(chain):
            return removed
        found = self._against_today(chain, readings)
        if found is None:
            return None
        removed, lost, today = found
        if max(today, default=0.0) and self._lists(readings, chain):
            return None
        owners = self._reader.usage.weights([reading.symbols[0] for reading in readings if reading.complete])
        most = max(owners.values(), default=0.0)
        return removed if removed.targets and lost and lost >= most else None

    def _of_usual_class(self, chain: Chain) -> RemovedSymbol | None:
        """What one of the classes lost that a variable is usually of, where another has it: ``bone.select``."""
        name, classes = chain.steps[0].text, usual_classes(chain.root)
        if len(classes) == 1 or chain.steps[0].kind != "attr":
            return None
        lost = (
            self._removed.of_member(cls, name) for cls in classes if not self._reader.member_of(cls, name)
        )
        return next(filter(None, lost), None)

    def _against_today(
        self, chain: Chain, readings: Sequence[ResolvedChain]
    ) -> tuple[RemovedSymbol, float, list[float]] | None:
        """The likeliest removed member of the first name of an unknown variable, how much its class counts, and how
        much each member of today does that takes what is set, with its class.
        """
        whole = [reading for reading in readings if reading.complete]
        first = chain.steps[0] if chain.steps else None
        if not whole or first is None or first.kind != "attr" or self._is_known(chain, whole[0]):
            return None
        if first.text in SIDES and [step.kind for step in chain.steps[1:2]] == ["key"]:
            return None  # a socket's
        path = self._likeliest(self._removed.paths_named(first.text), _owner_of)
        removed = self._removed.of_path(path) if path else None
        # What has it today may have taken its place.
        if removed is None or any(target.endswith(f".{first.text}") for target in removed.targets):
            return None
        taken = [reading for reading in whole if not self._refuses(reading, chain)]
        paths = {path for reading in taken for path in reading.symbols[:2]}
        weights = self._reader.usage.weights({*paths, _owner_of(removed.path)})
        today = [sum(weights.get(path, 0.0) for path in reading.symbols[:2]) for reading in taken]
        return removed, weights.get(_owner_of(removed.path), 0.0), today

    def _is_known(self, chain: Chain, best: ResolvedChain) -> bool:
        """Whether a chain's root tells what it is."""
        own = chain.root in _INSTANCES or chain.root[:1].isupper() or chain.root in {"bpy", *ROOTS}
        return own or best.fit >= _NAMED or bool(usual_classes(chain.root) or classes_of_parts(chain.root))

    def _refuses(self, reading: ResolvedChain, chain: Chain) -> bool:
        symbol = self._reader.symbol(reading.symbols[-1])
        return symbol is not None and refuses(symbol, chain)

    def _lists(self, readings: Iterable[ResolvedChain], chain: Chain) -> bool:
        """Whether what any whole reading leads to lists the very text that a chain is set to."""
        return any(is_listed(chain, one.symbols[-1], self._reader) for one in readings if one.complete)

    def _likeliest(self, paths: Iterable[str], owner: Callable[[str], str]) -> str:
        """Of removed symbols that of the class of today that counts most; empty for none."""
        owners = {
            path: owner(path)
            for path in paths
            if path.startswith(_HELD_BY) and not path.startswith(_THEME) and self._reader.entry(owner(path))
        }
        weights = self._reader.usage.weights(set(owners.values()))
        return max(owners, key=lambda path: weights.get(owners[path], 0.0), default="")


def is_telling(name: str) -> bool:
    """Whether a name is hardly one of the script's own: ``dupli_object`` rather than ``index``."""
    return "_" in name.strip("_")


def _owner_of(path: str) -> str:
    return path.rpartition(".")[0]
