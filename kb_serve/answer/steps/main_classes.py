"""The classes that a topic's steps are about: of all that its pages explain and its words name, what is meant."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import terms
from kb_build.symbols.api_names import OPERATORS, TYPES
from kb_serve.answer.steps.setting.settings_of_made import OTHERS_ELEMENT
from kb_serve.answer.ways.operator_needs import needs_nothing
from kb_serve.interface import is_of_interface

if TYPE_CHECKING:
    from kb_serve.answer.steps.names.topic_names import TopicNames
    from kb_serve.lookups.records import Creation
    from kb_serve.reader import BaseReader

_LEAST_SHARE = 0.25  # of the heaviest class's weight
_MODIFIER = f"{TYPES}Modifier"  # of objects
_LEGACY = "(Legacy)"  # at the end of labels


class MainClasses:
    """The main classes of one topic.

    ``creations``: what makes the classes of the topic that are made; ``paths``: the main classes, the first first.
    """

    def __init__(self, reader: BaseReader, names: TopicNames) -> None:
        self._reader = reader
        self._names = names
        made = reader.makers.creations(list(names.classes))
        self.creations = {
            path: one
            for path, one in made.items()
            if not self._is_in_nothing(path, one) and not self._is_kept_for_old_files(path)
        }
        self.paths = self._chosen()

    def is_in_scene(self, path: str) -> bool:
        """Whether a class is made, and that not in Blender's interface."""
        return path in self.creations and not is_of_interface(self.creations[path].call)

    def is_kept_by_user(self, path: str) -> bool:
        """Whether Blender's preferences hold what ends as the topic is called: the user's asset libraries."""
        return path in self.creations and not self.is_in_scene(path) and self._names.ends_as_title(path)

    def has_title(self, path: str) -> bool:
        """Whether the name or label of a class holds all words of the topic's title."""
        entry = self._reader.entry(path)
        return entry is not None and self._names.has_title(f"{entry.name} {entry.label} {entry.name.lower()}")

    def is_modifier(self, path: str) -> bool:
        """Whether a class is the modifier of objects that is called as the topic is."""
        return self._names.has_modifier(path) and self._reader.descends(path, _MODIFIER)

    def are_made(self) -> bool:
        """Whether the first main class is made, or held by a modifier that is."""
        return any(map(self.is_in_scene, self.paths[:1])) or any(map(self.is_modifier, self.paths))

    def are_on_made(self) -> bool:
        """Whether the first main class is reached through something that the topic's steps make."""
        records = [self._reader.symbol(path) for path in self.paths if path in self.creations]
        makers = [record.reached for record in records if record and record.reached]
        mains = [self._reader.symbol(path) for path in self.paths[:1]]
        return any(main.reached.startswith(f"{maker}.") for main in mains if main for maker in makers)

    def counts(self, *paths: str) -> bool:
        """Whether classes weigh enough, together, beside the topic's heaviest."""
        heaviest_one = max(map(self._names.classes.__getitem__, self.paths))
        return self._names.weight_of(paths) >= _LEAST_SHARE * heaviest_one

    def _chosen(self) -> list[str]:
        """Where classes have the topic's name, best its whole title, the others of its pages are other topics' matter,
        unless these alone can be made.
        """
        named = [path for path in self._names.classes if self._names.names(path)]
        titled = [path for path in self._names.classes if self.has_title(path)]
        made = self.creations.keys() & titled
        if made and (not self._names.explained.isdisjoint(made) or self._are_heavy(titled, named or titled)):
            named = sorted(titled, key=lambda path: path not in self._names.explained)
        named = self._with_kinds(named)
        if not titled and (explained := self._explained()) and not set(named[:1]) & self._names.explained:
            named = explained
        # What only has settings is made by what is called so and is of a kind that is made.
        made = self._names.of_kind & self.creations.keys()
        if made and self.creations.keys().isdisjoint(named[:1]):
            named = [*(path for path in self._names.classes if path in made), *named]
            named = list(dict.fromkeys(named))
        elif self.creations and self.creations.keys().isdisjoint(named):
            named = []
        called = tuple(path.removeprefix(TYPES) for path in named if self._is_the_topic(path))
        named = [path for path in named if not self._is_anothers(path, called)] or list(self._names.classes)
        return [path for path in named if not self._is_elsewhere(path)]

    def _are_heavy(self, paths: list[str], beside: list[str]) -> bool:
        """Whether the heaviest of some classes weighs enough beside that of others."""
        heaviest, other = (max(map(self._names.classes.__getitem__, each)) for each in (paths, beside))
        return heaviest >= _LEAST_SHARE * other

    def _with_kinds(self, named: list[str]) -> list[str]:
        """Some classes, and those of the topic that derive from one which is not made for itself."""
        bases = {path for path in named if path not in self.creations}
        kinds = (
            path
            for path in self._names.classes
            if not bases.isdisjoint(base.path for base in self._reader.lineage(path))
        )
        return list(dict.fromkeys((*named, *kinds)))

    def _explained(self) -> list[str]:
        """What the page explains and can be made, if its name says something of the title: what a page on one kind of
        strip explains, rather than what else is called image.
        """
        title = set(self._names.words[0]) if self._names.words else set[str]()
        shared = {
            path: len(title & set(terms(path.removeprefix(TYPES))))
            for path in self._names.classes
            if path in self._names.explained and path in self.creations
        }
        return sorted((path for path in shared if shared[path]), key=lambda path: -shared[path])

    def _is_the_topic(self, path: str) -> bool:
        return path in self.creations and self._names.is_called(path)

    def _is_anothers(self, path: str, called: tuple[str, ...]) -> bool:
        """Whether an operator makes what only ends as the topic is called: the world of rigid bodies."""
        creation = self.creations.get(path)
        is_by_operator = creation is not None and creation.call.startswith(OPERATORS)
        return is_by_operator and path.endswith(called) and path.removeprefix(TYPES) not in called

    def _is_elsewhere(self, path: str) -> bool:
        """Whether a class only has the topic's words in its name, and other pages explain it: a constraint that tracks
        is no tracking of a film. The modifier that is called as the topic is its own wherever it is explained, and what
        is called so, with its kinds, if nothing else of the topic is made: the user's asset library for asset
        libraries.
        """
        if path not in self._names.elsewhere:
            return False
        is_modifier = path.endswith("Modifier") and self._names.is_called(path.removesuffix("Modifier"))
        own = self.creations.keys() & self._names.classes.keys() - self._names.elsewhere
        called = (self._names.is_called(base.path) for base in self._reader.lineage(path))
        return not (is_modifier or (not own and (any(called) or self.is_kept_by_user(path))))

    def _is_kept_for_old_files(self, path: str) -> bool:
        """Whether Blender's menus make no such thing any more: ``Mix (Legacy)``."""
        entry = self._reader.entry(path)
        return entry is not None and entry.label.endswith(_LEGACY)

    def _is_in_nothing(self, path: str, creation: Creation) -> bool:
        """Whether an operator that runs anywhere makes a part of what an element has that somebody must have made: it
        takes that from the context, and else does nothing.
        """
        cls, maker = self._reader.symbol(path), self._reader.symbol(creation.maker)
        is_anywhere = creation.call.startswith(OPERATORS) and maker is not None and needs_nothing(maker)
        return is_anywhere and cls is not None and OTHERS_ELEMENT.search(cls.reached) is not None
