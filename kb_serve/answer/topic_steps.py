"""How a topic's work is done, in order: the calls that make its things, where these go, what is set, what runs it.

Computed from the schema and weights: a class that has a creation call is made; what points to it is where it goes; its
own settings and those it points to are set; the operators of the topic that neither make nor remove anything run it.
"""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING

from kb_build.index.analysis import terms
from kb_build.symbols.api_names import ID, NODE, OBJECT, OPERATORS, STRUCT, TYPES
from kb_build.symbols.flags import operator_areas, refused_nothing
from kb_build.symbols.lines import operator_needs
from kb_serve.answer.budget import tokens
from kb_serve.answer.steps.creation_calls import CreationCalls
from kb_serve.answer.steps.edited_as import edited_as
from kb_serve.answer.steps.inserted import inserted
from kb_serve.answer.steps.instances import Instances
from kb_serve.answer.steps.members import call_of
from kb_serve.answer.steps.new_scene import NewScene
from kb_serve.answer.steps.node_trees.nodes import NodeSteps
from kb_serve.answer.steps.node_trees.trees import EMBEDDED_TREES, TreeSteps
from kb_serve.answer.steps.operators import POINT_CACHE, UNDO, runs
from kb_serve.answer.steps.own_properties import made_by_subscript
from kb_serve.answer.steps.places import PlaceSteps
from kb_serve.answer.steps.reached import ReachedSettings
from kb_serve.answer.steps.scene_parts import scene_parts
from kb_serve.answer.steps.settings import OTHERS_ELEMENT, SettingSteps
from kb_serve.interface import is_of_interface

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kb_build.symbols.records import Symbol
    from kb_serve.answer.steps.topic_names import TopicNames
    from kb_serve.reader import BaseReader, Creation

_MOST_TOKENS = 1_150  # of all steps
_MAKERS = 3
_FUNCTIONS = 3
_LEAST_SHARE = 0.25  # of the heaviest class's weight
_MODIFIER = f"{TYPES}Modifier"  # of objects
_IN_A_NODE = ".nodes["  # in a call that makes what a node holds
_NOT_MADE = frozenset({NODE, *EMBEDDED_TREES})  # for themselves
_LEGACY = "(Legacy)"  # at the end of labels
_PREPARES = re.compile(r"(?:instead: )?`[^`]* = [^`]*`")  # a step that only sets something, for the next


def numbered(steps: Iterable[str]) -> list[str]:
    """Steps as the lines of a numbered list."""
    return [f"{number}. {step}" for number, step in enumerate(steps, 1)]


