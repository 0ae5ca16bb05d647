"""What is added to the collections of a thing, what is set on their elements, and called on its parts."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import EMPTY
from kb_build.symbols.flags import empty_when_new
from kb_build.symbols.lines import mode_needed
from kb_serve.answer.facts.members_in_brief import are_settings_seen, call_of, settings_of
from kb_serve.answer.steps.operators import POINT_CACHE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.answer.steps.names.topic_names import TopicNames
    from kb_serve.answer.steps.scene.new_scene import NewScene
    from kb_serve.lookups.records import Creation, SymbolEntry

LEAST = 1  # weight of a collection or function
MOST_MEMBERS = 3  # collections, and functions
_ADDING = ("new", "add", "append", "link")  # what functions that add are called
_STUB = "UnknownType"  # Blender's, for elements of which it says nothing


class ElementSteps:
    """The elements and parts of things in one list of steps."""

    def __init__(self, names: TopicNames, scene: NewScene) -> None:
        self._names = names
        self._scene = scene
        self._reader = scene.reader

    def steps(self, cls: str, variable: str) -> Iterator[str]:
        """The collections of a thing, and what adds to them; last what is added in another mode alone."""
        by_mode: dict[str, list[SymbolEntry]] = {"": []}
        for entry in self._collections(cls):
            by_mode.setdefault(self._mode_of(entry), []).append(entry)
        if anywhere := by_mode.pop(""):
            yield f"in `{variable}`: " + ", ".join(self._held(entry, variable) for entry in anywhere)
        for mode, entries in by_mode.items():
            if steps := self._scene.obj.to_mode(mode):
                yield "; ".join(f"`{step}`" for step in steps)
            for entry in entries:
                yield from self._added(entry, variable)

    def on_elements(self, cls: str, variable: str) -> Iterator[str]:
        """The settings of the elements that a new thing has, where nothing makes them: a variable's target; the points
        of a shape key, of which it has as many as the mesh.
        """
        for entry in self._collections(cls):
            element = f"{TYPES}{entry.target}"
            symbol = self._reader.symbol(entry.path)
            may_have_some = symbol is not None and EMPTY not in symbol.flags
            if not (may_have_some and self.belongs(element)) or self._added_by(entry):
                continue
            settings = "" if self._reader.makers.creations([element]) else settings_of(element, self._reader)
            if not settings:
                continue
            self._scene.shown.add(element)
            has_one = are_settings_seen(element, self._reader)
            elements = f"`{variable}.{entry.name}[0]`" if has_one else f"each of `{variable}.{entry.name}`"
            yield f"set on {elements} (`{entry.target}`): {settings}"

    def calls_on_parts(self, cls: str, variable: str) -> list[str]:
        """The main call that adds to each of the things that a new instance has, and that are made with it alone."""
        calls: list[str] = []
        for entry in self._reader.members(cls).values():
            target = f"{TYPES}{entry.target}"
            pointer = (
                self._reader.symbol(entry.path) if entry.type == "pointer" and self.belongs(target) else None
            )
            if pointer is None or empty_when_new(pointer) or self._reader.makers.creations([target]):
                continue
            functions = (one for one in self._reader.members(target).values() if one.kind == "function")
            adding = (one for one in functions if one.name.startswith(_ADDING))
            main = self._reader.usage.heaviest(adding, LEAST)[:1]
            calls += [f"{variable}.{entry.name}.{call_of(function)}" for function in main]
        return calls

    def belongs(self, cls: str) -> bool:
        """Whether a class belongs to the topic, or is its cache, and has not been shown."""
        return cls not in self._scene.shown and (cls in self._names.classes or cls == POINT_CACHE)

    def _collections(self, cls: str) -> list[SymbolEntry]:
        """The main collections of a thing; after those that scripts use most, its own that things are added to."""
        all_ = [
            entry
            for entry in self._reader.members(cls).values()
            if entry.type == "collection" and entry.target != _STUB
        ]
        main = self._reader.usage.heaviest(all_, LEAST)[:MOST_MEMBERS]
        own = (entry for entry in all_ if entry.owner == cls and entry not in main and self._added_by(entry))
        return [*main, *own][:MOST_MEMBERS]

    def _mode_of(self, collection: SymbolEntry) -> str:
        """The mode of the object in which alone something is added to a collection of its data; empty for any."""
        if not self._reader.is_object_data(collection.owner):
            return ""
        made = self._adding(collection)
        maker = self._reader.symbol(made.maker) if made else None
        if maker is None or not mode_needed(maker):
            return ""
        return next((refusal.mode for refusal in maker.refusals if refusal.mode), "")

    def _added(self, collection: SymbolEntry, variable: str) -> Iterator[str]:
        """The step that adds to a collection of a thing, and the settings of what it adds."""
        element = f"{TYPES}{collection.target}"
        name = self._scene.variables.of(element)
        yield f"`{name} = {variable}.{collection.name}.{self._added_by(collection)}` → `{collection.target}`"
        if settings := settings_of(element, self._reader):
            yield f"set on `{name}`: {settings}"

    def _held(self, entry: SymbolEntry, variable: str) -> str:
        """A collection of a thing, and the call that adds to it."""
        call = self._added_by(entry)
        by = f", by `{variable}.{entry.name}.{call}`{self._with_it(entry)}" if call else ""
        return f"`.{entry.name}` (`{entry.target}`{by})"

    def _added_by(self, collection: SymbolEntry) -> str:
        """The call that adds to a collection; empty for none."""
        if made := self._adding(collection):
            return made.call.partition(f".{collection.name}.")[2]
        functions = (
            self._reader.members(f"{TYPES}{collection.collection}").values() if collection.collection else ()
        )
        adding = [one for one in functions if one.kind == "function" and one.name.startswith(_ADDING)]
        return next(
            (self._given_elements(one, collection) for one in self._reader.usage.heaviest(adding)), ""
        )

    def _given_elements(self, function: SymbolEntry, collection: SymbolEntry) -> str:
        """A call that adds to a collection, given an element that is there: the object that is linked. What has the
        collection is none of its own elements.
        """
        call, symbol = call_of(function), self._reader.symbol(function.path)
        for parameter in symbol.parameters if symbol else ():
            cls = f"{TYPES}{parameter.type}"
            there = self._scene.variables.there(cls) if parameter.required else ""
            if there and cls != collection.owner and parameter.type == collection.target:
                call = re.sub(rf"\b{parameter.name}\b(?=[,)])", there, call)
        return call

    def _with_it(self, collection: SymbolEntry) -> str:
        """What is then called on what a new element has: strokes are added to the drawing of a frame."""
        element = f"{TYPES}{collection.target}"
        calls = self.calls_on_parts(element, self._scene.variables.of(element))
        return f", then `{calls[0]}`" if calls else ""

    def _adding(self, collection: SymbolEntry) -> Creation | None:
        """What adds to a collection; None where nothing does."""
        target = f"{TYPES}{collection.target}"
        made = self._reader.makers.creations([target]).get(target)
        adds = made is not None and made.maker.rpartition(".")[0] == f"{TYPES}{collection.collection}"
        return made if adds else None
