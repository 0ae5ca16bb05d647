"""Tells what code names that is not there: an expression that leads to Blender's API and breaks off."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.api_names import OPERATORS, TYPES
from kb_build.symbols.unlisted import SOMETIMES
from kb_serve.recognise.chains.chain_starts import ROOTS
from kb_serve.recognise.chains.chains import ChainStep
from kb_serve.recognise.chains.subscripts import MODIFIER_PROPERTIES, PROPERTIES_OF_MODIFIER
from kb_serve.recognise.chains.variables import OTHERWISE, USUAL, is_guess, usual_classes
from kb_serve.recognise.code.python_methods import is_of_texts
from kb_serve.recognise.elsewhere.elements import ADDING, elsewhere, meant_by_key
from kb_serve.recognise.elsewhere.holders import of_collection
from kb_serve.recognise.elsewhere.members_within import of_elements
from kb_serve.recognise.recognition import MissingName

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.chains.chains import Chain
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.old_code import OldCode
    from kb_serve.recognise.resolver import ResolvedChain, Resolver

CLEAR = 0.85  # fit of a variable's name that hardly means another class
LEAST = 0.1  # fit below which neither the variable's name nor its member tells the class
LIKELY = 0.5  # readings with less than this share of the best one's fit are ignored
_BEFORE_UNKNOWN = 0.93  # how sure a function is of whose result nothing is known
_OF_ELEMENTS = 0.97  # … a member that elements have of a collection without it
_KNOWN_ELEMENT = 0.96  # how sure the class of an element is that lacks a name, before others that have it

# Classes whose members are defined by scripts and add-ons.
_OF_OPERATORS = "OperatorProperties"
_OPEN = frozenset({_OF_OPERATORS, "Operator", "PropertyGroup", "AddonPreferences", "Context"})


def is_clear(chain: Chain, resolved: ResolvedChain) -> bool:
    """Whether it is as good as certain what a chain begins with: a path, or a variable that all scripts call so."""
    named = resolved.symbols[0].rpartition(".")[2] == chain.root or chain.root in {"bpy", *ROOTS}
    return resolved.fit >= OTHERWISE and (named or bool(usual_classes(chain.root)))


def likeliest_broken(chain: Chain, readings: Iterable[ResolvedChain]) -> ResolvedChain | None:
    """Of the readings that break off, of those that suit the variable best the one that leads furthest.

    Where those lack the first name already, one that leads further is likelier.
    """
    broken = [resolved for resolved in readings if resolved.missing]
    best = max((resolved.fit for resolved in broken), default=0.0)
    likely = [resolved for resolved in broken if resolved.fit >= CLEAR * best]
    further = [
        resolved for resolved in broken if resolved.steps_left < len(chain.steps) and resolved.fit >= LEAST
    ]
    if further and all(resolved.steps_left == len(chain.steps) for resolved in likely):
        likely = further
    return min(likely, key=lambda resolved: (resolved.steps_left, -resolved.fit), default=None)


def _may_have(owner: SymbolEntry, chain: Chain, name: str) -> bool:
    """Whether what a chain leads to may have a name that the base does not list: ``obj.name.startswith``."""
    return (
        owner.kind == "function"  # what it gives is not known
        or (owner.kind == "property" and hasattr(str, name))
        or (owner.kind == "module" and name.startswith("_"))
        or (owner.group == "ui" and owner.name == chain.root)  # panels and menus are written in Python
        or owner.name == _OF_OPERATORS  # which operator is not said
        or name in SOMETIMES.get(owner.path, ())
    )


def _only_ends_like(chain: Chain, owner: str) -> bool:
    """Whether the name of a class in a text is not that of some class of Blender's, however it is spelled."""
    return chain.root == chain.variable and key(chain.root) != key(owner.rpartition(".")[2])