class Steps:
    """The steps of one topic."""

    def __init__(self, reader: BaseReader, names: TopicNames) -> None:
        self._reader = reader
        self._names = names
        made = reader.creations(list(names.classes))
        self._creations = {
            path: one
            for path, one in made.items()
            if not self._is_in_nothing(path, one) and not self._is_kept_for_old_files(path)
        }
        self._classes = self._main_classes()
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
        is_made = self._is_made() or not self._scene.shown.isdisjoint(self._classes[:1])
        if not is_made:
            yield from self._seen_from()
        makes_first = is_made or self._is_on_made()
        for part in (self._make, self._there) if makes_first else (self._there, self._make):
            yield from part()
        is_cached = POINT_CACHE in self._scene.shown
        has_its_title = any(map(self._has_title, self._classes[:1]))
        yield from runs(self._names, self._scene, is_cached=is_cached, is_made=is_made and has_its_title)
        yield from self._reached.waiting

    def _main_classes(self) -> list[str]:
        """Where classes have the topic's name, best its whole title, the others of its pages are other topics' matter,
        unless these alone can be made.
        """
        named = [path for path in self._names.classes if self._names.names(path)]
        titled = [path for path in self._names.classes if self._has_title(path)]
        made = self._creations.keys() & titled
        if made and (not self._names.explained.isdisjoint(made) or self._are_heavy(titled, named or titled)):
            named = sorted(titled, key=lambda path: path not in self._names.explained)
        named = self._with_kinds(named)
        if not titled and (explained := self._explained()) and not set(named[:1]) & self._names.explained:
            named = explained
        # What only has settings is made by what is called so and is of a kind that is made.
        made = self._names.of_kind & self._creations.keys()
        if made and self._creations.keys().isdisjoint(named[:1]):
            named = [*(path for path in self._names.classes if path in made), *named]
            named = list(dict.fromkeys(named))
        elif self._creations and self._creations.keys().isdisjoint(named):
            named = []
        called = tuple(path.removeprefix(TYPES) for path in named if self._is_the_topic(path))
        named = [path for path in named if not self._is_anothers(path, called)] or list(self._names.classes)
        return [path for path in named if not self._is_elsewhere(path)]

    def _is_elsewhere(self, path: str) -> bool:
        """Whether a class only has the topic's words in its name, and other pages explain it: a constraint that tracks
        is no tracking of a film. The modifier that is called as the topic is its own wherever it is explained, and what
        is called so, with its kinds, if nothing else of the topic is made: the user's asset library for asset
        libraries.
        """
        if path not in self._names.elsewhere:
            return False
        is_modifier = path.endswith("Modifier") and self._names.is_called(path.removesuffix("Modifier"))
        own = self._creations.keys() & self._names.classes.keys() - self._names.elsewhere
        called = (self._names.is_called(base.path) for base in self._reader.lineage(path))
        return not (is_modifier or (not own and (any(called) or self._is_kept_by_user(path))))

    def _is_kept_by_user(self, path: str) -> bool:
        """Whether Blender's preferences hold what ends as the topic is called: the user's asset libraries."""
        return path in self._creations and not self._is_in_scene(path) and self._names.ends_as_title(path)

    def _is_in_scene(self, path: str) -> bool:
        """Whether a class is made, and that not in Blender's interface."""
        return path in self._creations and not is_of_interface(self._creations[path].call)

    def _explained(self) -> list[str]:
        """What the page explains and can be made, if its name says something of the title: what a page on one kind of
        strip explains, rather than what else is called image.
        """
        title = set(self._names.words[0]) if self._names.words else set[str]()
        shared = {
            path: len(title & set(terms(path.removeprefix(TYPES))))
            for path in self._names.classes
            if path in self._names.explained and path in self._creations
        }
        return sorted((path for path in shared if shared[path]), key=lambda path: -shared[path])

    def _is_kept_for_old_files(self, path: str) -> bool:
        """Whether Blender's menus make no such thing any more: ``Mix (Legacy)``."""
        entry = self._reader.entry(path)
        return entry is not None and entry.label.endswith(_LEGACY)

    def _is_in_nothing(self, path: str, creation: Creation) -> bool:
        """Whether an operator that runs anywhere makes a part of what an element has that somebody must have made: it
        takes that from the context, and else does nothing.
        """
        cls, maker = self._reader.symbol(path), self._reader.symbol(creation.maker)
        is_anywhere = creation.call.startswith(OPERATORS) and maker is not None and _needs_nothing(maker)
        return is_anywhere and cls is not None and OTHERS_ELEMENT.search(cls.reached) is not None

    def _with_kinds(self, named: list[str]) -> list[str]:
        """Some classes, and those of the topic that derive from one which is not made for itself."""
        bases = {path for path in named if path not in self._creations}
        kinds = (
            path
            for path in self._names.classes
            if not bases.isdisjoint(base.path for base in self._reader.lineage(path))
        )
        return list(dict.fromkeys((*named, *kinds)))

    def _has_title(self, path: str) -> bool:
        entry = self._reader.entry(path)
        return entry is not None and self._names.has_title(f"{entry.name} {entry.label} {entry.name.lower()}")

    def _are_heavy(self, paths: list[str], beside: list[str]) -> bool:
        """Whether the heaviest of some classes weighs enough beside that of others."""
        heaviest, other = (max(map(self._names.classes.__getitem__, each)) for each in (paths, beside))
        return heaviest >= _LEAST_SHARE * other

    def _has_modifier(self, path: str) -> bool:
        return self._names.has_modifier(path) and self._reader.descends(path, _MODIFIER)

    def _is_the_topic(self, path: str) -> bool:
        return path in self._creations and self._names.is_called(path)

    def _is_anothers(self, path: str, called: tuple[str, ...]) -> bool:
        """Whether an operator makes what only ends as the topic is called: the world of rigid bodies."""
        creation = self._creations.get(path)
        is_by_operator = creation is not None and creation.call.startswith(OPERATORS)
        return is_by_operator and path.endswith(called) and path.removeprefix(TYPES) not in called

    def _tree_of(self, node: str) -> list[str]:
        return self._trees.taking(node).steps

    def _is_made(self) -> bool:
        """Whether the topic's main class is made, or held by a modifier that is."""
        return any(map(self._is_in_scene, self._classes[:1])) or any(map(self._has_modifier, self._classes))

    def _is_on_made(self) -> bool:
        """Whether the topic's main class is reached through something that its steps make."""
        records = [self._reader.symbol(path) for path in self._classes if path in self._creations]
        makers = [record.reached for record in records if record and record.reached]
        mains = [self._reader.symbol(path) for path in self._classes[:1]]
        return any(main.reached.startswith(f"{maker}.") for main in mains if main for maker in makers)

    def _functions(self) -> Iterator[str]:
        """Functions that every thing has and that are called as the topic is, ``keyframe_insert``, or that every
        data-block has and that do what an operator of the topic does: ``asset_mark``, as ``asset.mark``.
        """
        paths = [path for name in self._names.stems() for path in self._reader.functions_named(name)]
        paths = [path for path in paths if path.startswith(f"{STRUCT}.")]
        alike = (path.removeprefix(OPERATORS).replace(".", "_") for path in self._names.operators)
        paths += [f"{ID}.{name}" for name in alike]
        entries = (
            self._reader.entry(path)
            for path in dict.fromkeys(paths)
            if UNDO.isdisjoint(path.rpartition(".")[2].split("_"))
        )
        for entry in self._reader.heaviest(entry for entry in entries if entry)[:_FUNCTIONS]:
            yield f"`obj.{call_of(entry)}` — {entry.line.partition(' — ')[2]}"
            for cls in filter(self._names.is_called, self._classes[:1]):
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
        """What the topic's scene has one of, where that weighs enough: the camera, before something is rendered."""
        for cls, expression in scene_parts(self._reader):
            is_needed = cls in self._creations and cls not in self._names.elsewhere and self._counts(cls)
            if is_needed and self._names.operators:
                yield from self._calls.making({cls: self._creations[cls]})
                yield from self._scene.obj.made_of(cls)
                yield f"`{expression} = obj`"

    def _make(self) -> Iterator[str]:
        all_ = self._groups()
        groups = [
            group
            for rank, group in enumerate(all_)
            if self._is_main(group) and not (rank and (self._is_in_area(group) or self._is_by_hand(group)))
        ][:_MAKERS]
        # With the first what the same collection makes by other functions: strips of sounds, of films, of images.
        beside = [group for group in all_ if groups and _is_made_alike(group, groups[0])]
        groups = [*beside, *(group for group in groups if group not in beside)]
        # What an operator makes that needs nothing comes first: a world, before what is in it makes one; nodes come
        # before their items, which they are told with.
        firsts = {id(group): next(iter(group.values())) for group in groups}
        for creations in sorted(
            groups,
            key=lambda group: (
                not self._needs_nothing(firsts[id(group)]),
                _IN_A_NODE in firsts[id(group)].call,
            ),
        ):
            if next(iter(creations)) not in self._scene.shown:
                yield from self._make_one(creations, is_first=creations is groups[0])

    def _is_in_area(self, creations: Mapping[str, Creation]) -> bool:
        """Whether an operator makes something in an area of a window alone, which a script need not have."""
        creation = next(iter(creations.values()))
        maker = self._reader.symbol(creation.maker) if creation.call.startswith(OPERATORS) else None
        return maker is not None and bool(operator_areas(maker))

    def _is_by_hand(self, creations: Mapping[str, Creation]) -> bool:
        """Whether an operator makes something beside what the file's own function makes: a second slot for a material
        that assigning it has given one.
        """
        first = self._creations.get(self._classes[0])
        is_by_data = first is not None and first.call.startswith("bpy.data.")
        return is_by_data and all(one.call.startswith(OPERATORS) for one in creations.values())

    def _is_main(self, creations: Mapping[str, Creation]) -> bool:
        """Whether the topic is about what one maker makes: the kinds of its main class, too."""
        first = next(iter(creations))
        is_kind = first != self._classes[0] and self._reader.descends(first, self._classes[0])
        return self._has_modifier(first) or is_kind or self._counts(*creations)

    def _groups(self) -> list[dict[str, Creation]]:
        """The classes that are made, by what makes them, each group with its heaviest class first."""
        groups: dict[str, dict[str, Creation]] = defaultdict(dict)
        # A modifier with the topic's name makes the settings that it holds; kinds of what is called so come next.
        for path in sorted(
            self._classes, key=lambda path: (not self._has_modifier(path), not self._is_of_kind(path))
        ):
            creation = self._creations.get(path)
            is_left = path in _NOT_MADE or self._is_of_made_data(path)
            is_aside = not (self._is_in_scene(path) or self._is_kept_by_user(path))
            if creation and not is_left and not is_aside:
                groups[creation.maker][path] = creation
        # The first group is the heaviest class's; of the others, many light classes outweigh a single one.
        first, others = [*groups.values()][:1], [*groups.values()][1:]
        return [*first, *sorted(others, key=self._names.weight_of, reverse=True)]

    def _is_of_kind(self, path: str) -> bool:
        """Whether a class is a kind of what is called as the topic: a constraint, and not the target of one. Nodes come
        after their tree.
        """
        return not self._reader.descends(path, NODE) and any(
            self._names.is_called(base.path) for base in self._reader.lineage(path)
        )

    def _is_of_made_data(self, path: str) -> bool:
        """Whether a class is the modifier of data that is made: it is told with that, as it is on another object."""
        data = path.removesuffix("Modifier")
        is_made = data != path and data in self._classes and data in self._creations
        return is_made and self._reader.is_object_data(data)

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

    def _needs_nothing(self, creation: Creation) -> bool:
        """Whether an operator makes a thing wherever it is called."""
        maker = self._reader.symbol(creation.maker)
        return maker is not None and _needs_nothing(maker)

    def _there(self) -> Iterator[str]:
        """The topic's settings that are reached without being made: ``RenderSettings``."""
        return self._reached.steps(
            (path for path in self._classes if path not in self._creations and self._counts(path)),
            {*self._classes[:1], *self._names.explained},
            is_made=self._is_made(),
        )

    def _counts(self, *paths: str) -> bool:
        """Whether classes weigh enough, together, beside the topic's heaviest."""
        heaviest_one = max(map(self._names.classes.__getitem__, self._classes))
        return self._names.weight_of(paths) >= _LEAST_SHARE * heaviest_one


def _is_made_alike(creations: Mapping[str, Creation], others: Mapping[str, Creation]) -> bool:
    """Whether the makers of some classes are functions of one class."""
    makers = {next(iter(each.values())).maker.rpartition(".")[0] for each in (creations, others)}
    return len(makers) == 1 and not any(maker.startswith(OPERATORS) for maker in makers)


def _needs_nothing(maker: Symbol) -> bool:
    return refused_nothing(maker) and not operator_needs(maker)
