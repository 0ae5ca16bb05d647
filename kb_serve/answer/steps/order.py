"""How a topic's work is done, in order: the calls that make its things, where these go, what is set, what runs it.

Computed from the schema and weights: a class that has a creation call is made; what points to it is where it goes; its
own settings and those it points to are set; the operators of the topic that neither make nor remove anything run it.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import ID, NODE, OBJECT, OPERATORS, STRUCT, TYPES
from kb_serve.answer.budget import tokens
from kb_serve.answer.facts.members_in_brief import call_of
from kb_serve.answer.steps.made_groups import MadeGroups
from kb_serve.answer.steps.main_classes import MainClasses
from kb_serve.answer.steps.making.creation_calls import CreationCalls
from kb_serve.answer.steps.making.instances import Instances
from kb_serve.answer.steps.making.places import PlaceSteps
from kb_serve.answer.steps.making.trees import TreeSteps
from kb_serve.answer.steps.node_trees.nodes import NodeSteps
from kb_serve.answer.steps.operators import POINT_CACHE, UNDO, runs
from kb_serve.answer.steps.scene.new_scene import NewScene
from kb_serve.answer.steps.setting.edited_as import edited_as
from kb_serve.answer.steps.setting.inserted import inserted
from kb_serve.answer.steps.setting.own_properties import made_by_subscript
from kb_serve.answer.steps.setting.settings_of_made import SettingSteps
from kb_serve.answer.steps.setting.settings_of_reached import ReachedSettings

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kb_serve.answer.steps.names.topic_names import TopicNames
    from kb_serve.lookups.records import Creation
    from kb_serve.reader import BaseReader

_MOST_TOKENS = 1_150  # of all steps
_FUNCTIONS = 3
_PREPARES = re.compile(r"(?:instead: )?`[^`]* = [^`]*`")  # a step that only sets something, for the next


def numbered(steps: Iterable[str]) -> list[str]:
    """Steps as the lines of a numbered list."""
    return [f"{number}. {step}" for number, step in enumerate(steps, 1)]


class Steps:
    """The steps of one topic."""

    def __init__(self, reader: BaseReader, names: TopicNames) -> None:
        self._reader = reader
        self._names = names
        self._main = MainClasses(reader, names)
        self._scene = NewScene(reader)
        instances = Instances(self._scene, self._tree_of)
        self._places = PlaceSteps(names, self._scene, instances)
        self._trees = TreeSteps(names, self._scene, self._places)
        self._calls = CreationCalls(self._scene, instances, self._trees)
        self._nodes = NodeSteps(self._scene, self._calls, self._trees)
        self._settings = SettingSteps(names, self._scene)
        self._reached = ReachedSettings(self._scene)

    def told(self) -> list[str]:
        """As many steps as are told, in their order; none where nothing is made, set or run."""
        steps = [*self._steps()]
        told = list(steps)
        while sum(tokens(line) + 1 for line in numbered(told)) > _MOST_TOKENS:
            told.pop()
        while told and len(told) < len(steps) and _PREPARES.fullmatch(told[-1]):
            told.pop()
        return told

    def _steps(self) -> Iterator[str]:
        """All steps in their order; what is told depends on what has been told before."""
        yield from self._functions()
        yield from self._given_objects()
        yield from made_by_subscript(self._names, self._reader)
        is_made = self._main.are_made() or not self._scene.shown.isdisjoint(self._main.paths[:1])
        if not is_made:
            yield from self._seen_from()
        makes_first = is_made or self._main.are_on_made()
        for part in (self._make, self._there) if makes_first else (self._there, self._make):
            yield from part()
        is_cached = POINT_CACHE in self._scene.shown
        has_its_title = any(map(self._main.has_title, self._main.paths[:1]))
        yield from runs(self._names, self._scene, is_cached=is_cached, is_made=is_made and has_its_title)
        yield from self._reached.waiting

    def _tree_of(self, node: str) -> list[str]:
        return self._trees.taking(node).steps

    def _functions(self) -> Iterator[str]:
        """Functions that every thing has and that are called as the topic is, ``keyframe_insert``, or that every
        data-block has and that do what an operator of the topic does: ``asset_mark``, as ``asset.mark``.
        """
        paths = [path for name in self._names.stems() for path in self._reader.names.functions_named(name)]
        paths = [path for path in paths if path.startswith(f"{STRUCT}.")]
        alike = (path.removeprefix(OPERATORS).replace(".", "_") for path in self._names.operators)
        paths += [f"{ID}.{name}" for name in alike]
        entries = (
            self._reader.entry(path)
            for path in dict.fromkeys(paths)
            if UNDO.isdisjoint(path.rpartition(".")[2].split("_"))
        )
        for entry in self._reader.usage.heaviest(entry for entry in entries if entry)[:_FUNCTIONS]:
            yield f"`obj.{call_of(entry)}` — {entry.line.partition(' — ')[2]}"
            for cls in filter(self._names.is_called, self._main.paths[:1]):
                yield from inserted(cls, entry.name, self._scene)

    def _given_objects(self) -> Iterator[str]:
        """The pointers of an object to another that are called as the topic is: ``parent``."""
        members = self._reader.members(OBJECT)
        for name in self._names.stems():
            pointer = members.get(name)
            if pointer is None or pointer.target != OBJECT.removeprefix(TYPES) or pointer.is_read_only:
                continue
            yield f"`obj.{name} = other` — {pointer.line.partition(' — ')[2]}"
            if (inverse := f"matrix_{name}_inverse") in members:
                yield f"`obj.{inverse} = other.matrix_world.inverted()` — it stays where it is"

    def _seen_from(self) -> Iterator[str]:
        """What a scene has one of, where that weighs enough: the camera, before something is rendered."""
        for cls, expression in self._scene.lacking():
            is_needed = (
                cls in self._main.creations and cls not in self._names.elsewhere and self._main.counts(cls)
            )
            if is_needed and self._names.operators:
                yield from self._calls.making({cls: self._main.creations[cls]})
                yield from self._scene.obj.made_of(cls)
                yield f"`{expression} = obj`"

    def _make(self) -> Iterator[str]:
        for creations, is_first in MadeGroups(self._reader, self._names, self._main).in_order():
            if next(iter(creations)) not in self._scene.shown:
                yield from self._make_one(creations, is_first=is_first)

    def _make_one(self, creations: Mapping[str, Creation], *, is_first: bool) -> Iterator[str]:
        """How the classes of one maker are made, and what the first of them needs to be of use."""
        main, creation = next(iter(creations.items()))
        if self._reader.descends(main, NODE):
            yield from self._nodes.made(creations)
            return
        made = self._calls.making(creations)
        yield from made
        if not made:
            return
        if creation.call.startswith("bpy.data."):
            yield from self._places.of(main)
        if not (is_first or self._names.names(main)):
            return
        own, further = self._settings.own(main, creation), self._settings.further(main, creation)
        nodes = self._nodes.in_own_tree(main) if is_first else iter(())
        edited = edited_as(main, self._scene.variables.of(main), self._reader)
        # What counts most comes first. What another thing edits has little else to set.
        if first_edit := next(edited, ""):
            parts = (further, (first_edit,), edited, own)
        else:
            parts = (nodes, own, further) if self._nodes.decide(main) else (own, nodes, further)
        for part in parts:
            yield from part

    def _there(self) -> Iterator[str]:
        """The topic's settings that are reached without being made: ``RenderSettings``."""
        return self._reached.steps(
            (
                path
                for path in self._main.paths
                if path not in self._main.creations and self._main.counts(path)
            ),
            {*self._main.paths[:1], *self._names.explained},
            is_made=self._main.are_made(),
        )
