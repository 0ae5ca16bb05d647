"""Names that this Blender lacks and models are likely to write, with what took their place.

A model writes what it has read, and has read most of what has been there for long and is used much. So a name weighs
as its successor and the class that this belongs to do, more if it was there in many versions and until lately, less if
it belongs to Blender's interface.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.symbols.paths import plain_path, split_path
from kb_serve.answer.budget import tokens
from kb_serve.packs.section import is_for_users, short

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kb_serve.reader import BaseReader

_OWN = 1.6  # of the weight of the class that a successor belongs to, beside its own
_OF_SOCKET = 1.0  # sockets have no weight of their own: the share of their node's that they have
_FOR_USERS = 0.25
_OF_NO_SCENE = 0.5  # what no expression leads to
_NO_SUCCESSOR = 0.8
_RENAMED_OWNER = 0.7  # a class that is gone as a whole: scripts rarely name classes
_AGES = (
    (3, 1.3),
    (8, 1.0),
    (14, 0.6),
    (30, 0.3),
)  # for how many versions a name is gone, and how likely it is written
_LEFT_OWNER = 1.5  # what is left of a class that stays: scripts go on to lead to it
_NOTHING = "Nothing takes its place."
_REPEATED = 0.7
_MOST_NAMES = 6  # that share one successor, on one line


@dataclass(frozen=True, slots=True)
class Change:
    """A name that is gone (``old``, a path), what took its place (``new``; empty: nothing) and what else changes."""

    old: str
    new: str
    how: str
    gone: str
    score: float


@dataclass(slots=True)
class _Group:
    """Changes of one owner."""

    owner: str
    changes: list[Change] = field(default_factory=list[Change])


def owner_of(path: str) -> str:
    """The class, function or enumeration that a path is a part of; of a class its module."""
    whole = plain_path(path)
    return whole if whole != path else split_path(path)[0]


class Changes:
    """The changes that a base knows."""

    def __init__(self, reader: BaseReader, concerns: Callable[[str], bool] | None = None) -> None:
        """``concerns`` says of a path of this Blender whether a change that leads to it, or its class, is wanted."""
        self._reader = reader
        self._concerns = concerns
        self._versions = reader.history.history_versions

    @cached_property
    def ranked(self) -> list[Change]:
        """All that are worth telling, the likeliest first."""
        rows = self._reader.rows(
            "SELECT removed.path, first, last, gone, target, how FROM removed JOIN successors USING (path) "
            "WHERE position = 0 AND gone != '' ORDER BY removed.path"
        )
        classes = {path: target for path, _, _, _, target, _ in rows if owner_of(path) == "bpy.types"}
        paths = {path for row in rows for path in (row[0], row[4]) if path}
        weights = self._reader.usage.weights(list(paths | {owner_of(path) for path in paths}))
        changes = [
            Change(path, target, how, gone, self._score(path, first, last, gone, target, weights))
            for path, first, last, gone, target, how in rows
            if not _follows(path, target, classes) and self._is_wanted(path, target)
        ]
        return _varied(changes)

    def _is_wanted(self, path: str, target: str) -> bool:
        return self._concerns is None or self._concerns(target) or self._concerns(owner_of(path))

    def _score(  # noqa: PLR0913, PLR0917 - a row of two tables
        self, path: str, first: str, last: str, gone: str, target: str, weights: dict[str, float]
    ) -> float:
        owner = owner_of(target or path)
        own = _OF_SOCKET * weights.get(owner, 0.0) if target.endswith('"]') else weights.get(target, 0.0)
        weight = own + _OWN * weights.get(owner, 0.0)
        holder = target if owner in {"bpy.types", ""} else owner
        here = self._place(self._reader.meta["minor"])
        age = next((share for versions, share in _AGES if here - self._place(gone) <= versions), 0.0)
        time = math.sqrt((self._place(last) - self._place(first) + 1) / len(self._versions))
        return (
            weight
            * age
            * time
            * min(self._scene_share(holder), self._scene_share(owner_of(path)))
            * (1 if target else _NO_SUCCESSOR)
            * (_RENAMED_OWNER if owner_of(path) == "bpy.types" else 1)
            * (_LEFT_OWNER if self._reader.entry(owner_of(path)) is not None else 1)
        )

    def _place(self, version: str) -> int:
        return self._versions.index(version) if version in self._versions else 0

    def _scene_share(self, holder: str) -> float:
        """How much a class has to do with scenes rather than with Blender's windows."""
        symbol = self._reader.symbol(holder)
        if symbol is None or symbol.kind != "class":
            return 1.0
        if is_for_users(symbol):
            return _FOR_USERS
        return 1.0 if symbol.reached else _OF_NO_SCENE

    def fill(self, budget: int) -> list[str]:
        """Lines of the likeliest changes that fit, those of one owner on one line."""
        groups: dict[str, _Group] = {}
        spent = 0
        for change in self.ranked:
            group = groups.get(owner_of(change.old))
            cost = self._cost(group, change)
            if spent + cost > budget:
                break
            spent += cost
            groups.setdefault(owner_of(change.old), group or _Group(owner_of(change.old))).changes.append(
                change
            )
        return [_line(group) for group in groups.values()]

    def _cost(self, group: _Group | None, change: Change) -> int:
        new = _Group(owner_of(change.old), [*(group.changes if group else ()), change])
        return tokens(_line(new) + "\n") - (tokens(_line(group) + "\n") if group else 0)


def _varied(changes: Iterable[Change]) -> list[Change]:
    """Changes by score; each further one to the same successor counts less."""
    before: Counter[str] = Counter()
    counted: list[tuple[float, Change]] = []
    for change in sorted(changes, key=lambda change: (-change.score, change.old)):
        if change.score:
            counted.append((change.score * _REPEATED ** before[change.new], change))
            before[change.new] += 1
    return [change for _, change in sorted(counted, key=lambda row: -row[0])]


def _follows(path: str, target: str, classes: dict[str, str]) -> bool:
    """Whether a member's change says no more than that of its class."""
    owner = owner_of(path)
    successor = classes.get(owner)
    return bool(successor) and target == successor + path.removeprefix(owner)


def _line(group: _Group) -> str:
    """``- SceneEEVEE: use_ssr → use_raytracing (4.3)``; names that share all else stand together."""
    alike: dict[tuple[str, str, str], list[str]] = defaultdict(list)
    for change in group.changes:
        name = change.old.removeprefix(group.owner).removeprefix(".")
        alike[_inner(change.new, group.owner), change.how, change.gone].append(name)
    parts = [_part(names, *rest) for rest, names in alike.items()]
    owner = {"bpy.types": "classes", "": "modules"}.get(group.owner, short(group.owner))
    return f"- {owner}: " + "; ".join(parts)


def _inner(path: str, owner: str) -> str:
    """A successor as it is written on its owner's line."""
    if path.startswith((f"{owner}.", f"{owner}(", f"{owner}:")):
        return path.removeprefix(owner).removeprefix(".")
    return short(path)


def _part(names: Iterable[str], new: str, how: str, gone: str) -> str:
    names = list(names)
    told = ", ".join(f"`{name}`" for name in names[:_MOST_NAMES])
    told += f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
    if not new:
        return f"{told} → nothing ({gone}{', ' + how.rstrip('.') if how and how != _NOTHING else ''})"
    return f"{told} → `{new}` ({gone}{', ' + how.rstrip('.') if how else ''})"
