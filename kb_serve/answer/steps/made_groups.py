"""What of a topic's main classes is made, by what makes it, in the order in which steps make it."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.api_names import NODE, OPERATORS
from kb_build.symbols.flags import operator_areas
from kb_serve.answer.steps.making.trees import EMBEDDED_TREES
from kb_serve.answer.ways.operator_needs import needs_nothing

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kb_serve.answer.steps.main_classes import MainClasses
    from kb_serve.answer.steps.names.topic_names import TopicNames
    from kb_serve.lookups.records import Creation
    from kb_serve.reader import BaseReader

_MAKERS = 3
_IN_A_NODE = ".nodes["  # in a call that makes what a node holds
_NOT_MADE = frozenset({NODE, *EMBEDDED_TREES})  # for themselves


class MadeGroup(NamedTuple):
    """The classes that one maker makes; ``is_first``: whether the topic is about these before all others."""

    creations: Mapping[str, Creation]
    is_first: bool


class MadeGroups:
    """The groups of one topic."""

    def __init__(self, reader: BaseReader, names: TopicNames, main: MainClasses) -> None:
        self._reader = reader
        self._names = names
        self._main = main

    def in_order(self) -> Iterator[MadeGroup]:
        """The groups that steps make. What an operator makes that needs nothing comes first: a world, before what is in
        it makes one; nodes come before their items, which they are told with.
        """
        groups = self._chosen()
        firsts = {id(group): next(iter(group.values())) for group in groups}
        for creations in sorted(
            groups,
            key=lambda group: (
                not self._needs_nothing(firsts[id(group)]),
                _IN_A_NODE in firsts[id(group)].call,
            ),
        ):
            yield MadeGroup(creations, creations is groups[0])

    def _chosen(self) -> list[dict[str, Creation]]:
        """The few groups that the topic is about, and with the first what the same collection makes by other functions:
        strips of sounds, of films, of images.
        """
        groups = self._all()
        chosen = [
            group
            for rank, group in enumerate(groups)
            if self._is_main(group) and not (rank and (self._is_in_area(group) or self._is_by_hand(group)))
        ][:_MAKERS]
        beside = [group for group in groups if chosen and _is_made_alike(group, chosen[0])]
        return [*beside, *(group for group in chosen if group not in beside)]

    def _all(self) -> list[dict[str, Creation]]:
        """The classes that are made, by what makes them, each group with its heaviest class first."""
        groups: dict[str, dict[str, Creation]] = defaultdict(dict)
        # A modifier with the topic's name makes the settings that it holds; kinds of what is called so come next.
        for path in sorted(
            self._main.paths, key=lambda path: (not self._main.is_modifier(path), not self._is_of_kind(path))
        ):
            creation = self._main.creations.get(path)
            is_left = path in _NOT_MADE or self._is_of_made_data(path)
            is_aside = not (self._main.is_in_scene(path) or self._main.is_kept_by_user(path))
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
        is_made = data != path and data in self._main.paths and data in self._main.creations
        return is_made and self._reader.is_object_data(data)

    def _is_main(self, creations: Mapping[str, Creation]) -> bool:
        """Whether the topic is about what one maker makes: the kinds of its main class, too."""
        first, main = next(iter(creations)), self._main.paths[0]
        is_kind = first != main and self._reader.descends(first, main)
        return self._main.is_modifier(first) or is_kind or self._main.counts(*creations)

    def _is_in_area(self, creations: Mapping[str, Creation]) -> bool:
        """Whether an operator makes something in an area of a window alone, which a script need not have."""
        creation = next(iter(creations.values()))
        maker = self._reader.symbol(creation.maker) if creation.call.startswith(OPERATORS) else None
        return maker is not None and bool(operator_areas(maker))

    def _is_by_hand(self, creations: Mapping[str, Creation]) -> bool:
        """Whether an operator makes something beside what the file's own function makes: a second slot for a material
        that assigning it has given one.
        """
        first = self._main.creations.get(self._main.paths[0])
        is_by_data = first is not None and first.call.startswith("bpy.data.")
        return is_by_data and all(one.call.startswith(OPERATORS) for one in creations.values())

    def _needs_nothing(self, creation: Creation) -> bool:
        """Whether an operator makes a thing wherever it is called."""
        maker = self._reader.symbol(creation.maker)
        return maker is not None and needs_nothing(maker)


def _is_made_alike(creations: Mapping[str, Creation], others: Mapping[str, Creation]) -> bool:
    """Whether the makers of some classes are functions of one class."""
    makers = {next(iter(each.values())).maker.rpartition(".")[0] for each in (creations, others)}
    return len(makers) == 1 and not any(maker.startswith(OPERATORS) for maker in makers)
