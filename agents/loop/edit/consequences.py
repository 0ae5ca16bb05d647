"""Which changes of data-blocks follow from what the plan of an edit names, and from what each of them does."""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence, Set

    from agents.plan.edit import EditPlan

Uses: TypeAlias = "Mapping[str, Mapping[str, Sequence[str]]]"

NAMED = "named by the plan"
_BAKED = "a simulation was baked"
_OBJECT, _COLLECTION, _SCENE = "Object", "Collection", "Scene"
_FREE = frozenset({_OBJECT, _COLLECTION, _SCENE})  # they are somebody's own, whoever uses them
_HOLDING = frozenset({"objects", "children", "collection", "view layers"})
_CALLED = {"NodeTree": "node group", "Key": "shape keys", "ParticleSettings": "particle settings"}


class Consequences:
    """``reasons``: of each data-block that changed as planned, or because of that, why. All others were not asked for.

    Data-blocks are called as "Object Cube". ``before`` and ``after`` tell what each part of one points to; ``changed``
    has the parts that differ, of those that are neither added nor removed.
    """

    def __init__(  # noqa: PLR0913 - two states and what is between them
        self,
        before: Uses,
        after: Uses,
        plan: EditPlan,
        *,
        added: Set[str],
        removed: Set[str],
        changed: Mapping[str, Sequence[str]],
    ) -> None:
        self._before, self._after, self._plan = before, after, plan
        self._added, self._removed, self._changed = added, removed, changed
        self._users = {True: _users_of(after), False: _users_of(before)}
        self._moves = bool(plan.actors) or not {"motion", "deformation_setup"}.isdisjoint(plan.stages)
        self._owned: dict[tuple[str, bool], str] = {}
        self._inside = _below({*before, *after} | added | removed, plan.targets, before, after)
        # Each actor is to have a collection with its tags: grouping changes nothing else of what it holds.
        self._groups = {f"{_COLLECTION} {actor.name}" for actor in plan.actors} & added
        self._grouped = _below(self._groups, {actor.name for actor in plan.actors}, after)
        self.reasons: dict[str, str] = {}
        self._find()

    def explain(self, key: str) -> str:
        """Why a data-block was changed, in a few words; of one that nobody asked for, what is known."""
        if key in self.reasons:
            return self.reasons[key]
        users = {user for user, _ in self._users[key not in self._removed][key]}
        others = sorted(_name(user) for user in users if not self._owner(user, now=key not in self._removed))
        if _kind(key) in _FREE or not others or len(others) == len(users):
            return ""
        return f"not only of what the plan names, but of {', '.join(others[:5])}, too"

    def _find(self) -> None:
        """One reason may lead to the next, until none is found."""
        touched = {*self._added, *self._removed, *self._changed}
        before = -1
        while before != len(self.reasons):
            before = len(self.reasons)
            self._owned.clear()
            for key in sorted(touched - self.reasons.keys()):
                if reason := self._reason(key):
                    self.reasons[key] = reason

    def _reason(self, key: str) -> str:
        if reason := self._owner(key, now=key not in self._removed):
            return reason
        if key in self._changed:
            return self._reason_of_change(key)
        if _kind(key) == _COLLECTION:
            return self._reason_of_collection(key)
        return self._reason_of_new_object(key) if key in self._added and _kind(key) == _OBJECT else ""

    # Whose a data-block is

    def _is_named(self, key: str) -> bool:
        name = _name(key)
        return name in self._plan.targets or key in self._plan.targets or key in self._inside

    def _owner(self, key: str, *, now: bool, seen: frozenset[str] = frozenset()) -> str:
        """Why it may be changed, whatever it is: the plan names it, or only such use it as may; "" if it may not."""
        if self._is_named(key):
            return self._owner_by_use(key, now, seen | {key}) or NAMED if key not in seen else NAMED
        if key in self.reasons and key not in self._changed:
            return self.reasons[key]
        if (key, now) not in self._owned:
            self._owned[key, now] = "" if key in seen else self._owner_of_data(key, now, seen | {key})
        return self._owned[key, now]

    def _owner_of_data(self, key: str, now: bool, seen: frozenset[str]) -> str:
        if reason := self._owner_by_use(key, now, seen):
            return reason
        stem = next((name for name in sorted(self._plan.targets) if _is_part_name(_name(key), name)), "")
        return f"called as a part of {stem}" if stem and key not in self._changed else ""

    def _owner_by_use(self, key: str, now: bool, seen: frozenset[str]) -> str:
        users = sorted({user for user, _ in self._users[now][key]})
        if _kind(key) not in _FREE and users and all(self._owner(one, now=now, seen=seen) for one in users):
            return f"{_called(key)} of {_name(users[0])}"
        return ""

    # What else comes and goes

    def _reason_of_new_object(self, key: str) -> str:
        for above in self._after.get(key, {}).get("parent", ()):
            if self._owner(above, now=True):
                return f"below {_name(above)}"
        for user, part in sorted(self._users[True][key]):
            if _kind(user) not in {_COLLECTION, _SCENE} and self._owner(user, now=True):
                return f"{'carries' if part == 'parent' else 'used by'} {_name(user)}"
        is_empty = not self._after.get(key, {}).get("data")
        return "root of an actor" if is_empty and key in self._grouped else ""

    def _reason_of_collection(self, key: str) -> str:
        now = key in self._added
        if key in self._groups:
            return f"has the tags of the actor {_name(key)}"
        uses = (self._after if now else self._before).get(key, {})
        held = sorted({one for part in _HOLDING for one in uses.get(part, ())})
        if held and all(self._is_meant(one) for one in held):
            return f"{'holds' if now else 'held'} {_name(held[0])}"
        return self._reason_of_bodies(key)

    def _reason_of_bodies(self, key: str) -> str:
        users = self._users[key not in self._removed][key]
        is_world = any((_kind(user), part) == (_SCENE, "physics") for user, part in users)
        return "bodies of the rigid-body world" if is_world and self._moves else ""

    # What has changed without being named

    def _reason_of_change(self, key: str) -> str:
        """A reason if there is one for each part that has changed."""
        found = [
            _BAKED if part == "caches" else self._reason_of_part(key, part) for part in self._changed[key]
        ]
        return ", ".join(dict.fromkeys(found)) if found and all(found) else ""

    def _reason_of_part(self, key: str, part: str) -> str:
        one, other = (set(uses.get(key, {}).get(part, ())) for uses in (self._before, self._after))
        gone, come = sorted(one - other), sorted(other - one)
        if gone and not come and all(name in self._removed and self._is_meant(name) for name in gone):
            return f"{'held' if part in _HOLDING else 'used'} {_name(gone[0])}"
        match _kind(key):
            case "Collection" | "Scene" if (gone or come) and all(map(self._may_go_round, (*gone, *come))):
                return f"{'holds' if part in _HOLDING else 'uses'} {_name((*come, *gone)[0])}"
            case "Collection":
                return self._reason_of_bodies(key)
            case "Scene":
                return self._reason_of_setting(part)
            case "Object":
                return self._reason_of_place(key, part, come)
            case _:
                return ""

    def _reason_of_place(self, key: str, part: str, come: Sequence[str]) -> str:
        """Why an object has another parent, or its transform goes with that."""
        if part == "transform" and "parent" in self._changed[key]:
            return self._reason_of_part(key, "parent")
        is_grouped = part == "parent" and come and self._grouped.issuperset({key, *come})
        return f"grouped below {_name(come[0])}" if is_grouped else ""

    def _may_go_round(self, key: str) -> bool:
        """Whether a data-block may leave or enter a collection: it is meant to change, or grouped into an actor."""
        return key in self._grouped or self._is_meant(key)

    def _is_meant(self, key: str) -> bool:
        return key in self.reasons or bool(self._owner(key, now=key not in self._removed))

    def _reason_of_setting(self, part: str) -> str:
        plan = self._plan
        match part:
            case "render":
                return "how the plan has it rendered"
            case "frame range" if plan.actors or plan.frame_start is not None or plan.frame_end is not None:
                return "the frames of the plan"
            case "physics" if self._moves:
                return "the rigid-body world of what moves"
            case "view layers" if self._has_moved_collections():
                return "shows the collections that came or went"
            case _:
                return ""

    def _has_moved_collections(self) -> bool:
        return any(_kind(key) == _COLLECTION for key in self.reasons if key not in self._changed)


