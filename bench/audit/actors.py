"""Finds a spec's actors in a scene that was made without the spec: by names, then by their role and hints.

An actor is found as one or more units (twelve dominoes: twelve), each an object with its descendants, or the members of
a collection; objects shown as particles are part of their emitter. An object belongs to the actor that its own name
fits best, or else to the actor of its nearest parent or collection whose name fits one. Actors that no name fits are
searched among the remaining objects, by their role's solver, then by size, topology and collection. Every step has a
fixed order.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

from bench.audit.facts import GEOMETRY
from bench.audit.names import NameMatch, match_name
from bench.audit.predicates.predicate import Unit
from bench.audit.roles import UNMARKED, plays

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from bench.audit.facts import Collection, Object, Scene
    from bench.scenes.spec import Spec, SpecActor

Outcome = Literal["resolved", "ambiguous", "missing"]
ResolvedBy = Literal["name", "collection", "hints", ""]
_ACTOR_TYPES = (*GEOMETRY, "EMPTY", "ARMATURE", "LATTICE")
_MOST_NAMED = 12


@dataclass(frozen=True, slots=True)
class ActorResolution:
    """How an actor was found. If it is ambiguous, the units are all candidates."""

    actor: SpecActor
    outcome: Outcome
    units: tuple[Unit, ...] = ()
    by: ResolvedBy = ""
    evidence: dict[str, Any] = field(default_factory=dict[str, Any])

    @property
    def can_be_judged(self) -> bool:
        """Whether it can be judged: it is resolved, or ambiguous with a role that marks its candidates."""
        return self.outcome == "resolved" or (self.outcome == "ambiguous" and self.actor.role not in UNMARKED)


def find_actors(spec: Spec, scene: Scene) -> dict[str, ActorResolution]:
    """Every actor of a spec, in its order."""
    ownership = _Ownership(spec, scene)
    resolutions = {
        actor.name: resolution
        for actor in spec.actors
        if (resolution := ownership.by_name(actor)) is not None
    }
    resolutions = {
        name: _add_domain(resolution, scene, ownership, resolutions)
        for name, resolution in resolutions.items()
    }
    resolutions |= _by_hints(
        [actor for actor in spec.actors if actor.name not in resolutions], scene, ownership, resolutions
    )
    resolutions |= {
        name: _within_domain(resolution, ownership, resolutions)
        for name, resolution in resolutions.items()
        if resolution.outcome == "missing" and resolution.actor.role == "fluid_flow"
    }
    return {actor.name: resolutions[actor.name] for actor in spec.actors}


class _Ownership:
    """Which actor owns each object, as far as names say."""

    def __init__(self, spec: Spec, scene: Scene) -> None:
        self._spec = spec
        self.objects = {obj.name: obj for obj in scene.objects}
        self.collections = {collection.name: collection for collection in scene.collections}
        self.children: dict[str, list[str]] = {}
        for obj in scene.objects:
            if obj.parent is not None:
                self.children.setdefault(obj.parent, []).append(obj.name)
        self.emitters: dict[str, list[str]] = {}
        for obj in scene.objects:
            for name in self._particle_objects(obj):
                self.children.setdefault(obj.name, []).append(name)
                self.emitters.setdefault(name, []).append(obj.name)
        self.subcollections: dict[str, list[str]] = {}
        for collection in scene.collections:
            if collection.parent is not None:
                self.subcollections.setdefault(collection.parent, []).append(collection.name)
        self._object_matches = {
            obj.name: match for obj in scene.objects if (match := self._match_of(obj)) is not None
        }
        self._collection_matches = {
            collection.name: match
            for collection in scene.collections
            if (match := self._best(collection.name)) is not None
        }
        self.owners = {obj.name: owner for obj in scene.objects if (owner := self._owner(obj)) is not None}

    def _best(self, name: str) -> tuple[NameMatch, str] | None:
        """The actor that a name fits best, with how well it fits."""
        best: tuple[NameMatch, str] | None = None
        for actor in self._spec.actors:
            match = match_name(name, (actor.name, *actor.synonyms))
            if match is not None and (best is None or match > best[0]):
                best = match, actor.name
        return best

    def _match_of(self, obj: Object) -> tuple[NameMatch, str] | None:
        """The actor by an object's name; else by the name of what it or its particles instance, or of its data."""
        if not obj.in_scene or obj.type not in _ACTOR_TYPES:
            return None
        names = (obj.name, obj.instances, *self._particle_instances(obj), obj.data)
        return next((match for name in names if name and (match := self._best(name)) is not None), None)

    def _particle_instances(self, obj: Object) -> Iterator[str]:
        """Names of the objects or collections that its particles are shown as."""
        for modifier in obj.of_type("PARTICLE_SYSTEM"):
            if modifier.particles is not None and modifier.particles.instance is not None:
                yield modifier.particles.instance

    def _particle_objects(self, obj: Object) -> Iterator[str]:
        """Names of the objects that its particles are shown as."""
        for name in self._particle_instances(obj):
            collection = self.collections.get(name)
            yield from (
                collection.objects if collection is not None and name not in self.objects else (name,)
            )

    def _owner(self, obj: Object) -> str | None:
        seen = set[str]()
        here: Object | None = obj
        while here is not None and here.name not in seen:
            seen.add(here.name)
            match = self._object_matches.get(here.name)
            if match is not None and match[0].quality > 1:
                return match[1]
            owner = self._owner_by_collection(here)
            if owner is not None:
                return owner
            if match is not None:
                return match[1]
            here = self.objects.get(here.parent) if here.parent is not None else None
        return None

    def _owner_by_collection(self, obj: Object) -> str | None:
        for name in obj.collections:
            seen = set[str]()
            here: str | None = name
            while here is not None and here not in seen:
                seen.add(here)
                if here in self._collection_matches:
                    return self._collection_matches[here][1]
                collection = self.collections.get(here)
                here = collection.parent if collection is not None else None
        return None

    # Units

    def by_name(self, actor: SpecActor) -> ActorResolution | None:
        """The resolution of an actor by names; None if no name fits it."""
        units, by = self._enough_units(actor)
        if not units:
            return None
        sorted_units = tuple(
            Unit(tuple(self._main_first(names, actor)), actor.role)
            for names in sorted(units, key=lambda names: names[0])
        )
        evidence = {
            "objects": [unit.name for unit in sorted_units][:_MOST_NAMED],
            "found": len(sorted_units),
            "wanted": actor.count,
        }
        return ActorResolution(actor, "resolved", sorted_units, by, evidence)

    def _enough_units(self, actor: SpecActor) -> tuple[list[tuple[str, ...]], ResolvedBy]:
        """The units of the collections that fit best, if those are enough; else of all that fit."""
        groups = {
            name: match[0] for name, match in self._collection_matches.items() if match[1] == actor.name
        }
        best = max((match.quality for match in groups.values()), default=0)
        leading = [name for name, match in groups.items() if match.quality == best]
        found: tuple[list[tuple[str, ...]], ResolvedBy] = ([], "")
        for chosen in (leading, list(groups)):
            units, by = self._units(actor, chosen)
            while units and len(units) < actor.count and (finer := self._split(units, actor.name)) != units:
                units = finer
            found = (units, by)
            if len(units) >= actor.count:
                break
        return found

    def _units(self, actor: SpecActor, groups: list[str]) -> tuple[list[tuple[str, ...]], ResolvedBy]:
        """Names of the objects of each unit, coarsest first; ``groups`` are collections that fit."""
        own = [
            name for name, owner in self.owners.items() if owner == actor.name and self.objects[name].in_scene
        ]
        units = [
            members for name in groups if (members := self._members(self._topmost(groups, name), actor.name))
        ]
        units = list(dict.fromkeys(units))
        taken = {name for members in units for name in members}
        rest = [name for name in own if name not in taken and name in self._object_matches]
        tops = [name for name in rest if not any(above in rest for above in self._above(name))]
        best = max((self._object_matches[name][0].quality for name in tops), default=0)
        if units:
            # Beside a collection of that name, only an object of exactly that name counts.
            tops = [name for name in tops if self._object_matches[name][0].quality == 3]
            trees = [self._tree(name, actor.name) for name in tops]
            if actor.count == 1:  # a cannon, and the charge in it that has one of its names
                return [_joined([*units, *trees])], "collection"
            return units + trees, "collection"
        leading = [name for name in tops if self._object_matches[name][0].quality == best]
        trees = [self._tree(name, actor.name) for name in leading]
        parts = [part for name in tops if name not in leading for part in self._tree(name, actor.name)]
        if best < 3 and actor.count == 1 and trees:
            trees = [_joined(trees)]
        if len(trees) == 1 and parts:
            trees = [_joined([trees[0], parts])]
        return trees, "name"

    def _topmost(self, groups: list[str], name: str) -> str:
        """The highest of the given collections above one; or itself."""
        top, seen = name, {name}
        here = self.collections[name].parent
        while here is not None and here not in seen and here in self.collections:
            seen.add(here)
            if here in groups:
                top = here
            here = self.collections[here].parent
        return top

    def _members(self, collection: str, owner: str) -> tuple[str, ...]:
        """The scene's objects in a collection and below it that are the owner's, each followed by its descendants."""
        members: dict[str, None] = {}
        waiting, seen = [collection], set[str]()
        while waiting:
            name = waiting.pop(0)
            if name in seen:
                continue
            seen.add(name)
            for member in self.collections[name].objects:
                if self.owners.get(member) == owner and self.objects[member].in_scene:
                    members.update(dict.fromkeys(self._tree(member, owner)))
            waiting += self.subcollections.get(name, [])
        return tuple(members)

    def _tree(self, name: str, owner: str | None) -> tuple[str, ...]:
        """An object, its descendants and what it instances, unless another actor owns them."""
        members: dict[str, None] = {}
        waiting = [name]
        while waiting:
            here = waiting.pop(0)
            if (
                here in members
                or here not in self.objects
                or (self.owners.get(here, owner) != owner and here != name)
            ):
                continue
            members[here] = None
            instanced = self.collections.get(self.objects[here].instances or "")
            waiting += [*self.children.get(here, []), *(instanced.objects if instanced is not None else ())]
        return tuple(members)

    def _split(self, units: list[tuple[str, ...]], owner: str) -> list[tuple[str, ...]]:
        """Units split by one level: a collection into its members, a parent into its children."""
        parts: list[tuple[str, ...]] = []
        for unit in units:
            tops = [
                name for name in unit if self.objects[name].parent not in unit and self.objects[name].in_scene
            ]
            if len(tops) == 1 and self.objects[tops[0]].type not in GEOMETRY:
                tops = [name for name in self.children.get(tops[0], []) if name in unit] or tops
            parts += [self._tree(name, owner) for name in tops] if len(tops) > 1 else [unit]
        return parts

    def _main_first(self, names: Iterable[str], actor: SpecActor) -> list[Object]:
        """A unit's objects: first those with the role, then by how well their name fits, else in their order."""
        objects = [self.objects[name] for name in names]
        nothing = NameMatch(0, 0, 0)

        def rank(obj: Object) -> tuple[bool, int, bool]:
            match = self._object_matches.get(obj.name, (nothing, ""))
            return not plays(obj, actor.role), -match[0].quality, obj.type not in GEOMETRY

        return sorted(objects, key=rank)

    def _above(self, name: str) -> Iterator[str]:
        """Its parents and emitters, and theirs."""
        seen, waiting = {name}, [name]
        while waiting:
            here = waiting.pop(0)
            parent = self.objects[here].parent
            for above in (*((parent,) if parent is not None else ()), *self.emitters.get(here, ())):
                if above not in seen and above in self.objects:
                    seen.add(above)
                    waiting.append(above)
                    yield above

    def tree(self, name: str) -> tuple[Object, ...]:
        """An object without an owner, with its descendants."""
        return tuple(self.objects[member] for member in self._tree(name, None))


