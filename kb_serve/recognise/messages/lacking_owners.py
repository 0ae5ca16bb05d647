"""Explains what a class or module lacks: an attribute that other versions may have, or that never was."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.index.analysis import words
from kb_build.symbols.api_names import ID, TYPES
from kb_serve.recognise.chains.operator_classes import known_operator_of_class
from kb_serve.recognise.elsewhere.elements import elsewhere
from kb_serve.recognise.elsewhere.layers import former_layer
from kb_serve.recognise.elsewhere.members_within import members_within
from kb_serve.recognise.likely.corrections import is_misspelling, nearest
from kb_serve.recognise.messages.context_members import note_on_absent
from kb_serve.recognise.messages.of_older import of_older
from kb_serve.recognise.recognition import SIMILAR, MissingName

if TYPE_CHECKING:
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.messages.named_symbols import NamedSymbols
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbol, RemovedSymbolLookup

_OF_NO_BLOCK = frozenset({"BlendData", "Context", "Depsgraph", "Event"})
_OF_ALL = 1 / 2  # the share of the words of two names from which on they say the same
_INSTANCES = {"RNA_Types": "bpy.types", "bpy_types": "bpy.types", "BPyOps": "bpy.ops", "_bpy": "bpy"}
_PROPERTIES, _OPERATOR = "bpy.props", f"{TYPES}Operator"
_OWN_CLASS = (
    "Blender has no class `{cls}`. If it is one of the script's own, `{name}` is a property of it by an annotation, "
    "with a colon (`{name}: bpy.props.FloatProperty()`, or another of `bpy.props`), before the class is registered. "
    "What `invoke()` sets on `self` is not there where `execute()` is called alone."
)
_NOT_IMPORTED = "`{module}` is a module of its own, to be imported first: `import {module}`."
_NOT_BLENDERS = (
    "`import bpy` brings `{module}`: the `bpy` that was imported is not Blender's, but a package of stubs "
    "(fake-bpy-module), or a file or folder of your own that is called `bpy`. `print(bpy.__file__)` tells."
)
_OF_INSTANCES = (
    "Instances of `{cls}` have `{name}`, the class has not. For `bpy.msgbus` the key is a pair: "
    '`({cls}, "{name}")`.'
)
# What marks the names of classes that scripts register, by what these derive from.
_MARKS = {"_OT_": "Operator", "_PT_": "Panel", "_MT_": "Menu", "_UL_": "UIList", "_HT_": "Header"}


class LackingOwners:
    """Finds in one base what has an attribute that its owner in a message lacks."""

    def __init__(
        self,
        reader: BaseReader,
        removed: RemovedSymbolLookup,
        symbols: NamedSymbols,
    ) -> None:
        self._reader = reader
        self._removed = removed
        self._symbols = symbols

    def explain(
        self, written: str, name: str, recognition: Recognition, *, of_module: bool, meant: str = ""
    ) -> None:
        """Adds what became of the attribute, or the owner, and what it leads to that has the attribute.

        ``of_module`` tells that the message is of a module, which no other is; ``meant`` is what Python says was meant,
        by spelling alone, or empty.
        """
        owner = (
            _INSTANCES.get(written)
            or self._symbols.class_path(written, or_module=of_module)
            or known_operator_of_class(written, self._reader)
        )
        module = self._reader.entry(f"{owner}.{name}") if owner else None
        if module and module.kind == "module":
            recognition.add(module.path, 0.98, "error message")
            told = _NOT_BLENDERS if module.owner == "bpy" else _NOT_IMPORTED
            recognition.notes.append(told.format(module=module.path))
            return
        removed = self._removed.of_member(owner, name) or self._removed.below(owner, name) if owner else None
        if removed is None and (layer := former_layer(owner, name)):
            removed = self._removed.of_path(layer)
        if removed is None and not self._reader.entry(TYPES + written):
            members = self._removed.spelled(f"{written}.{name}")
            removed = next(members, None) or (None if owner else self._of_a_former_class(written, name))
        if removed and owner and self._reader.entry(removed.path.rpartition(".")[0]) is None:
            # Of a class that took another one's place: what it holds has the name rather than what replaced both.
            removed = None if members_within(owner, name, self._reader) else removed
        if removed:
            recognition.add_removed(self._own_first(removed, owner))
            now = removed.targets[0] if removed.targets else ""
            if not owner and removed.path == f"{TYPES}{written}" and not self._reader.member_of(now, name):
                recognition.missing.append(MissingName(name, now, sure=True))
        elif not owner and not of_module and written[:1].isupper() and written.isidentifier():
            self._own_class(written, name, recognition)
        elif owner and (member := self._reader.member_of(owner, name)):
            self._there(member, recognition)
        elif owner:
            recognition.missing.append(MissingName(name, owner, sure=True))
            recognition.add(owner, 0.6, "error message")
            own = self._reader.member_of(owner, meant) if _says_the_same(name, meant) else None
            if own:
                recognition.add(own.path, 0.97, SIMILAR)
            if other := elsewhere(owner, name, self._reader):
                recognition.notes.append(other.how)
                recognition.add(other.path, 0.98, "error message")
            self._of_its_block(owner, name, recognition)

    def explain_class(self, name: str, recognition: Recognition) -> None:
        """Adds a class that ``bpy.types`` of this Blender has, and that of a message has not."""
        if (cls := self._reader.entry(f"{TYPES}{name}")) and (note := of_older(cls.path, self._reader)):
            recognition.add(cls.path, 0.98, "error message")
            recognition.notes.append(note)

    def explain_elements(self, written: str, collection: str, name: str, recognition: Recognition) -> None:
        """Adds what became of an attribute that the elements of a class's collection lack."""
        owner = self._symbols.class_path(written, or_module=False)
        held = self._reader.member_of(owner, collection) if owner else None
        if held and held.target:
            self.explain(held.target, name, recognition, of_module=False)

    def tell_of_instances(self, written: str, name: str, recognition: Recognition) -> bool:
        """Adds what a class's instances have, and the class itself has not; whether they have it."""
        owner = self._symbols.class_path(written, or_module=False)
        member = self._reader.member_of(owner, name) if owner else None
        if member is None or not member.path.startswith(TYPES):
            return False
        recognition.add(member.path, 0.98, "error message")
        recognition.notes.append(_OF_INSTANCES.format(cls=owner, name=name))
        return True

    def _own_class(self, written: str, name: str, recognition: Recognition) -> None:
        """Adds the member that is meant of the class of Blender's from which a class of the script's own derives, by
        its name; else how it gets a property.
        """
        for base in _bases_of(written):
            names = self._reader.member_names(base)
            meant = next((other for other in names if is_misspelling(name, other)), "")
            if member := self._reader.member_of(base, meant) if meant else None:
                recognition.add(member.path, 0.97, "error message")
                recognition.notes.append(
                    f"`{base}`, of which `{written}` probably is one, has no `{name}`: `{meant}`."
                )
                return
        recognition.add(_PROPERTIES, 0.95, "error message")
        recognition.add(_OPERATOR, 0.9, "error message")
        recognition.notes.append(_OWN_CLASS.format(cls=written, name=name))

    def _there(self, member: SymbolEntry, recognition: Recognition) -> None:
        """A member that its class has, whatever the message says: of the context it is not there everywhere."""
        recognition.add(member.path, 0.97, "error message")
        symbol = self._reader.symbol(member.path) if member.kind == "context" else None
        if (symbol and (note := note_on_absent(symbol))) or (note := of_older(member.path, self._reader)):
            recognition.notes.append(note)

    def _own_first(self, removed: RemovedSymbol, owner: str) -> RemovedSymbol:
        """A removed symbol of another class, with what the class that is asked has in its place before the rest."""
        if removed.path.startswith(f"{owner}."):
            return removed
        own = {entry.path for entry in self._reader.lineage(owner)}
        successors = sorted(removed.successors, key=lambda one: one.target.rpartition(".")[0] not in own)
        return replace(removed, successors=tuple(successors))

    def _of_a_former_class(self, written: str, name: str) -> RemovedSymbol | None:
        """What a removed class lacked already, or else the class."""
        cls = next(self._removed.spelled(written), None)
        now = cls.targets[0] if cls and cls.targets else ""
        member = None if not now or self._reader.member_of(now, name) else self._removed.of_member(now, name)
        return member or cls

    def _of_its_block(self, owner: str, name: str, recognition: Recognition) -> None:
        """A member that a class lacks, and that the data-block has which it is a part of."""
        of_block = self._reader.entry(f"{ID}.{name}")
        cls = self._reader.entry(owner)
        is_part = cls is not None and cls.group == "data" and cls.name not in _OF_NO_BLOCK
        own = nearest(name, self._reader.members(owner))  # an ActionSlot has a ``name_display``
        if of_block and is_part and not own and not self._reader.descends(owner, ID):
            recognition.add(of_block.path, 0.96, "error message")
            recognition.notes.append(
                f"The data-block that it is part of has it: `.id_data.{name}` (`{of_block.path}`)."
            )


def _bases_of(written: str) -> list[str]:
    """The classes of Blender's of which a class is called one: ``OBJECT_PT_my``, ``MyPanel``; of others an operator."""
    marked = [cls for mark, cls in _MARKS.items() if mark in written or written.endswith(cls)]
    return [TYPES + cls for cls in marked or ("Operator",)]


def _says_the_same(name: str, other: str) -> bool:
    """Whether two names have half of their words in common."""
    mine, theirs = set(words(name)), set(words(other))
    return bool(other) and len(mine & theirs) >= _OF_ALL * len(mine | theirs)