def _kind(key: str) -> str:
    return key.partition(" ")[0]


def _name(key: str) -> str:
    return key.partition(" ")[2]


def _called(key: str) -> str:
    kind = _kind(key)
    return _CALLED.get(kind) or re.sub(r"(?<=[a-z])(?=[A-Z])", " ", kind).lower()


def _is_part_name(name: str, whole: str) -> bool:
    """Mug.001, Mug_handle or MugHandle for Mug."""
    rest = name.removeprefix(whole)
    return rest not in {"", name} and not (rest[0].islower() or rest[0].isdigit())


def _users_of(uses: Uses) -> dict[str, set[tuple[str, str]]]:
    """{data-block: (who uses it, with which part)}."""
    found: dict[str, set[tuple[str, str]]] = defaultdict(set)
    for user, parts in uses.items():
        for part, used in parts.items():
            for one in used:
                found[one].add((user, part))
    return found


def _below(keys: Iterable[str], targets: Set[str], *states: Uses) -> set[str]:
    """What is in the collections that the plan names, and below them."""
    found: set[str] = set()
    waiting = [key for key in keys if _kind(key) == _COLLECTION and _name(key) in targets]
    while waiting:
        key = waiting.pop()
        for uses in states:
            for part in _HOLDING:
                new = set(uses.get(key, {}).get(part, ())) - found
                found |= new
                waiting += new
    return found