def _joined(parts: Iterable[Iterable[str]]) -> tuple[str, ...]:
    """The names of all parts, each once."""
    return tuple(dict.fromkeys(name for part in parts for name in part))


# Hints


def _add_domain(
    resolution: ActorResolution,
    scene: Scene,
    ownership: _Ownership,
    resolutions: Mapping[str, ActorResolution],
) -> ActorResolution:
    """Adds the domain to a fluid: domains are often named after their box, while other objects have the fluid's name.

    If no object of the actor is a domain, and the scene has exactly one domain without an owner, it is the actor's.
    """
    role = resolution.actor.role
    if role != "fluid_domain" or any(plays(obj, role) for unit in resolution.units for obj in unit.objects):
        return resolution
    taken = {name for other in resolutions.values() for unit in other.units for name in unit.names}
    free = [obj for obj in scene.objects if plays(obj, role) and obj.name not in taken]
    if len(free) != 1:
        return resolution
    first, *rest = resolution.units
    joined = Unit((*ownership.tree(free[0].name), *first.objects), role)
    return replace(
        resolution, units=(joined, *rest), evidence={**resolution.evidence, "domain": free[0].name}
    )


def _within_domain(
    resolution: ActorResolution, ownership: _Ownership, resolutions: Mapping[str, ActorResolution]
) -> ActorResolution:
    """Finds flows among the parts of a fluid: many builders put a domain and its flows into one collection."""
    actor = resolution.actor
    parts = [
        obj
        for other in resolutions.values()
        if other.actor.role == "fluid_domain" and other.outcome == "resolved"
        for unit in other.units
        for obj in unit.objects
        if plays(obj, actor.role)
    ]
    return _by_hint(actor, parts, ownership, "resolved") if 0 < len(parts) <= actor.count else resolution


