"""Says what may have been None before a member, where a message tells the member alone."""

from __future__ import annotations

import re
from collections import defaultdict
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

from kb_build.index.analysis import terms
from kb_build.symbols.api_names import OPERATORS, TYPES
from kb_build.symbols.flag_names import FILLED_BY, NEVER_NONE, READ_ONLY, RETURNS_NONE
from kb_build.symbols.flags import empty_when_new, fillers
from kb_serve.recognise.chains.bindings import with_bindings
from kb_serve.recognise.chains.chains import find_chains
from kb_serve.recognise.chains.variables import usual_classes
from kb_serve.recognise.messages.absent import ANY, WEIGHTY, is_empty_when_new
from kb_serve.recognise.messages.outside_areas import OF_AN_AREA, OUTSIDE, SPACE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain
    from kb_serve.recognise.messages.absent import Absent
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbol, RemovedSymbolLookup

_FEW = 3
_IS_READ = 0.98  # how sure what may be None is that the code reads the name of: before what it then lacks
_OFTEN = 6.0  # the weight from which on scripts use a pointer often
_MANY = 8  # where more properties may be None, none is likely enough to be named
_MODIFIER = f"{TYPES}Modifier"
_MAKES_MODIFIERS = f"{TYPES}ObjectModifiers.new"
TAKES_NO_MODIFIER = (
    "`obj.modifiers.new(…)` returns None, without an error, where an object of that type takes no such modifier: an "
    "empty, a light or a camera takes none at all, and a Grease Pencil object its own."
)
_CHANNELBAG = f"{TYPES}ActionKeyframeStrip.channelbag"
_BAG = re.compile(r"bag\b", re.IGNORECASE)
_OF_BAG = frozenset({"fcurves", "groups"})
_NO_BAG = (
    "`strip.channelbag(slot)` is None until the slot has one in the strip: `strip.channelbag(slot, ensure=True)` makes "
    "it, as the first keyframe does."
)
_OF_CONTEXT = frozenset({"bpy", "context", "C"})  # of which is told what it lacks where
_IS_SET = "no __dict__ for setting new attributes"  # which tells that it was to be set
_IS_NONE = "The object before `.{name}`{of} is None: it does not exist (yet), or was not found."


