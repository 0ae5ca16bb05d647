"""What is set and called on a thing: its own settings, its parts, and the settings of what it points to."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import ID, OPERATORS, TYPES
from kb_build.symbols.flag_names import READ_ONLY
from kb_build.symbols.flags import fillers
from kb_serve.answer.facts.members_in_brief import (
    MOST_SETTINGS,
    call_of,
    own_settings,
    settings_of,
)
from kb_serve.answer.steps.making.parts import parts
from kb_serve.answer.steps.names.variable_names import OBJ
from kb_serve.answer.steps.operators import UNDO
from kb_serve.answer.steps.scene.pointer_fills import stays_empty
from kb_serve.answer.steps.scene.working_object import OTHER
from kb_serve.answer.steps.setting.collections_of_made import LEAST, MOST_MEMBERS, ElementSteps

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kb_build.symbols.records import Symbol
    from kb_serve.answer.steps.names.topic_names import TopicNames
    from kb_serve.answer.steps.scene.new_scene import NewScene
    from kb_serve.lookups.records import Creation, SymbolEntry

_HOLDERS = 4  # pointers of a thing whose settings are shown
_OTHER_KINDS = 4  # besides the one that is made, of which each is told
_OF_OTHER_KIND = 4  # settings
_FILE_ALONE = "`filepath`"  # settings of what is a file's contents
_LOOK_UP = frozenset({"get", "current", "find"})  # in names of functions that do nothing to a thing
OTHERS_ELEMENT = re.compile(r"\[.*\].*\.")  # … of what has an element that somebody else must have made


class SettingSteps:
    """The settings in one list of steps."""

    def __init__(self, names: TopicNames, scene: NewScene) -> None:
        self._names = names
        self._scene = scene
        self._reader = scene.reader
        self._elements = ElementSteps(names, scene)

    def own(self, cls: str, creation: Creation) -> Iterator[str]:
        """A new thing's own settings."""
        variable = self._expression(cls, creation)
        if variable and (own := settings_of(cls, self._reader)):
            yield f"set on `{variable}`: {own}"
        # The class that the call makes, where that is one of several below it: a point light for a light.
        kinds = [one.path for one in self._reader.descendants(cls)] if variable else []
        made_kinds = self._reader.makers.creations(kinds)
        for kind, made in made_kinds.items():
            of_kind = own_settings(kind, MOST_SETTINGS, self._reader) or settings_of(kind, self._reader)
            if made.call == creation.call and of_kind:
                yield f"set on `{variable}` (`{kind.removeprefix(TYPES)}`): {of_kind}"
        yield from self._of_other_kinds(made_kinds, creation)

    def _of_other_kinds(self, kinds: Mapping[str, Creation], creation: Creation) -> Iterator[str]:
        """The few settings that each of the other kinds has which the same function makes: the size of an area light.
        Of many kinds each is a topic of its own.
        """
        others = {
            kind: made
            for kind, made in kinds.items()
            if made.maker == creation.maker and made.call != creation.call
        }
        for kind, made in others.items() if len(others) <= _OTHER_KINDS else ():
            if own := own_settings(kind, _OF_OTHER_KIND, self._reader):
                yield f"set on `{made.call}` (`{kind.removeprefix(TYPES)}`): {own}"

    def further(self, cls: str, creation: Creation) -> Iterator[str]:
        """What a new thing holds, its functions, then the settings that it points to, and those below, where they
        belong to the topic or are its cache.
        """
        variable = self._expression(cls, creation)
        if not variable:
            return
        entries = self._reader.members(cls).values()
        yield from self._elements.steps(cls, variable)
        yield from self._elements.on_elements(cls, variable)
        yield from parts(cls, variable, self._names, self._reader)
        calls = [f"{variable}.{call_of(entry)}" for entry in self._calls(entries)]
        if calls := [*calls, *self._elements.calls_on_parts(cls, variable)]:
            yield "call " + ", ".join(f"`{call}`" for call in calls)
        yield from self._below(cls, variable)

    def _expression(self, cls: str, creation: Creation) -> str:
        """What leads to a new thing; empty where what an operator made is an element of something else."""
        symbol = self._reader.symbol(cls) if creation.call.startswith(OPERATORS) else None
        if symbol is None or not symbol.reached:
            return self._scene.variables.of(cls)
        return "" if OTHERS_ELEMENT.search(symbol.reached) else symbol.reached

    def _calls(self, entries: Iterable[SymbolEntry]) -> list[SymbolEntry]:
        """The functions that do something to a thing, and do not take away what steps have made of it. One that only
        answers with a value is asked once all is done, and may have no answer before (``convex_sweep_test``): it counts
        where scripts call it.
        """
        functions = [
            entry
            for entry in entries
            if entry.kind == "function" and (UNDO | _LOOK_UP).isdisjoint(entry.name.split("_"))
        ]
        uses = self._reader.usage.use_counts([entry.path for entry in functions])
        called = (entry for entry in functions if uses.get(entry.path) or not self._answers(entry))
        return self._reader.usage.heaviest(called, LEAST)[:MOST_MEMBERS]

    def _answers(self, function: SymbolEntry) -> bool:
        """Whether a function gives values that are no things."""
        symbol = self._reader.symbol(function.path)
        given = [result.type for result in symbol.returns] if symbol else []
        return bool(given) and not any(self._reader.entry(f"{TYPES}{kind}") for kind in given)

    def _below(self, cls: str, variable: str) -> Iterator[str]:
        """The settings of what a thing points to, the nearest first."""
        waiting, left = [(cls, variable)], _HOLDERS
        while waiting and left:
            owner, above = waiting.pop(0)
            for entry in self._reader.usage.heaviest(self._reader.members(owner).values()):
                pointer = self._pointer(entry)
                if pointer is None:
                    continue
                target = f"{TYPES}{entry.target}"
                self._scene.shown.add(target)
                holder, steps = above, list[str]()
                if self._scene.pointers.is_in_place(pointer, above):
                    holder, steps = self._on_another(cls, entry.name) if above == variable else ("", steps)
                if not holder:
                    continue
                waiting.append((target, f"{holder}.{entry.name}"))
                if left and (loaded := self._loaded(pointer)):
                    left -= 1
                    yield f"`{holder}.{entry.name} = {loaded}`"
                elif left and (settings := settings_of(target, self._reader)):
                    left -= 1
                    yield from steps
                    yield from self._scene.pointers.steps(pointer, holder)
                    yield f"set on `{holder}.{entry.name}` (`{entry.target}`): {settings}"

    def _loaded(self, pointer: Symbol) -> str:
        """The call that loads what a pointer takes, where nothing is set on that but its file, as on a font; empty for
        none.
        """
        is_file = settings_of(f"{TYPES}{pointer.target}", self._reader) == _FILE_ALONE
        is_taken = is_file and READ_ONLY not in pointer.flags
        return self._scene.pointers.loading(pointer.target) if is_taken else ""

    def _on_another(self, cls: str, pointer: str) -> tuple[str, list[str]]:
        """What a further instance is called, and the steps that make it on an object of its own: one value of a setting
        makes one thing, another the next in place of the first. No name where it is on no object.
        """
        creation = self._reader.makers.creations([cls]).get(cls)
        if creation is None or not creation.call.startswith(f"{OBJ}."):
            return "", []
        name = pointer.partition("_")[0]
        made = f'{OTHER} = bpy.data.objects.new("{name.title()}", {OBJ}.data.copy())'
        return name, [
            f"another mesh object: `{made}`; `bpy.context.collection.objects.link({OTHER})`",
            f"`{name} = {creation.call.replace(OBJ, OTHER, 1)}` → `{cls.removeprefix(TYPES)}`",
        ]

    def _pointer(self, entry: SymbolEntry) -> Symbol | None:
        """The pointer that leads to settings of the topic which are the thing's own; None for any other member."""
        target = f"{TYPES}{entry.target}"
        if entry.type != "pointer" or not self._elements.belongs(target):
            return None
        # What is a thing's own cannot be replaced; another data-block can.
        if not entry.is_read_only and not self._reader.descends(target, ID):
            return None
        pointer = self._reader.symbol(entry.path)
        if pointer is None or stays_empty(pointer):
            return None
        return pointer if self._names.holds(entry.name) or not _makes_another(pointer) else None


def _makes_another(pointer: Symbol) -> bool:
    """Whether what fills a pointer makes a thing one of another kind: a function of the file that takes it."""
    return any(call.startswith("bpy.data.") for call in fillers(pointer))