def _by_hints(
    actors: list[SpecActor], scene: Scene, ownership: _Ownership, resolutions: Mapping[str, ActorResolution]
) -> dict[str, ActorResolution]:
    """Resolves actors that no name fits: first those with one possibility, then the others with what is left."""
    taken = {name for resolution in resolutions.values() for unit in resolution.units for name in unit.names}
    result: dict[str, ActorResolution] = {}
    waiting = list(actors)
    while waiting:
        options = {actor.name: _candidates(actor, scene, taken) for actor in waiting}
        unique = next((actor for actor in waiting if 0 < len(options[actor.name]) <= actor.count), None)
        if unique is None:
            break
        waiting.remove(unique)
        result[unique.name] = _by_hint(unique, options[unique.name], ownership, "resolved")
        taken |= {name for unit in result[unique.name].units for name in unit.names}
    for actor in waiting:
        options = {actor.name: _candidates(actor, scene, taken)}
        candidates = options[actor.name]
        is_group = actor.count > 1 and actor.role not in UNMARKED
        if candidates:
            result[actor.name] = _by_hint(
                actor, candidates, ownership, "resolved" if is_group else "ambiguous"
            )
        else:
            result[actor.name] = ActorResolution(actor, "missing", evidence={"hints": _hints_json(actor)})
    return result


