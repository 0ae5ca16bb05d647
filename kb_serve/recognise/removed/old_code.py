"""Finds the names in the expressions of code that only other versions have: members, paths, functions, sockets."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, words
from kb_build.symbols.api_names import OPERATORS, SIDES, TYPES, interface_part
from kb_build.symbols.paths import is_socket, last_name, socket_node, split_path
from kb_serve.recognise.chains.call_texts import texts_given
from kb_serve.recognise.chains.chain_starts import ROOTS
from kb_serve.recognise.chains.variables import USUAL, usual_classes, variable_fit
from kb_serve.recognise.removed.lost_names import LostName, LostNames, is_telling
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain, ChainStep
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbol, RemovedSymbolLookup
    from kb_serve.recognise.resolver import ResolvedChain

_LIKELY_FIT = 0.6  # from this fit of a variable's name on, its class is believed if it had the name once
_BETTER = 0.05  # by this a removed class must fit a name more than one of today
_NAMED_AFTER = 0.8  # … it is named after a class
_SHORTEST = 4  # letters of a name that tells a class by its end
_MOST_NAMES = 6
_MANY_OWNERS = 3  # more classes than these had a name: which one is meant is not known
# The name of a class that has several words, which no variable is called like.
WORDS_OF_CLASS = re.compile(r"(?=[A-Z]+[a-z_]+[A-Z])[A-Z]\w+")
_SAY_NOTHING = frozenset({"node", *"0123456789"})  # words of a variable's name that no node is told by
_THEME = f"{TYPES}Theme"  # its hundreds of colours are called like everything else


@dataclass(frozen=True, slots=True)
class OldName:
    """A removed symbol that a chain names, and the steps of the chain behind it."""

    removed: RemovedSymbol
    rest: tuple[ChainStep, ...] = ()


class OldCode:
    """Finds removed names in chains, against one base."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup) -> None:
        self._reader = reader
        self._removed = removed
        self._lost_names = LostNames(reader, removed)

    def in_chain(
        self, chain: Chain, readings: Sequence[ResolvedChain], *, is_quoted: bool = False
    ) -> OldName | None:
        """The first removed name in a chain that this version cannot resolve; None where that is not sure.

        ``is_quoted``: whether the name is a text, of which nothing is set that tells more.
        """
        if readings and readings[0].complete and readings[0].fit >= _LIKELY_FIT:
            return self._member(chain, self._likelier(chain, readings)) or _old(
                chain, self._lost_names.socket(chain, readings)
            )
        return (
            self._path(chain)
            or self._class(chain)
            or self._function(chain)
            or _old(chain, self._lost_names.of_named_data(chain))
            or self._member(chain, readings)
            or self._socket(chain)
            or _old(chain, self._lost_names.socket(chain, readings))
            or self._of_last_part(chain, readings)
            or self._of_fitting_class(chain, readings)
            or self._of_any_class(chain, readings)
            or _old(chain, self._lost_names.reached(chain, readings))
            or (None if is_quoted else _old(chain, self._lost_names.likelier(chain, readings)))
        )

    def beneath(self, chain: Chain, reading: ResolvedChain) -> RemovedSymbol | None:
        """What a class once had by a name that leads to what a class above it gives all today: the ``width`` of a
        mask's node, not that of the mask.
        """
        owner, _, name = reading.symbols[-1].rpartition(".")
        made = (f"{TYPES}{text}" for text in texts_given(chain))
        below = (
            cls
            for cls in (*reading.symbols[:-1], *made)
            if cls != owner and self._reader.descends(cls, owner)
        )
        lost = (self._removed.of_path(f"{cls}.{name}") for cls in below)
        return next((removed for removed in lost if removed and removed.targets), None)

    def alike(self, chain: Chain, readings: Sequence[ResolvedChain]) -> RemovedSymbol | None:
        """What a chain of an unknown variable may name as well as what has the name today."""
        return self._lost_names.alike(chain, readings)

    def still_taken(self, chain: Chain, readings: Sequence[ResolvedChain]) -> str:
        """The present symbol that a name missing on a class still leads to under its former name; "" for none."""
        for resolved in readings:
            if not resolved.complete and resolved.fit >= _LIKELY_FIT:
                return self._reader.history.still_works(f"{resolved.owner}.{resolved.missing}")
        return "" if readings and readings[0].fit >= _LIKELY_FIT else self._socket_still_taken(chain)

    def _socket_still_taken(self, chain: Chain) -> str:
        """The socket that a former name gives on the nodes that a variable is named after, if all of those take it."""
        side, name = chain.steps[:2] if len(chain.steps) > 1 else (None, None)
        named = set(words(chain.root)) - _SAY_NOTHING
        if side is None or name is None or name.kind != "key" or side.text not in SIDES:
            return ""
        paths = self._reader.history.removed_by_key(key(f'{side.text}["{name.text}"]')) if named else ()
        fitting = (path for path in paths if named <= set(words(socket_node(path).removeprefix(TYPES))))
        taken = [self._reader.history.still_works(path) for path in fitting]
        return taken[0] if all(taken) and taken else ""

    def member(self, owner: str, name: str) -> RemovedSymbol | None:
        """The member of that name which a class had in another version."""
        return self._removed.of_member(owner, name)

    def had(self, owner: str, name: str) -> bool:
        """Whether a class, or one below it, had a member of that name in another version."""
        return bool(self.member(owner, name) or self._removed.paths_below(owner, name))

    def behind(self, before: str, resolved: ResolvedChain, steps: tuple[ChainStep, ...]) -> OldName | None:
        """The removed name at which a chain breaks off that was followed from the successor of a removed one.

        What was removed ``before`` may have been a collection with a class of its own: NodeTree.outputs of
        NodeTreeOutputs.
        """
        owner, _, name = before.rpartition(".")
        removed = (
            self._removed.of_path(f"{owner}{name.title()}.{resolved.missing}") if resolved.missing else None
        )
        if removed is None and resolved.missing:
            removed = self._removed.of_member(resolved.owner, resolved.missing)
        return OldName(removed, steps[len(steps) - resolved.steps_left + 1 :]) if removed else None

    def _likelier(self, chain: Chain, readings: Sequence[ResolvedChain]) -> list[ResolvedChain]:
        """The readings that suit the variable better than a complete one, and cannot be a case of it."""
        whole, usual = readings[0], usual_classes(chain.root)
        return [
            reading
            for reading in readings[1:]
            if not reading.complete
            and reading.fit > whole.fit
            and whole.symbols[0] not in usual
            and not self._reader.descends(reading.symbols[0], whole.symbols[0])
        ]

    def _class(self, chain: Chain) -> OldName | None:
        """A class by its name alone, of several words: ``CompositorNodeComposite``, not ``Lamp``."""
        if not WORDS_OF_CLASS.fullmatch(chain.root) or self._reader.entry(TYPES + chain.root):
            return None
        removed = self._removed.of_path(TYPES + chain.root)
        return OldName(removed, chain.steps) if removed else None

    def _function(self, chain: Chain) -> OldName | None:
        """A function that one module had, called by its name alone: ``rna_idprop_ui_prop_get(bone, "x")``."""
        if not chain.steps or chain.steps[0].kind != "call" or not is_telling(chain.root):
            return None
        named = self._reader.history.removed_named(chain.root)
        of_modules = [path for path in named if self._is_of_module(path)]
        removed = self._removed.of_path(of_modules[0]) if len(of_modules) == 1 else None
        return OldName(removed, chain.steps[1:]) if removed else None

    def _is_of_module(self, path: str) -> bool:
        owner = self._reader.entry(split_path(path)[0])
        return owner is not None and owner.kind == "module" and not path.startswith(OPERATORS)

    def _path(self, chain: Chain) -> OldName | None:
        """A removed symbol that the chain spells out from its root: ``bgl.glEnable``, ``bpy.ops.wm.addon_enable``."""
        if not chain.steps:
            return None
        names = chain.dotted.split(".")
        root = ROOTS.get(names[0], names[0])
        for length in range(min(len(names), _MOST_NAMES), 0, -1):
            path = ".".join((root, *names[1:length]))
            # A script's own panel may bear a name that Blender's had.
            cls = () if interface_part(path) else (TYPES + path,)
            for candidate in (path, *cls, f"bpy.{path}"):
                if removed := self._removed.of_path(candidate):
                    return OldName(removed, chain.steps[length - 1 :])
        return None

    def _member(self, chain: Chain, readings: Sequence[ResolvedChain]) -> OldName | None:
        """A removed member of the class that the chain or its variable leads to."""
        for resolved in readings:
            if resolved.complete or resolved.fit < _LIKELY_FIT:
                continue
            # ``node.inputs["x"]`` is a node's rather than a tree's that had inputs.
            if any(one.fit > resolved.fit and one.steps_left < resolved.steps_left for one in readings):
                continue
            rest = chain.steps[len(chain.steps) - resolved.steps_left :]
            if is_socket(resolved.missing):
                found = self._removed.of_member(resolved.owner, resolved.missing) or self._removed.of_socket(
                    resolved.owner, resolved.missing, chain.root
                )
            else:
                lost = (
                    self._removed.of_member(owner, resolved.missing)
                    for owner in resolved.owners or (resolved.owner,)
                )
                found = next(filter(None, lost), None)
                is_telling_name = resolved.fit >= 1.0 or is_telling(resolved.missing)
                if not found and is_telling_name and not self._fits_today(chain.root, resolved.missing):
                    found = self._removed.below(resolved.owner, resolved.missing, chain.root)
            if found:
                return OldName(found, rest[1:])
        return None

    def _fits_today(self, variable: str, name: str) -> bool:
        """Whether a class that a variable is named after has a property of some name."""
        owners = (entry.owner for entry in self._reader.names.by_name(name) if entry.kind == "property")
        return any(variable_fit(variable, last_name(owner)) >= _NAMED_AFTER for owner in owners)

    def _socket(self, chain: Chain) -> OldName | None:
        """A removed socket, ``bsdf.inputs["Transmission"]``, of a node that only the variable's name tells."""
        for number, (before, step) in enumerate(zip(chain.steps, chain.steps[1:], strict=False)):
            if step.kind == "key" and before.text in SIDES:
                nodes = usual_classes(chain.root)
                if any(
                    key(chain.root) in key(entry.owner) for entry in self._reader.names.by_name(step.text)
                ):
                    return None
                paths = self._reader.history.removed_by_key(key(f'{before.text}["{step.text}"]'))
                for path in paths:
                    node = socket_node(path)
                    named = number == 0 and (node in nodes or key(chain.root) in key(node))
                    if named and (removed := self._removed.of_path(path)):
                        return OldName(removed, chain.steps[number + 2 :])
        return None

    def _of_last_part(self, chain: Chain, readings: Sequence[ResolvedChain]) -> OldName | None:
        """A removed member of what the last part of a variable's name tells: ``title_strip.align_x`` is a strip's.

        None where a class of that kind has the member today.
        """
        _, mark, last = chain.root.rpartition("_")
        if not (mark and chain.steps and chain.steps[0].kind == "attr"):
            return None
        for cls in usual_classes(last):
            if any(
                self._reader.descends(reading.symbols[0], cls) for reading in readings if reading.complete
            ):
                return None
            if removed := self._removed.below(cls, chain.steps[0].text, chain.root):
                return OldName(removed, chain.steps[1:])
        return None

    def _of_fitting_class(self, chain: Chain, readings: Sequence[ResolvedChain]) -> OldName | None:
        """A member of a removed class that the variable is named after: ``stroke.line_width`` of a GPencilStroke."""
        attribute = chain.steps[0] if chain.steps and chain.steps[0].kind == "attr" else None
        short = len(chain.root.strip("_0123456789")) < _SHORTEST
        if (
            attribute is None
            or short
            or self._reader.entry(TYPES + chain.root)  # a class is named, and no variable after one
            or any(key(last_name(cls)) == key(chain.root) for cls in usual_classes(chain.root))
            or any(reading.complete and reading.fit >= _LIKELY_FIT for reading in readings)
        ):
            return None
        owners = [
            (variable_fit(chain.root, path.removesuffix(f".{attribute.text}").removeprefix(TYPES)), path)
            for path in self._removed.paths_named(attribute.text)
            if path.startswith(TYPES) and not self._reader.entry(path.rpartition(".")[0])
        ]
        fit, path = max(owners, default=(0.0, ""))
        # A class of today that has the member and fits as well is meant.
        today = [reading.symbols[0] for reading in readings if reading.complete]
        today += [
            entry.owner for entry in self._reader.names.by_name(attribute.text) if entry.kind == "property"
        ]
        best = max((variable_fit(chain.root, last_name(cls)) for cls in today), default=0.0)
        removed = self._removed.of_path(path) if fit >= max(_NAMED_AFTER, best + _BETTER) else None
        # The class that took its place may have the member, too.
        if removed is None or any(target.endswith(f".{attribute.text}") for target in removed.targets):
            return None
        return OldName(removed, chain.steps[1:])

    def _of_any_class(self, chain: Chain, readings: Sequence[ResolvedChain]) -> OldName | None:
        """A member that no class has any more, of a variable that may be anything, or by itself; or one that a variable
        is called as, ``file_slots.new()``.
        """
        own = chain.root in {"self", "cls"} or chain.root[:1].isupper()
        if own or any(reading.fit >= USUAL for reading in readings):
            return None
        is_name = bool(chain.steps) and is_telling(chain.root) and not self._reader.names.by_name(chain.root)
        if is_name and (removed := self._likeliest(chain.root, chain.root)):
            return OldName(removed, chain.steps)
        names = [(number, step.text) for number, step in enumerate(chain.steps, 1) if step.kind == "attr"]
        for number, name in names if chain.steps else [(0, chain.root)]:
            if self._reader.names.by_name(name):
                return None
            if (is_telling(name) or _is_set_to_item(chain)) and (
                removed := self._likeliest(name, chain.root if number == 1 else "")
            ):
                return OldName(removed, chain.steps[number:])
        return None

    def _likeliest(self, name: str, variable: str) -> RemovedSymbol | None:
        """Of the classes that had a member of that name the likeliest one's: what is known to be replaced first.

        An unknown variable's member may be the script's own: only what a source tells of is believed to be Blender's.
        """
        removed = filter(
            None, (self._removed.of_path(f"{owner}.{name}") for owner in self._owners(name, variable))
        )
        known = [symbol for symbol in removed if symbol.successors or not variable]
        weights = self._reader.usage.weights({symbol.path.rpartition(".")[0] for symbol in known})
        return min(
            known,
            key=lambda symbol: (
                not symbol.successors,
                -weights.get(symbol.path.rpartition(".")[0], 0.0),
                len(symbol.path),
            ),
            default=None,
        )

    def _owners(self, name: str, variable: str) -> list[str]:
        """The classes that had a member of that name, the likeliest first; none where that is anybody's guess."""
        paths = [
            path for path in self._removed.paths_named(name) if path.startswith(TYPES) and _THEME not in path
        ]
        owners = [path.removesuffix(f".{name}") for path in paths]
        usual = usual_classes(variable)
        if named := [owner for owner in owners if owner in usual]:
            return named
        if fitting := [
            owner for owner in owners if variable_fit(variable, owner.removeprefix(TYPES)) >= _LIKELY_FIT
        ]:
            return fitting
        if len(owners) <= _MANY_OWNERS or not variable or self._went_alike(paths):
            return owners
        latest = self._lost_last(name, owners)
        return latest if len(latest) <= _MANY_OWNERS else []

    def _lost_last(self, name: str, owners: Iterable[str]) -> list[str]:
        """Those of some classes that had a member longest: who writes it remembers what was there last."""
        spans = {owner: self._reader.history.removed(f"{owner}.{name}") for owner in owners}
        last = {owner: version_key(span[1]) for owner, span in spans.items() if span and span[2]}
        return [owner for owner, version in last.items() if version == max(last.values())]

    def _went_alike(self, paths: Iterable[str]) -> bool:
        """Whether the same took the place of members of several classes, as of all kinds of strips."""
        ways = {
            (removed.gone, *(target.rpartition(".")[2] for target in removed.targets))
            for removed in filter(None, map(self._removed.of_path, paths))
        }
        return len(ways) == 1 and len(ways.pop()) > 1


def _is_set_to_item(chain: Chain) -> bool:
    """Whether a chain is a variable's attribute that is set to what only an enumeration takes: ``c.x = 'PATH'``."""
    return chain.assigned and len(chain.steps) == 1 and any(value.isupper() for value in chain.values)


def _old(chain: Chain, lost: LostName | None) -> OldName | None:
    """What was lost, with the steps of the chain behind it."""
    return OldName(lost.removed, chain.steps[lost.steps :]) if lost else None
