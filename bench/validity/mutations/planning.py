"""Plans the mutations of a scene, and compares the audits before and after each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from bench.validity.mutations.catalogue import MUTATIONS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from bench.audit.actors import ActorResolution
    from bench.audit.audit import Audit, CheckResult
    from bench.audit.facts import Object, Scene
    from bench.validity.mutations.catalogue import Consequence, Mutation, Who
    from bench.validity.variant_builder import SceneReading


@dataclass(frozen=True, slots=True, order=True)
class CheckPlace:
    """Identifies a check of a spec: actor ("" for the whole scene), number in its list, predicate."""

    actor: str
    number: int
    predicate: str

    @property
    def label(self) -> str:
        """In words."""
        return f"{self.actor or 'scene'}: {self.predicate}"


@dataclass(frozen=True, slots=True)
class PlannedMutation:
    """A mutation that is to break the check at ``place``: of ``objects`` (names), with all options of the change."""

    place: CheckPlace
    mutation: Mutation
    objects: tuple[str, ...]
    options: Mapping[str, Any]

    @property
    def label(self) -> str:
        """In words."""
        return f"{self.place.label} by {self.mutation.label}"


def checks_of(audit: Audit) -> dict[CheckPlace, CheckResult]:
    """All checks of an audit, by place."""
    checks = {
        CheckPlace(actor.name, number, check.predicate): check
        for actor in audit.actors
        for number, check in enumerate(actor.checks)
    }
    checks |= {
        CheckPlace("", number, check.predicate): check for number, check in enumerate(audit.assertions)
    }
    return checks


def planned_mutations(audit: Audit, actors: Mapping[str, ActorResolution]) -> Iterator[PlannedMutation]:
    """Yields the mutations of every check that passes in a scene."""
    for place, check in checks_of(audit).items():
        if check.outcome != "passed":
            continue
        own = actors[place.actor] if place.actor else None
        role = own.actor.role if own is not None else ""
        for mutation in MUTATIONS[place.predicate]:
            if mutation.roles and role not in mutation.roles:
                continue
            options = dict(mutation.options)
            if mutation.given is not None:
                options |= mutation.given(check.params, check.seen)
            for objects in _objects(mutation, check, own, actors):
                yield PlannedMutation(place, mutation, objects, options)


def _objects(
    mutation: Mutation, check: CheckResult, own: ActorResolution | None, actors: Mapping[str, ActorResolution]
) -> Iterator[tuple[str, ...]]:
    """Yields the objects to change: one choice for each partner where there are several."""
    if own is None or mutation.on == "scene":
        yield ()
    elif mutation.on == "partner":
        named = check.params.get("partners")
        if named:
            yield from (_of_actor(actors[name]) for name in named)
        else:
            others = (actor for actor in actors.values() if actor is not own)
            yield tuple(name for actor in others for name in _of_actor(actor))
    else:
        yield tuple(obj.name for unit in own.units[: _units_to_break(check)] for obj in unit.objects)


def _of_actor(actor: ActorResolution) -> tuple[str, ...]:
    return tuple(name for unit in actor.units for name in sorted(unit.names))


def _units_to_break(check: CheckResult) -> int:
    """The smallest number of units that must be broken for the check to fail, whichever they are."""
    if check.wanted == "must_not_have" or "needed" not in check.seen:
        return 1
    return check.seen["units"] - check.seen["needed"] + 1


@dataclass(frozen=True, slots=True)
class MutationResult:
    """What a mutation did: whether its check failed, and which others flipped, with and without a reason."""

    detected: bool
    expected: tuple[CheckPlace, ...]
    unexpected: tuple[CheckPlace, ...]

    @property
    def holds(self) -> bool:
        """Whether the check failed, and others only for a reason."""
        return self.detected and not self.unexpected


def judge(
    planned: PlannedMutation, whole: SceneReading, after: Audit, changed: Sequence[str]
) -> MutationResult:
    """Compares the audits. ``whole``: the scene before; ``changed``: names of the objects that were changed."""
    old, new = checks_of(whole.audit), checks_of(after)
    flipped = [place for place, check in old.items() if new[place].outcome != check.outcome]
    affected = _AffectedActors(whole, changed)
    expected: list[CheckPlace] = []
    unexpected: list[CheckPlace] = []
    for place in flipped:
        if place != planned.place:
            reason = any(affected.explains(each, place, old[place]) for each in planned.mutation.consequences)
            (expected if reason else unexpected).append(place)
    detected = planned.place in flipped and new[planned.place].outcome == "failed"
    return MutationResult(detected, tuple(expected), tuple(unexpected))


class _AffectedActors:
    """The actors that a change of objects may affect."""

    def __init__(self, whole: SceneReading, changed: Sequence[str]) -> None:
        self._found = found = whole.found
        own = set(changed)
        carried = own | {obj.name for obj in whole.scene.objects if _follows(obj, own, whole.scene)}
        self._actors: dict[Who, set[str]] = {
            "changed": self._of(own),
            "carried": self._of(carried),
            "all": set(found),
        }

    def _of(self, objects: set[str]) -> set[str]:
        return {name for name, actor in self._found.items() if any(u.names & objects for u in actor.units)}

    def explains(self, consequence: Consequence, place: CheckPlace, check: CheckResult) -> bool:
        """Whether a check may flip as that consequence."""
        if place.predicate not in consequence.predicates:
            return False
        if consequence.who == "meeting":
            partners = set(check.params.get("partners") or self._actors["all"])
            return bool(partners & self._actors["changed"])
        return place.actor in self._actors[consequence.who]


def _follows(obj: Object, others: set[str], scene: Scene) -> bool:
    """Whether an object moves with one of ``others`` (names), directly or through further objects."""
    objects = {each.name: each for each in scene.objects}
    waiting, seen = list(obj.follows), {obj.name}
    while waiting:
        name = waiting.pop()
        if name in others:
            return True
        if name not in seen and name in objects:
            seen.add(name)
            waiting += objects[name].follows
    return False