class NoneBefore:
    """Finds in one base what may have been None."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup, absent: Absent) -> None:
        self._reader = reader
        self._removed = removed
        self._absent = absent
        # class → the pointers to it that are None on new things
        self._empty: dict[str, list[SymbolEntry]] = {}

    def explain(self, name: str, query: str, recognition: Recognition) -> None:
        """Adds what may have been None before ``.name``: pointers to classes that have the name, or once had it, what
        the context gives, and look-ups by name. Where the code calls what gives None, that alone.
        """
        chains = with_bindings(query, find_chains(query))
        is_told = self._tell_of_bag(name, query, recognition) or self._tell_of_call(name, chains, recognition)
        if is_told or self._tell_read(name, chains, recognition):
            return
        is_set = _IS_SET in query
        owners = {
            entry.owner.removeprefix(TYPES)
            for entry in self._reader.names.by_name(name)
            if entry.kind in {"property", "function"}
            and entry.owner.startswith(TYPES)
            and entry.group != "ui"
            and not (is_set and self._is_flagged(entry, READ_ONLY))
        }
        gone = [] if owners else self._once(name)
        for removed in gone:
            recognition.add_removed(removed)
            owners.add(removed.path.rpartition(".")[0].removeprefix(TYPES))
        read = {(first.text, second.text) for chain in chains for first, second in pairwise(chain.steps)}
        around = set(terms(query))
        named_first = sorted(owners, key=lambda owner: (not around.issuperset(terms(owner)), owner))
        holders = [entry for owner in named_first[:_MANY] for entry in self._holders(owner)]
        likely = [
            entry for entry in holders if set(terms(f"{entry.owner} {entry.name}")) <= around | {"type"}
        ]
        told = set(likely)  # of these is said what fills them
        usual = None if likely or gone else self._usual(name, owners)
        if usual and self._absent.in_context(usual.owner):
            self._tell_absent(usual, recognition)
            return
        few = len(owners) <= _FEW
        if few and len(holders) <= _MANY and (not usual or self._are_used(holders)):
            likely = likely or holders
        elif not few and len(owners) <= _MANY and not likely:
            likely = [entry for entry in holders if self._is_flagged(entry, FILLED_BY)]
            told = set(self._reader.usage.heaviest(likely)[:1])
        if not likely:
            likely = self._empty_before(name, owners)
            told = set(likely)
        if usual and not likely:
            self._tell_usual(usual, owners, recognition)
            return
        self._tell(name, owners, holders, recognition)
        for rank, entry in enumerate(self._reader.usage.heaviest(likely)[:_FEW]):
            is_read = (entry.name, name) in read  # in the code beside the message
            recognition.add(entry.path, _IS_READ if is_read else 0.86 - 0.01 * rank, "may be None")
            if not gone:
                recognition.add(f"{TYPES}{entry.target}.{name}", 0.81 - 0.01 * rank, "attribute of None")
            if (few or entry in told) and (filled := self._filled(entry)):
                recognition.notes.append(filled)
            elif entry in told and (setting := self._setting(entry)):
                recognition.notes.append(f"`{entry.path}` is None on what is new: set it, `{setting}`.")
        if self._is_of_an_area(likely, owners):
            recognition.notes.append(OUTSIDE)

    def _tell_of_bag(self, name: str, query: str, recognition: Recognition) -> bool:
        """Adds what gives the channelbag of a slot, where that is None; whether the code reads something of one."""
        is_read = name in _OF_BAG and bool(_BAG.search(query)) and self._reader.entry(_CHANNELBAG) is not None
        if is_read:
            recognition.add(_CHANNELBAG, _IS_READ, "may be None")
            recognition.notes += (_IS_NONE.format(name=name, of=""), _NO_BAG)
        return is_read

    def _read_in_code(self, name: str, chains: Sequence[Chain]) -> SymbolEntry | None:
        """The pointer that the code reads ``.name`` of, on a variable: ``material`` of ``slot.material.name``; that of
        what the variable is named after, else the one that counts most. None where it is no pointer, or never None.
        """
        for chain in chains:
            steps = [step for step in chain.steps if step.kind == "attr"]
            if chain.root in _OF_CONTEXT or len(steps) != len(chain.steps):
                continue
            for first, second in pairwise(steps):
                if second.text != name:
                    continue
                pointers = [
                    one
                    for one in self._reader.names.by_name(first.text)
                    if one.type == "pointer"
                    and one.group != "ui"
                    and not self._is_flagged(one, NEVER_NONE)
                    and self._reader.member_of(f"{TYPES}{one.target}", name)
                ]
                owners = usual_classes(chain.root) if first is steps[0] else []
                own = [one for one in pointers if one.owner in owners]
                if found := self._reader.usage.heaviest(own or pointers):
                    return found[0]
        return None

    def _tell_read(self, name: str, chains: Sequence[Chain], recognition: Recognition) -> bool:
        """Adds a pointer of the code that is None, and what fills it; whether there is one."""
        held = self._read_in_code(name, chains)
        if held is None:
            return False
        recognition.add(held.path, _IS_READ, "may be None")
        recognition.notes.append(_IS_NONE.format(name=name, of=f", `{held.path}`,"))
        if filled := self._filled(held):
            recognition.notes.append(filled)
        elif setting := self._setting(held):
            recognition.notes.append(f"Set it, `{setting}`, or test it before it is read.")
        else:
            recognition.notes.append(f"Test `.{held.name}` before it is read.")
        return True

    def _is_of_an_area(self, likely: Sequence[SymbolEntry], owners: set[str]) -> bool:
        """Whether what may be None is what the context has in an area alone, or mostly what areas show has the name."""
        spaces = sum(self._reader.descends(f"{TYPES}{owner}", SPACE) for owner in owners)
        return not OF_AN_AREA.isdisjoint(entry.path for entry in likely) or 2 * spaces > len(owners)

    def _tell_of_call(self, name: str, chains: Sequence[Chain], recognition: Recognition) -> bool:
        """Adds the call in the code that gives None, or gave it here; whether there is one."""
        if method := self._returning_none(name, chains):
            recognition.notes.append(
                f"`{method}` changes its own value and returns None: read it in a line of its own."
            )
            recognition.add(method, _IS_READ, "error message")
        elif self._makes_modifier(name, chains):
            self._tell_of_modifiers(name, recognition)
        else:
            return False
        return True

    def _makes_modifier(self, name: str, chains: Sequence[Chain]) -> bool:
        """Whether the code beside a message makes a modifier, and reads or sets its ``.name``."""
        texts = ([step.text for step in chain.steps] for chain in chains)
        return any(
            name in steps and {"modifiers", "new"} <= set(steps[: steps.index(name)]) for steps in texts
        )

    def _are_modifiers(self, owners: set[str]) -> bool:
        """Whether it is mostly modifiers that have a name, and many."""
        modifiers = [owner for owner in owners if self._reader.descends(TYPES + owner, _MODIFIER)]
        return len(owners) > _MANY and 2 * len(modifiers) >= len(owners)

    def _tell_usual(self, member: SymbolEntry, owners: set[str], recognition: Recognition) -> None:
        """Adds what is likeliest None before a name that many things have: a modifier that was not made, or what is
        not there of those that scripts use most.
        """
        if self._are_modifiers(owners):
            self._tell_of_modifiers(member.name, recognition)
        else:
            self._tell_absent(member, recognition)

    def _tell_of_modifiers(self, name: str, recognition: Recognition) -> None:
        recognition.notes += (_IS_NONE.format(name=name, of=""), TAKES_NO_MODIFIER)
        recognition.add(_MAKES_MODIFIERS, _IS_READ, "may be None")

    def _are_used(self, holders: list[SymbolEntry]) -> bool:
        weights = self._reader.usage.weights([entry.path for entry in holders])
        return max(weights.values(), default=0.0) >= _OFTEN

    def _tell_absent(self, member: SymbolEntry, recognition: Recognition) -> None:
        """Adds where a thing with this member comes from that may be None."""
        mostly = "Often" if member.owner in ANY else f"It may be a `{member.owner}`"
        recognition.notes.append(_IS_NONE.format(name=member.name, of=""))
        recognition.notes.append(f"{mostly}: {self._absent.note(member.owner)}.")
        for rank, path in enumerate(self._absent.sources(member.owner)):
            recognition.add(path, 0.86 - 0.01 * rank, "may be None")
        recognition.add(member.path, 0.81, "attribute of None")

    def _usual(self, name: str, owners: set[str]) -> SymbolEntry | None:
        """The member of that name which scripts use most, if it is one of some classes, and a thing may be absent."""
        usual = self._absent.usual(name)
        return usual if usual and usual.owner.removeprefix(TYPES) in owners else None

    def _empty_before(self, name: str, owners: set[str]) -> list[SymbolEntry]:
        """The likeliest pointers that are None on new things, and lead to what has a member of that name, once filled:
        the member of one of some classes.

        Empty where that leads to too many classes. Without those to a class whose member scripts use far less than
        another's: then they say nothing.
        """
        members = {
            target: self._reader.member_of(TYPES + target, name) for target in self._that_may_have(name)
        }
        having = {
            target: one.path
            for target, one in members.items()
            if one
            and one.group != "ui"
            and one.owner.removeprefix(TYPES) in owners
            and self._empty_pointers(target)
        }
        if not 0 < len(having) <= _MANY:
            return []
        weights = self._reader.usage.weights([entry.path for entry in self._reader.names.by_name(name)])
        least = max(weights.values(), default=0) / 2
        usual = {target for target, path in having.items() if weights.get(path, 0) >= least}
        empty = (entry for target in usual for entry in self._empty_pointers(target))
        found = self._reader.usage.heaviest(sorted(empty, key=lambda entry: entry.path))
        weights = self._reader.usage.weights([entry.path for entry in found])
        least = max(WEIGHTY, max(weights.values(), default=0) / 2)
        return [entry for entry in found if weights.get(entry.path, 0) >= least]

    def _that_may_have(self, name: str) -> set[str]:
        """The classes that pointers lead to, of those with a member of that name and of the classes below them."""
        owners = {entry.owner for entry in self._reader.names.by_name(name)}
        below = {cls.path for owner in owners for cls in self._reader.descendants(owner)}
        return {path.removeprefix(TYPES) for path in owners | below} & self._pointers.keys()

    @cached_property
    def _pointers(self) -> dict[str, list[SymbolEntry]]:
        """Class → the pointers that lead to it."""
        found: dict[str, list[SymbolEntry]] = defaultdict(list)
        for entry in self._reader.pointers():
            found[entry.target].append(entry)
        return dict(found)

    def _empty_pointers(self, target: str) -> list[SymbolEntry]:
        """The pointers to a class that are None on new things, of which it is known how they are filled.

        None of a class that many point to (objects, materials): scripts fill these as a matter of course.
        """
        if target not in self._empty:
            empty = [
                entry
                for entry in self._pointers[target]
                if entry.group != "ui" and is_empty_when_new(entry.path, self._reader)
            ]
            self._empty[target] = [
                entry
                for entry in empty
                if len(empty) <= _MANY
                and entry.owner != TYPES + target
                and (self._is_flagged(entry, FILLED_BY) or self._setting(entry))
            ]
        return self._empty[target]

    def _setting(self, entry: SymbolEntry) -> str:
        """The statement that sets a pointer which is None on new things; empty for other pointers."""
        symbol = self._reader.symbol(entry.path)
        if symbol is None or READ_ONLY in symbol.flags or not empty_when_new(symbol):
            return ""
        made = self._reader.makers.creations([TYPES + entry.target]).get(TYPES + entry.target)
        is_value = made is not None and not made.maker.startswith(OPERATORS)  # operators return no thing
        value = made.call if made and is_value else entry.target.lower()
        return f"{entry.owner.removeprefix(TYPES).lower()}.{entry.name} = {value}"

    def _tell(
        self, name: str, owners: set[str], holders: list[SymbolEntry], recognition: Recognition
    ) -> None:
        """Notes that something was None, and where only one class has the name, of which class, held by what."""
        of = may_be = ""
        if len(owners) == 1:
            of = f", a `{TYPES}{next(iter(owners))}`,"
            # What is None on new things is likelier None than what hardly ever is.
            likeliest = sorted(
                self._reader.usage.heaviest(holders),
                key=lambda entry: not is_empty_when_new(entry.path, self._reader),
            )
            listed = ", ".join(f"`{entry.path}`" for entry in likeliest[:_FEW])
            may_be = f" One is reached by {listed}." if listed else ""
        recognition.notes.append(_IS_NONE.format(name=name, of=of) + may_be)

    def _holders(self, cls: str) -> list[SymbolEntry]:
        """The pointers that may lead to an instance of a class, and may be None; those to itself only if no others."""
        below = self._reader.subclasses(TYPES + cls)
        kinds = [entry.name for entry in self._reader.lineage(TYPES + cls) if entry.path not in ANY]
        kinds += [entry.name for entry in below] if len(below) <= _MANY else []
        holders = [
            entry
            for kind in kinds
            for entry in self._reader.pointing_at(kind)
            if entry.group != "ui" and not self._is_flagged(entry, NEVER_NONE)
        ]
        return [entry for entry in holders if entry.owner != TYPES + cls] or holders

    def _returning_none(self, name: str, chains: Sequence[Chain]) -> str:
        """The method that is called before ``.name`` and returns None; empty for none."""
        for chain in chains:
            for (first, call), (_, last) in pairwise(pairwise(chain.steps)):
                if call.kind == "call" and last.text == name:
                    found = [
                        entry
                        for entry in self._reader.names.by_name(first.text)
                        if self._gives_none(entry.path)
                    ]
                    having = (entry for entry in found if self._reader.member_of(entry.owner, name))
                    if one := next(having, None) or next(iter(found), None):
                        return one.path
        return ""

    def _gives_none(self, path: str) -> bool:
        symbol = self._reader.symbol(path)
        return symbol is not None and RETURNS_NONE in symbol.flags

    def _once(self, name: str) -> list[RemovedSymbol]:
        """The removed data members of that name, if few: those with a successor first."""
        paths = [path for path in self._removed.paths_named(name) if path.startswith(TYPES)]
        if len(paths) > _MANY:
            return []
        found = list(filter(None, map(self._removed.of_path, paths)))
        return sorted(found, key=lambda removed: not removed.successors) if len(found) <= _FEW else []

    def _filled(self, entry: SymbolEntry) -> str:
        """A sentence on the calls before which a pointer is None; empty where none is known."""
        symbol = self._reader.symbol(entry.path)
        calls = ", then ".join(f"`{call}`" for call in fillers(symbol)) if symbol else ""
        return f"`{entry.path}` is None before {calls}." if calls else ""

    def _is_flagged(self, entry: SymbolEntry, flag: str) -> bool:
        """Whether one of a symbol's flags begins so."""
        symbol = self._reader.symbol(entry.path)
        return symbol is not None and symbol.flagged(flag) != ()