class BrokenExpressions:
    """Tells, by one base, what expressions lack."""

    def __init__(self, reader: BaseReader, resolver: Resolver, old: OldCode) -> None:
        self._reader = reader
        self._resolver = resolver
        self._old = old

    def tell(self, chain: Chain, resolved: ResolvedChain, later: float, recognition: Recognition) -> None:
        """Adds a chain as far as it could be resolved, and its missing name."""
        if resolved.owner == MODIFIER_PROPERTIES:
            recognition.missing.append(MissingName(resolved.missing, resolved.owner))
            recognition.add(PROPERTIES_OF_MODIFIER, _KNOWN_ELEMENT - later, "owner")
            return
        is_element = self._is_element(chain, resolved, later, recognition)
        owner = self._reader.entry(resolved.owner)
        # Of what a function gives that is read nothing may be known.
        if owner and owner.kind == "function" and resolved.fit >= LIKELY:
            recognition.add(resolved.owner, _BEFORE_UNKNOWN - later, "on the way")
        if self._says_nothing(chain, resolved) or (not is_element and self._is_custom(chain, resolved)):
            return
        assigned = chain.assigned and resolved.steps_left == 1
        sure = self._is_sure(chain, resolved)
        behind = chain.steps[len(chain.steps) - resolved.steps_left + 1 :]
        called = bool(behind) and behind[0].kind == "call"
        if called and not is_element:
            self._tell_elsewhere(resolved, later, recognition)
        if not is_element:
            self._tell_of_elements(resolved, later, recognition)
        if not is_element and not self._is_told(resolved, recognition):
            certain = self._leads_there_alone(chain, resolved)
            variable = "" if certain or is_clear(chain, resolved) else chain.root
            told = certain or resolved.fit >= LIKELY or (called and resolved.missing in ADDING)
            owner_path, name = resolved.owner, resolved.missing
            if f"{owner_path}." == OPERATORS and behind and behind[0].kind == "attr":
                # A module that is not there: what is meant is told by its operator.
                owner_path, name = f"{OPERATORS}{name}", behind[0].text
            missing = MissingName(name, owner_path, assigned, sure, called, variable, told)
            recognition.missing.append(missing)
            if self._is_known_element(chain, resolved):
                recognition.add(resolved.owner, _KNOWN_ELEMENT - later, "owner")
        for step, symbol in enumerate(reversed(resolved.symbols)):
            socket = step == 0 and symbol.endswith(
                '"]'
            )  # one that takes no value of its own is still what was meant
            recognition.add(symbol, (0.93 if socket else 0.45 - 0.05 * step) - later, "on the way")

    def _says_nothing(self, chain: Chain, resolved: ResolvedChain) -> bool:
        """Whether a name may be right that was not found: no class is known, or it has what a script gives it."""
        owner = self._reader.entry(resolved.owner)
        is_definition = chain.assigned and resolved.steps_left == 1
        return (
            (resolved.fit < 1.0 and is_guess(chain.root) and not self._leads_there_alone(chain, resolved))
            # A class of the script's, or one that it imports, which only ends like one of Blender's.
            or (resolved.fit < 1.0 and chain.root[:1].isupper() and _only_ends_like(chain, resolved.owner))
            or resolved.missing.startswith("__")  # every class and module has such names
            or self._is_indexed(chain, resolved)
            # ``bl_idname = "object.my_operator"``
            or (chain.quoted and chain.root != "bpy")
            # ``bpy.types.Scene.my_property = …``
            or (is_definition and chain.dotted.startswith((TYPES, "types.")) and len(resolved.symbols) == 1)
            # ``value.upper()``: a variable holds a text, whatever it is called.
            or (
                chain.root not in ROOTS
                and len(resolved.symbols) == 1
                and is_of_texts(resolved.missing, self._reader)
            )
            # A variable called ``context`` may hold a dictionary.
            or (resolved.missing.startswith("[") and len(resolved.symbols) == 1 and chain.root != "bpy")
            or (owner is not None and _may_have(owner, chain, resolved.missing))
        )

    def _leads_there_alone(self, chain: Chain, resolved: ResolvedChain) -> bool:
        """Whether all that an attribute can be which a variable is asked for is of the class that lacks the next one:
        ``x.field.missing``, as every ``field`` is of FieldSettings.
        """
        match chain.steps:
            case (ChainStep("attr", name), ChainStep("attr", missing), *_) if missing == resolved.missing:
                named = self._reader.names.by_name(name)
            case _:
                return False
        led_to = {f"{TYPES}{entry.target}" for entry in named if entry.group != "ui"}
        return led_to == {resolved.owner} and all(entry.type == "pointer" for entry in named)

    def _is_custom(self, chain: Chain, resolved: ResolvedChain) -> bool:
        """Whether a name is read of a custom property, which may hold anything: ``strip["files"].sort()``."""
        place = len(chain.steps) - resolved.steps_left - 1
        if resolved.missing.startswith("[") or place < 0 or chain.steps[place].kind != "key":
            return False
        return resolved.owner == resolved.symbols[-1] and not self._is_known_element(chain, resolved)

    def _is_known_element(self, chain: Chain, resolved: ResolvedChain) -> bool:
        """Whether a name is missing on an element of a collection whose key tells its class: ``modifiers["Bevel"]``."""
        if (
            len(resolved.symbols) < 2
            or resolved.owner != resolved.symbols[-1]
            or resolved.missing.startswith("[")
        ):
            return False
        place = len(chain.steps) - resolved.steps_left - 1
        held = self._reader.entry(resolved.symbols[-2])
        is_element = held is not None and held.type == "collection"
        return is_element and place >= 0 and chain.steps[place].kind in {"key", "call"}

    def _is_indexed(self, chain: Chain, resolved: ResolvedChain) -> bool:
        """Whether a variable is no instance of the class that its name tells, as it is indexed or called."""
        root = self._reader.entry(resolved.symbols[0])
        is_class = root is not None and root.kind == "class" and len(resolved.symbols) == 1
        return is_class and chain.root[:1].islower() and chain.steps[0].kind in {"index", "call"}

    def _is_element(
        self, chain: Chain, resolved: ResolvedChain, later: float, recognition: Recognition
    ) -> bool:
        """Adds what a chain leads to that looks up an element in what only has the collection of them."""
        holder = self._reader.entry(resolved.symbols[-1])
        place = len(chain.steps) - resolved.steps_left - (not resolved.missing.startswith("["))
        if holder is None or place < 0 or chain.steps[place].kind != "key":
            return False
        collection = meant_by_key(f"{TYPES}{holder.target}" if holder.target else holder.path, self._reader)
        meant = self._resolver.onward(collection.path, chain.steps[place:]) if collection else None
        if collection is None or meant is None or not meant.complete:
            return False
        key_of = f'["{chain.steps[place].text}"]'
        recognition.notes.append(
            f"`{key_of}` is none of the {collection.label.lower()} of a `{collection.owner}`: those are in its "
            f"`{collection.name}`, `.{collection.name}{key_of}`."
        )
        recognition.add(meant.symbols[-1], 0.96 - later, "expression")
        return True

    def _tell_elsewhere(self, resolved: ResolvedChain, later: float, recognition: Recognition) -> None:
        """Adds what does what a collection lacks a function for."""
        path, name = resolved.symbols[-1], resolved.missing
        other = elsewhere(path, name, self._reader)
        for one in [other] if other else of_collection(path, name, self._reader):
            recognition.notes.append(one.how)
            recognition.add(one.path, 0.96 - later, "expression")

    def _tell_of_elements(self, resolved: ResolvedChain, later: float, recognition: Recognition) -> None:
        """Adds the member of that name which the elements have of a collection that lacks it, and that makes none by
        another name.
        """
        holder = self._reader.entry(resolved.symbols[-1])
        if holder is None or holder.type != "collection" or not resolved.missing.isidentifier():
            return
        own = self._reader.members(f"{TYPES}{holder.collection}") if holder.collection else {}
        if resolved.missing in ADDING and not ADDING.isdisjoint(own):
            return
        of_other = resolved.owner == f"{TYPES}{holder.target}"  # an element was read, which lacks it
        if not of_other and (found := of_elements(holder, resolved.missing, self._reader)):
            recognition.add(found.member.path, _OF_ELEMENTS - later, "within")
            recognition.notes.append(found.note)

    def _is_told(self, resolved: ResolvedChain, recognition: Recognition) -> bool:
        """Whether the message beside the code says already that the name is missing, on a kind of the class."""
        return any(
            missing.name == resolved.missing and self._reader.descends(missing.owner, resolved.owner)
            for missing in recognition.missing
        )

    def _is_sure(self, chain: Chain, resolved: ResolvedChain) -> bool:
        """Whether the owner of a missing name is certain, and has no members that only exist at run time."""
        entry = self._reader.entry(resolved.owner)
        if entry is None or (entry.kind == "class" and (entry.group != "data" or entry.name in _OPEN)):
            return False
        if entry.kind == "context" or self._old.had(resolved.owner, resolved.missing):
            return False
        before = chain.steps[: len(chain.steps) - resolved.steps_left]
        if (
            "[" in resolved.missing
            or resolved.missing.startswith(("bl_", "_"))
            or any(step.kind in {"key", "index"} for step in before)
        ):
            return False
        return resolved.fit >= 1.0 or (resolved.fit >= USUAL and len(usual_classes(chain.root)) <= 1)

    def tell_if(self, chain: Chain, broken: ResolvedChain, recognition: Recognition) -> None:
        """Notes what the class lacks that a variable is named after, where another one has what is read."""
        owner = self._reader.entry(broken.owner)
        if owner and owner.kind == "class" and not is_guess(chain.root):
            sure = self._is_sure(chain, broken)
            recognition.doubted = MissingName(broken.missing, broken.owner, sure=sure, variable=chain.root)