def _by_hint(
    actor: SpecActor, objects: list[Object], ownership: _Ownership, outcome: Outcome
) -> ActorResolution:
    units = tuple(Unit(ownership.tree(obj.name), actor.role) for obj in objects)
    evidence: dict[str, Any] = {
        "objects": [obj.name for obj in objects][:_MOST_NAMED],
        "found": len(objects),
        "wanted": actor.count,
        "hints": _hints_json(actor),
        "diagonals": [round(obj.diagonal, 3) for obj in objects][:_MOST_NAMED],
    }
    return ActorResolution(actor, outcome, units, "hints", evidence)


def _hints_json(actor: SpecActor) -> dict[str, Any]:
    hints = actor.hints
    return {
        "role": actor.role,
        "size": list(hints.size) if hints.size else None,
        "topology": hints.topology,
    }


def _candidates(actor: SpecActor, scene: Scene, taken: set[str]) -> list[Object]:
    """The objects without an owner that fit the hints best; for an unmarked role, only those of its size."""
    free = [
        obj for obj in scene.objects if obj.in_scene and obj.name not in taken and obj.type in _ACTOR_TYPES
    ]
    if actor.role in UNMARKED:
        if actor.hints.size is None:
            return []
        fit = [obj for obj in free if _size_fits(obj, actor) and _topology_fits(obj, actor) and obj.renders]
        return [obj for obj in fit if obj.parent is None or obj.parent not in {other.name for other in fit}]
    players = [obj for obj in free if plays(obj, actor.role)]
    if actor.count > 1:
        return [obj for obj in players if _size_fits(obj, actor)] or players
    objects = _in_object_collections(scene)
    ranks = [
        (_size_fits(obj, actor), _topology_fits(obj, actor), not objects or obj.name in objects)
        for obj in players
    ]
    best = max((sum(rank) for rank in ranks), default=0)
    return [obj for obj, rank in zip(players, ranks, strict=True) if sum(rank) == best]


def _size_fits(obj: Object, actor: SpecActor) -> bool:
    size = actor.hints.size
    return size is None or size[0] <= obj.diagonal <= size[1]


def _topology_fits(obj: Object, actor: SpecActor) -> bool:
    return actor.hints.topology in ("any", obj.topology)


def _in_object_collections(scene: Scene) -> frozenset[str]:
    """Names of the objects in collections that a custom property marks as one object's."""
    marked: list[Collection] = [
        collection
        for collection in scene.collections
        if any(value.casefold() == "object" for value in collection.properties.values())
    ]
    return frozenset(name for collection in marked for name in collection.objects)
