"""What the base knows of a name that this Blender lacks: when it went, what took its place, what it resembles."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

from kb_build.index.analysis import distinct_words, stem, words
from kb_build.symbols.api_names import CONTEXT, OPERATORS, SIDES, STRUCT, TYPES
from kb_build.symbols.paths import is_socket, last_name, plain_path
from kb_check.names.likely import by_label
from kb_serve.rank.meant_members import meant_members
from kb_serve.recognise.by_words.operator_words import OperatorWords, same_operator_words
from kb_serve.recognise.by_words.set_elsewhere import set_elsewhere
from kb_serve.recognise.elsewhere.layers import former_layer
from kb_serve.recognise.likely.corrections import by_first_word, is_misspelling, nearest, shortened
from kb_serve.recognise.likely.likely_keywords import likely_parameters
from kb_serve.recognise.named.enum_values import EnumValues
from kb_serve.recognise.named.names_of_new import NamesOfNew
from kb_serve.recognise.named.node_names import is_like_a_node, nodes_meant
from kb_serve.recognise.notes import Notes
from kb_serve.recognise.recognition import MissingName
from kb_serve.recognise.removed.removed_symbols import RemovedSymbolLookup, for_reading

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kb_serve.rank.search import Searcher
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbol

_MOST_NAMED = 3
_FEW_MEMBERS = 8
_KEPT = 512  # names that a class lacks, as one is often used many times
# Methods of all structures, which are plurals of what properties are called.
_PLURALS = frozenset({"items", "keys", "values"})
_COLLECTION = f"{TYPES}bpy_prop_collection"
_TURNING_ON = frozenset({"use", "show", "is", "has"})  # what the names of switches begin with
_PART = frozenset("([:")  # in the path of a parameter, a socket, an item


@dataclass(frozen=True, slots=True)
class Lacking:
    """What there is to say of a name that does not exist.

    ``replacement`` is the one path that takes its place with no other change (``sure``: by a source), or that it
    is a misspelling of; empty otherwise. ``instead`` are all that may be meant.
    """

    symbol: str
    message: str
    instead: tuple[str, ...] = ()
    replacement: str = ""
    sure: bool = False
    removed: bool = False


class KnownNames:
    """Looks up, in one base, what became of names."""

    def __init__(self, reader: BaseReader) -> None:
        self.reader = reader
        self._lookup = RemovedSymbolLookup(reader)
        self._notes = Notes(reader)
        self._operators = OperatorWords(reader)
        self._enum_values = EnumValues(reader)
        self.names_of_new = NamesOfNew(reader)
        self._member = lru_cache(maxsize=_KEPT)(self._former_member)
        self._lacking = lru_cache(maxsize=_KEPT)(self._lacking_member)

    @property
    def version(self) -> str:
        """The Blender of the base: ``5.1``."""
        return self.reader.meta.get("minor", "")

    def was(self, owner: str, name: str) -> bool:
        """Whether another Blender has a member that this one lacks; an operator may be named by its path."""
        path = name if name.startswith(OPERATORS) else f"{owner}.{name}"
        return self._lookup.of_path(path) is not None

    def addon_of(self, owner: str, name: str) -> str:
        """The add-on that registers a member of a class, or of one of its bases, or of a module: one that Blender
        brings and that is not on from the start; empty for none. An operator may be named by its path.
        """
        if name.startswith(OPERATORS):
            return self.reader.addon_names.get(name, "")
        owners = [owner, *(cls.path for cls in self.reader.lineage(owner))]
        return next(filter(None, (self.reader.addon_names.get(f"{cls}.{name}") for cls in owners)), "")

    def had(self, owner: str, name: str) -> bool:
        """Whether a class or module, or one of its bases, has a member in another Blender that it lacks in this one.

        Modules themselves have no owner.
        """
        return self._member(owner, name) is not None

    def had_value(self, path: str, value: str) -> bool:
        """Whether a property has a value in another Blender that it lacks in this one."""
        return self._lookup.of_path(f"{path}:{value}") is not None

    def successor(self, owner: str, name: str) -> str:
        """The path that surely takes the place of such a member with no other change; empty for none."""
        removed = self._member(owner, name)
        return self._removed(for_reading(removed)).replacement if removed else ""

    def _former_member(self, owner: str, name: str) -> RemovedSymbol | None:
        return self._lookup.of_member(owner, name) if owner else self._lookup.of_path(name)

    def _of_former(self, path: str, part: str) -> RemovedSymbol | None:
        """A part, ``(x)``, ``(x):X`` or ``.inputs["X"]``, of what a function, operator or node took the place of."""
        formers = self._formers.get(path, ())
        return next(filter(None, (self._lookup.of_path(former + part) for former in formers)), None)

    @cached_property
    def _formers(self) -> dict[str, list[str]]:
        """Path → what it takes the place of, alone or with others, where that is not a part of something."""
        found: dict[str, list[str]] = {}
        for path, target in self.reader.rows("SELECT path, target FROM successors ORDER BY position, path"):
            if not _PART.intersection(path + target):
                found.setdefault(target, []).append(path)
        return found

    def is_nowhere(self, name: str) -> bool:
        """Whether nothing in this Blender is called so."""
        return not self.reader.rows("SELECT 1 FROM symbols WHERE name = ? LIMIT 1", name)

    def member(self, owner: str, name: str, *, reading: bool = True) -> Lacking:
        """A member that a class or module lacks; ``reading`` unless it is assigned to."""
        return self._lacking(owner, name, reading=reading)

    def _lacking_member(self, owner: str, name: str, *, reading: bool) -> Lacking:
        removed = self._member(owner, name) or self._lookup.of_path(f"{owner}.{name}")
        removed = removed or self._lookup.below(owner, name)
        if removed:
            return self._removed(for_reading(removed) if reading else removed)
        layer = former_layer(owner, name)
        if layer and (removed := self._lookup.of_path(layer)):
            lacking = self._removed(removed)
            told = (
                f"`{owner}` has no `{name}` in Blender {self.version}: it was in a layer. {lacking.message}"
            )
            return Lacking(f"{owner}.{name}", told, lacking.instead)
        return self._never(owner, name, assigned=not reading)

    def path(self, path: str) -> Lacking | None:
        """What another Blender has under exactly this path; None for what none has."""
        removed = self._lookup.of_path(path)
        return self._removed(removed) if removed else None

    def parameter(self, function: str, name: str, names: Iterable[str], given: str = "") -> Lacking:
        """A keyword that a function or operator does not take; ``names`` are those that it takes, ``given`` is what is
        written for it.
        """
        part = f"({name})"
        if removed := self._lookup.of_part(function, part) or self._of_former(function, part):
            return self._removed_of(f"{function}(", removed, f"`{function}` takes no `{name}`")
        symbol = self.reader.symbol(function)
        similar = likely_parameters(symbol, name, given) if symbol else self._alike(name, names)
        lacking = self._no_part(function, name, names, f"`{function}` takes no `{name}`", "It takes", similar)
        elsewhere = set_elsewhere(symbol, name, self.reader) if symbol and not similar else ""
        message = f"{lacking.message} {elsewhere}".rstrip()
        return replace(lacking, symbol=f"{function}({name})", message=message)

    def changed_parameters(self, function: str) -> tuple[Lacking, ...]:
        """The parameters that a function had once, but for those that only got another name."""
        below = self.reader.rows(
            "SELECT path FROM removed WHERE path > ? AND path < ?", f"{function}(", f"{function})"
        )
        known = [self._lookup.of_path(path) for (path,) in below if path.endswith(")")]
        found = [self._removed(removed) for removed in known if removed and removed.gone]
        return tuple(lacking for lacking in found if not lacking.sure)

    def value(self, owner: str, value: str, values: Iterable[str]) -> Lacking:
        """A value that is none of an enumeration's; ``owner`` is the property, or ``function(parameter)``."""
        whole = plain_path(owner)
        part = f"{owner.removeprefix(whole)}:{value}"
        if removed := self._lookup.of_part(whole, part) or self._of_former(whole, part):
            beginning = whole + part[0]
            return self._removed_of(beginning, removed, f"`{owner}` takes no {value!r}")
        values = list(values)
        similar = self._enum_values.likely(owner, value, values)
        return self._no_part(
            owner, value, values, f"{value!r} is not a value of `{owner}`", "It takes", similar
        )

    def socket(self, node: str, name: str, names: Iterable[str], sides: Iterable[str] = SIDES) -> Lacking:
        """A socket that a node lacks; ``names`` are those that it has on the ``sides`` where it is asked for."""
        for side in sides:
            part = f'.{side}["{name}"]'
            if removed := self._lookup.of_path(node + part) or self._of_former(node, part):
                return self._removed_of(f"{node}.", removed, f"`{node}` has no socket {name!r}", "had")
        return self._no_part(node, name, names, f"`{node}` has no socket {name!r}", "It has")

    def still_works(self, path: str) -> str:
        """The symbol that one gets by a former name that this Blender still takes; empty where it does not."""
        return self.reader.history.still_works(path)

    def _removed(self, removed: RemovedSymbol) -> Lacking:
        targets = removed.targets or tuple(path for path, _ in removed.similar[:_MOST_NAMED])
        first = removed.successors[0] if removed.successors else None
        sure = bool(removed.targets) and len(removed.targets) == 1 and first is not None and not first.how
        replacement = removed.targets[0] if sure else ""
        sure = sure and not self._notes.setting_of(replacement)  # which is to be made first
        return Lacking(
            removed.path, self._notes.removed(removed), targets, replacement, sure=sure, removed=True
        )

    def _removed_of(self, beginning: str, removed: RemovedSymbol, lacks: str, did: str = "did") -> Lacking:
        """What is removed of something; ``lacks`` says so where what that took the place of ``did`` otherwise."""
        lacking = self._removed(removed)
        if removed.path.startswith(beginning):
            return lacking
        return replace(lacking, message=f"{lacks}, as what it took the place of {did}: {lacking.message}")

    def _never(self, owner: str, name: str, *, assigned: bool) -> Lacking:
        machinery = self.reader.members(STRUCT) if owner != STRUCT else {}
        names = [
            found
            for found in self.reader.member_names(owner)
            if found not in machinery or found not in _PLURALS
        ]
        if f"{owner}." == TYPES and is_like_a_node(name):
            found = [last_name(path) for path in nodes_meant(name, self.reader)]
        else:
            found = self._alike_members(owner, name, names)
        misspelt = [found for found in found if is_misspelling(name, found, self._vocabulary)]
        similar = [found for found in found if found not in machinery or found in misspelt]
        operators = [] if misspelt else self._operators.having(owner, name)
        of_kinds = "" if similar or operators else self._of_kinds(owner, name)
        if (
            operators
            and similar
            and not any(same_operator_words(last_name(path), name) for path in operators)
        ):
            operators = [*dict.fromkeys((*(f"{owner}.{one}" for one in similar), *operators))][:_MOST_NAMED]
        if operators:
            similar = [path.removeprefix(OPERATORS) for path in operators]
        elif methods := [] if misspelt else by_first_word(name, machinery):
            similar = [one for one, _ in nearest(name, methods, _MOST_NAMED)] or methods
        elif not (misspelt or of_kinds):
            labels = self._labels(owner) if owner.startswith(TYPES) else {}
            meant = self._meant(owner, name, assigned=assigned)
            # A class is called by what it is of first: what begins alike is meant rather than what says the same.
            meant = [*similar, *meant] if f"{owner}." == TYPES else meant
            begun = shortened(name, names) if owner.startswith(TYPES) else []
            similar = [*dict.fromkeys((*begun, *_likely(name, meant, similar, labels)))][:_MOST_NAMED]
        if switches := [one for one in _switches(name, names) if one not in similar]:
            similar, misspelt = [*switches, *similar][:_MOST_NAMED], [*switches, *misspelt]
        span = "" if self._lookup.paths_below(owner, name) else self._notes.never(owner, name)
        message = f"`{owner}` has no `{name}` in Blender {self.version}{span}."
        return Lacking(
            f"{owner}.{name}",
            message + (of_kinds or _closest(similar) or self._own(owner)),
            tuple(operators) or tuple(self._path_of(owner, found) for found in similar),
            f"{owner}.{misspelt[0]}" if len(misspelt) == 1 else "",
        )

    def _meant(self, owner: str, name: str, *, assigned: bool) -> list[str]:
        """What the search finds of a class or module by a name that it lacks; of its cases with theirs. Nothing of what
        has so few members that all are told, nor of the context, of which texts on all of Blender speak.
        """
        if not self.reader.entry(owner) or self._own(owner) or owner == CONTEXT:
            return []
        lineage = {owner, *(ancestor.path for ancestor in self.reader.lineage(owner))}
        missing = MissingName(name, owner, assigned=assigned)
        paths = meant_members(missing, self._searcher, self.reader).paths
        return [
            last_name(path) if path.rpartition(".")[0] in lineage else path.removeprefix(TYPES)
            for path in paths
            if not is_socket(path)
        ]

    @cached_property
    def _searcher(self) -> Searcher:
        """Loaded, with numpy, for the first name that nothing resembles."""
        from kb_serve.rank.search import Searcher  # noqa: PLC0415

        return self.reader.shared(Searcher)

    @staticmethod
    def _path_of(owner: str, found: str) -> str:
        return TYPES + found if "." in found else f"{owner}.{found}"

    def _labels(self, owner: str) -> dict[str, str]:
        """The names of a class's members, but for those of all structures, with what menus call them."""
        lineage = [ancestor.path for ancestor in self.reader.lineage(owner) if ancestor.path != STRUCT]
        return {
            name: member.label
            for cls in reversed(lineage)
            for name, member in self.reader.members(cls).items()
        }

    def _of_kinds(self, owner: str, name: str) -> str:
        """What a name is a misspelling of that classes below a class have, as kinds of modifiers do. A collection is
        of the one class that its property says.
        """
        if owner == _COLLECTION:
            return ""
        having: dict[str, str] = {}
        for cls in self.reader.descendants(owner):
            for member in self.reader.members(cls.path):
                having.setdefault(member, cls.name)
        similar = [found for found, _ in nearest(name, having, _MOST_NAMED)]
        misspelt = [found for found in similar if is_misspelling(name, found, self._vocabulary)]
        return (
            f" Closest: {', '.join(f'`{having[found]}.{found}`' for found in misspelt)}." if misspelt else ""
        )

    def _own(self, owner: str) -> str:
        """The members of a class that has few."""
        own = [member for member in self.reader.members(owner) if not member.startswith("bl_rna_")]
        return f" It has {listed(own)}." if 0 < len(own) <= _FEW_MEMBERS else ""

    def _no_part(  # noqa: PLR0913, PLR0917 - the parts of a sentence
        self,
        owner: str,
        name: str,
        names: Iterable[str],
        message: str,
        they: str,
        similar: list[str] | None = None,
    ) -> Lacking:
        """``similar`` are those that may be meant, by spelling where they are not given."""
        names = list(names)
        similar = self._alike(name, names) if similar is None else similar
        misspelt = [found for found in similar if is_misspelling(name, found)]
        told = _closest(similar) or (f" {they} {listed(names)}." if names else "")
        return Lacking(
            f"{owner}:{name}", f"{message} in Blender {self.version}.{told}", tuple(similar),
            misspelt[0] if len(misspelt) == 1 else "",
        )  # fmt: skip

    def _alike_members(self, owner: str, name: str, names: Sequence[str]) -> list[str]:
        """The members that a name is most like; of those of a class that are as like it, what counts most:
        ``selected_objects`` for ``selected``.
        """
        if not owner.startswith(TYPES):
            return self._alike(name, names)
        found = nearest(name, names, len(names))
        weights = self.reader.usage.weights([self._path_of(owner, one) for one, _ in found])
        found.sort(key=lambda row: (-row[1], -weights.get(self._path_of(owner, row[0]), 0.0)))
        return [one for one, _ in found[:_MOST_NAMED]]

    @staticmethod
    def _alike(name: str, names: Iterable[str]) -> list[str]:
        return [found for found, _ in nearest(name, names, _MOST_NAMED)]

    @cached_property
    def _vocabulary(self) -> set[str]:
        rows = self.reader.rows("SELECT DISTINCT name FROM symbols WHERE kind IN ('property', 'function')")
        return {word for word in distinct_words("\n".join(name for (name,) in rows)) if len(word) > 2}


def _likely(name: str, meant: list[str], similar: list[str], labels: dict[str, str]) -> list[str]:
    """The names that may be meant: those that menus call so, those that are meant by their words (``meant``), those
    that are spelt alike, those that begin alike.
    """
    exact, partly = by_label(name, labels)
    found = dict.fromkeys((*exact, *meant, *similar, *partly))
    return list(found)[:_MOST_NAMED] or by_first_word(name, labels)


def _switches(name: str, names: Iterable[str]) -> list[str]:
    """What turns on what a name says: ``use_denoising``, for ``denoise``."""
    said = [stem(word) for word in words(name)]
    return [
        one for one in names if (spoken := words(one))[0] in _TURNING_ON and [*map(stem, spoken[1:])] == said
    ]


def _closest(names: list[str]) -> str:
    return f" Closest: {listed(names)}." if names else ""


def listed(names: Sequence[str]) -> str:
    """Names in a message: the first ones, and how many there are."""
    more = f" … ({len(names)} in all)" if len(names) > 8 else ""
    return ", ".join(f"`{name}`" for name in names[:8]) + more
