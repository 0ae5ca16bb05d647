"""Where new data-blocks go so that they count: an object that has them, a collection, a pointer that leads to them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OBJECT, TYPES
from kb_serve.answer.facts.members_in_brief import settings_of
from kb_serve.answer.steps.names.variable_names import OBJ, TREE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.answer.steps.making.instances import Instances
    from kb_serve.answer.steps.names.topic_names import TopicNames
    from kb_serve.answer.steps.scene.new_scene import NewScene
    from kb_serve.lookups.records import SymbolEntry

_MOST = 4  # that are looked at


class PlaceSteps:
    """The places of what one list of steps makes."""

    def __init__(self, names: TopicNames, scene: NewScene, instances: Instances) -> None:
        self._names = names
        self._scene = scene
        self._reader = scene.reader
        self._instances = instances

    def of(self, cls: str) -> Iterator[str]:
        """The steps that put a new instance of a class where it counts."""
        variable = self._scene.variables.of(cls)
        if self._reader.is_object_data(cls):
            yield from self._scene.obj.made_of(cls)
            yield from self._deforming(cls)
            variable = OBJ
            pointers = [pointer for pointer in self._called_as_topic() if pointer.target == "Object"]
        elif linked := self._linked(cls, variable):
            yield linked
            return
        else:
            pointers = self._reader.pointing_at(cls.removeprefix(TYPES))
        yield from self._assigned(variable, [pointer for pointer in pointers if not pointer.is_read_only])

    def _assigned(self, variable: str, pointers: list[SymbolEntry]) -> Iterator[str]:
        """The heaviest pointer to it whose owner is there, or can be made."""
        for pointer in self._reader.usage.heaviest(pointers)[:_MOST]:
            owner = pointer.owner
            # A modifier of the object itself cannot lead to it, nor can its own pointers.
            if variable == OBJ and (owner == OBJECT or self._is_on_object(owner)):
                continue
            if self._reader.descends(owner, TREE) and owner not in self._scene.shown:
                continue
            ready = self._instances.of(owner)
            if ready is not None and variable != ready.expression:
                self._scene.shown.add(owner)
                yield from ready.steps
                if not any(
                    re.search(rf"[(,] ?{variable}[,)]", step) for step in ready.steps[-1:]
                ):  # given already
                    yield f"`{ready.expression}.{pointer.name} = {variable}`"
                    yield from self._instances.part_of(pointer, ready.expression)
                return

    def _is_on_object(self, cls: str) -> bool:
        creation = self._reader.makers.creations([cls]).get(cls)
        return creation is not None and creation.call.startswith("obj.")

    def _deforming(self, cls: str) -> Iterator[str]:
        """The modifier of the data's name, by which its object changes another: an Armature modifier; with its settings
        where it belongs to the topic.
        """
        modifier = f"{cls}Modifier"
        creation = self._reader.makers.creations([modifier]).get(modifier)
        pointer = self._reader.entry(f"{modifier}.object")
        if creation and pointer and pointer.target == "Object":
            call = creation.call.replace("obj.", "other.", 1)
            self._scene.shown.add(modifier)
            yield f"on another object, that it changes: `modifier = {call}`, then `modifier.object = obj`"
            if modifier in self._names.classes and (settings := settings_of(modifier, self._reader)):
                yield f"set on `modifier` (`{modifier.removeprefix(TYPES)}`): {settings}"

    def _linked(self, cls: str, variable: str) -> str:
        """The call that links a data-block to where it counts: a collection to the scene's."""
        for entry in self._reader.names.by_name("link"):
            symbol = self._reader.symbol(entry.path) if entry.kind == "function" else None
            if symbol is None or cls.removeprefix(TYPES) not in {
                p.type for p in symbol.parameters if p.required
            }:
                continue
            holders = (
                self._reader.entry(one)
                for one in self._reader.collections_of(entry.owner.removeprefix(TYPES))
            )
            for holder in holders:
                owner = self._reader.symbol(holder.owner) if holder else None
                if holder and owner and owner.reached and "[" not in owner.reached:
                    return f"`{owner.reached}.{holder.name}.link({variable})`"
        return ""

    def _called_as_topic(self) -> list[SymbolEntry]:
        """Pointers called as the topic is: ``Scene.camera``."""
        entries = [entry for name in self._names.stems() for entry in self._reader.names.by_name(name)]
        return [entry for entry in entries if entry.kind == "property" and entry.type == "pointer"]
