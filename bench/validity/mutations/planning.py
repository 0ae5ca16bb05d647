"""Which sabotages a scene calls for, and what came of one: which checks it flipped, and which it had reason to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from bench.validity.mutations.catalogue import SABOTAGES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from bench.audit.actors import ActorResolution
    from bench.audit.audit import Audit, CheckResult
    from bench.audit.facts import Object, Scene
    from bench.validity.mutations.catalogue import Follows, Sabotage, Who
    from bench.validity.variant_builder import Reading


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """A check of a spec: the actor ("" for the scene as a whole), its place in the list, the predicate."""

    actor: str
    number: int
    predicate: str

    @property
    def told(self) -> str:
        """In words."""
        return f"{self.actor or 'scene'}: {self.predicate}"


@dataclass(frozen=True, slots=True)
class Aim:
    """A sabotage of one check: of ``objects``, by name, with all that the change needs."""

    place: Place
    sabotage: Sabotage
    objects: tuple[str, ...]
    options: Mapping[str, Any]

    @property
    def told(self) -> str:
        """In words."""
        return f"{self.place.told} by {self.sabotage.told}"


def checks_of(audit: Audit) -> dict[Place, CheckResult]:
    """All checks of an audit, by place."""
    found = {
        Place(actor.name, number, check.predicate): check
        for actor in audit.actors
        for number, check in enumerate(actor.checks)
    }
    found |= {Place("", number, check.predicate): check for number, check in enumerate(audit.assertions)}
    return found


def aims(audit: Audit, found: Mapping[str, ActorResolution]) -> Iterator[Aim]:
    """The sabotages of every check that passes in a scene."""
    for place, check in checks_of(audit).items():
        if check.outcome != "passed":
            continue
        own = found[place.actor] if place.actor else None
        role = own.actor.role if own is not None else ""
        for sabotage in SABOTAGES[place.predicate]:
            if sabotage.roles and role not in sabotage.roles:
                continue
            options = dict(sabotage.options)
            if sabotage.given is not None:
                options |= sabotage.given(check.params, check.seen)
            for objects in _objects(sabotage, check, own, found):
                yield Aim(place, sabotage, objects, options)


def _objects(
    sabotage: Sabotage, check: CheckResult, own: ActorResolution | None, found: Mapping[str, ActorResolution]
) -> Iterator[tuple[str, ...]]:
    """The objects to change: several choices where there are several partners, each of which counts."""
    if own is None or sabotage.on == "scene":
        yield ()
    elif sabotage.on == "partner":
        named = check.params.get("partners")
        if named:
            yield from (_of_actor(found[name]) for name in named)
        else:
            others = (one for one in found.values() if one is not own)
            yield tuple(name for one in others for name in _of_actor(one))
    else:
        yield tuple(one.name for unit in own.units[: _enough(check)] for one in unit.objects)


def _of_actor(one: ActorResolution) -> tuple[str, ...]:
    return tuple(name for unit in one.units for name in sorted(unit.names))


def _enough(check: CheckResult) -> int:
    """How many units must be broken for the check to fail, whichever they are: no more, so that each of them counts."""
    if check.wanted == "must_not_have" or "needed" not in check.seen:
        return 1
    return check.seen["units"] - check.seen["needed"] + 1


@dataclass(frozen=True, slots=True)
class Result:
    """What a sabotage did: whether the check flipped, which others did with reason, and which without."""

    hit: bool
    followed: tuple[Place, ...]
    spilled: tuple[Place, ...]

    @property
    def holds(self) -> bool:
        """Whether that check flipped, and only what follows."""
        return self.hit and not self.spilled


def judge(aim: Aim, whole: Reading, after: Audit, changed: Sequence[str]) -> Result:
    """Compares audits. ``whole``: the scene as it was; ``changed``: names of the objects that were changed in it."""
    old, new = checks_of(whole.audit), checks_of(after)
    flipped = [place for place, check in old.items() if new[place].outcome != check.outcome]
    touched = _Touched(whole, changed)
    followed: list[Place] = []
    spilled: list[Place] = []
    for place in flipped:
        if place != aim.place:
            reason = any(touched.reaches(each, place, old[place]) for each in aim.sabotage.follows)
            (followed if reason else spilled).append(place)
    hit = aim.place in flipped and new[aim.place].outcome == "failed"
    return Result(hit, tuple(followed), tuple(spilled))


class _Touched:
    """Which actors a change of objects has to do with."""

    def __init__(self, whole: Reading, changed: Sequence[str]) -> None:
        self._found = found = whole.found
        own = set(changed)
        carried = own | {one.name for one in whole.scene.objects if _follows(one, own, whole.scene)}
        self._actors: dict[Who, set[str]] = {
            "changed": self._of(own),
            "carried": self._of(carried),
            "all": set(found),
        }

    def _of(self, objects: set[str]) -> set[str]:
        return {name for name, one in self._found.items() if any(unit.names & objects for unit in one.units)}

    def reaches(self, follows: Follows, place: Place, check: CheckResult) -> bool:
        """Whether a check may flip for that reason."""
        if place.predicate not in follows.predicates:
            return False
        if follows.who == "meeting":
            partners = set(check.params.get("partners") or self._actors["all"])
            return bool(partners & self._actors["changed"])
        return place.actor in self._actors[follows.who]


def _follows(one: Object, others: set[str], scene: Scene) -> bool:
    objects = {each.name: each for each in scene.objects}
    waiting, seen = list(one.follows), {one.name}
    while waiting:
        name = waiting.pop()
        if name in others:
            return True
        if name not in seen and name in objects:
            seen.add(name)
            waiting += objects[name].follows
    return False
