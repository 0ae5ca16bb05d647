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
from bench.audit.names import Match, match
from bench.audit.predicates.predicate import Unit
from bench.audit.roles import UNMARKED, plays

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from bench.audit.facts import Collection, Object, Scene
    from bench.scenes.spec import Actor, Spec

Outcome = Literal["resolved", "ambiguous", "missing"]
By = Literal["name", "collection", "hints", ""]
_BODIES = (*GEOMETRY, "EMPTY", "ARMATURE", "LATTICE")
_SHOWN = 12


@dataclass(frozen=True, slots=True)
class Found:
    """How an actor was found. If it is ambiguous, the units are all candidates."""

    actor: Actor
    outcome: Outcome
    units: tuple[Unit, ...] = ()
    by: By = ""
    evidence: dict[str, Any] = field(default_factory=dict[str, Any])

    @property
    def told_apart(self) -> bool:
        """Whether it can be judged: it is resolved, or ambiguous with a role that marks its candidates."""
        return self.outcome == "resolved" or (self.outcome == "ambiguous" and self.actor.role not in UNMARKED)


def find_actors(spec: Spec, scene: Scene) -> dict[str, Found]:
    """Every actor of a spec, in its order."""
    cast = _Cast(spec, scene)
    found = {actor.name: one for actor in spec.actors if (one := cast.by_name(actor)) is not None}
    found = {name: _with_domain(one, scene, cast, found) for name, one in found.items()}
    found |= _by_hints([actor for actor in spec.actors if actor.name not in found], scene, cast, found)
    return {actor.name: found[actor.name] for actor in spec.actors}


class _Cast:
    """Which actor owns each object, as far as names say."""

    def __init__(self, spec: Spec, scene: Scene) -> None:
        self._spec = spec
        self.objects = {one.name: one for one in scene.objects}
        self.collections = {one.name: one for one in scene.collections}
        self.children: dict[str, list[str]] = {}
        for one in scene.objects:
            if one.parent is not None:
                self.children.setdefault(one.parent, []).append(one.name)
        self.emitters: dict[str, list[str]] = {}
        for one in scene.objects:
            for shown in self._shown_by_particles(one):
                self.children.setdefault(one.name, []).append(shown)
                self.emitters.setdefault(shown, []).append(one.name)
        self.below: dict[str, list[str]] = {}
        for each in scene.collections:
            if each.parent is not None:
                self.below.setdefault(each.parent, []).append(each.name)
        self._objects_said = {
            one.name: said for one in scene.objects if (said := self._said_of(one)) is not None
        }
        self._collections_said = {
            each.name: said for each in scene.collections if (said := self._best(each.name)) is not None
        }
        self.owners = {one.name: owner for one in scene.objects if (owner := self._owner(one)) is not None}

    def _best(self, name: str) -> tuple[Match, str] | None:
        """The actor that a name fits best, with how well it fits."""
        best: tuple[Match, str] | None = None
        for actor in self._spec.actors:
            found = match(name, (actor.name, *actor.synonyms))
            if found is not None and (best is None or found > best[0]):
                best = found, actor.name
        return best

    def _said_of(self, one: Object) -> tuple[Match, str] | None:
        """The actor by an object's name; else by the name of what it or its particles instance, or of its data."""
        if not one.in_scene or one.type not in _BODIES:
            return None
        names = (one.name, one.instances, *self._named_by_particles(one), one.data)
        return next((said for name in names if name and (said := self._best(name)) is not None), None)

    def _named_by_particles(self, one: Object) -> Iterator[str]:
        """Names of the objects or collections that its particles are shown as."""
        for modifier in one.of_type("PARTICLE_SYSTEM"):
            if modifier.particles is not None and modifier.particles.instance is not None:
                yield modifier.particles.instance

    def _shown_by_particles(self, one: Object) -> Iterator[str]:
        """Names of the objects that its particles are shown as."""
        for name in self._named_by_particles(one):
            each = self.collections.get(name)
            yield from (each.objects if each is not None and name not in self.objects else (name,))

    def _owner(self, one: Object) -> str | None:
        seen = set[str]()
        here: Object | None = one
        while here is not None and here.name not in seen:
            seen.add(here.name)
            said = self._objects_said.get(here.name)
            if said is not None and said[0].quality > 1:
                return said[1]
            owner = self._owner_by_collection(here)
            if owner is not None:
                return owner
            if said is not None:
                return said[1]
            here = self.objects.get(here.parent) if here.parent is not None else None
        return None

    def _owner_by_collection(self, one: Object) -> str | None:
        for name in one.collections:
            seen = set[str]()
            here: str | None = name
            while here is not None and here not in seen:
                seen.add(here)
                if here in self._collections_said:
                    return self._collections_said[here][1]
                each = self.collections.get(here)
                here = each.parent if each is not None else None
        return None

    # Units

    def by_name(self, actor: Actor) -> Found | None:
        """The resolution of an actor by names; None if no name fits it."""
        units, by = self._units(actor)
        if not units:
            return None
        while len(units) < actor.count and (finer := self._split(units, actor.name)) != units:
            units = finer
        told = tuple(
            Unit(tuple(self._first(names, actor)), actor.role)
            for names in sorted(units, key=lambda one: one[0])
        )
        evidence = {
            "objects": [unit.name for unit in told][:_SHOWN],
            "found": len(told),
            "wanted": actor.count,
        }
        return Found(actor, "resolved", told, by, evidence)

    def _units(self, actor: Actor) -> tuple[list[tuple[str, ...]], By]:
        """Names of the objects of each unit, coarsest first."""
        own = [
            name for name, owner in self.owners.items() if owner == actor.name and self.objects[name].in_scene
        ]
        groups = [name for name, said in self._collections_said.items() if said[1] == actor.name]
        units = [
            members for name in groups if (members := self._members(self._topmost(groups, name), actor.name))
        ]
        units = list(dict.fromkeys(units))
        taken = {name for members in units for name in members}
        rest = [name for name in own if name not in taken and name in self._objects_said]
        tops = [name for name in rest if not any(above in rest for above in self._above(name))]
        best = max((self._objects_said[name][0].quality for name in tops), default=0)
        if units:
            # Beside a collection of that name, only an object of exactly that name is a unit of its own.
            tops = [name for name in tops if self._objects_said[name][0].quality == 3]
            return units + [self._tree(name, actor.name) for name in tops], "collection"
        leading = [name for name in tops if self._objects_said[name][0].quality == best]
        trees = [self._tree(name, actor.name) for name in leading]
        parts = [each for name in tops if name not in leading for each in self._tree(name, actor.name)]
        if best < 3 and actor.count == 1 and trees:
            trees = [tuple(dict.fromkeys(each for tree in trees for each in tree))]
        if len(trees) == 1 and parts:
            trees = [tuple(dict.fromkeys((*trees[0], *parts)))]
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
        found: dict[str, None] = {}
        waiting, seen = [collection], set[str]()
        while waiting:
            name = waiting.pop(0)
            if name in seen:
                continue
            seen.add(name)
            for member in self.collections[name].objects:
                if self.owners.get(member) == owner and self.objects[member].in_scene:
                    found.update(dict.fromkeys(self._tree(member, owner)))
            waiting += self.below.get(name, [])
        return tuple(found)

    def _tree(self, name: str, owner: str | None) -> tuple[str, ...]:
        """An object, its descendants and what it instances, unless another actor owns them."""
        found: dict[str, None] = {}
        waiting = [name]
        while waiting:
            here = waiting.pop(0)
            if (
                here in found
                or here not in self.objects
                or (self.owners.get(here, owner) != owner and here != name)
            ):
                continue
            found[here] = None
            shown = self.collections.get(self.objects[here].instances or "")
            waiting += [*self.children.get(here, []), *(shown.objects if shown is not None else ())]
        return tuple(found)

    def _split(self, units: list[tuple[str, ...]], owner: str) -> list[tuple[str, ...]]:
        """Units split by one level: a collection into its members, a parent into its children."""
        found: list[tuple[str, ...]] = []
        for unit in units:
            tops = [
                name for name in unit if self.objects[name].parent not in unit and self.objects[name].in_scene
            ]
            if len(tops) == 1 and self.objects[tops[0]].type not in GEOMETRY:
                tops = [name for name in self.children.get(tops[0], []) if name in unit] or tops
            found += [self._tree(name, owner) for name in tops] if len(tops) > 1 else [unit]
        return found

    def _first(self, names: Iterable[str], actor: Actor) -> list[Object]:
        """A unit's objects: first those with the role, then by how well their name fits, else in their order."""
        objects = [self.objects[name] for name in names]
        nothing = Match(0, 0, 0)

        def rank(one: Object) -> tuple[bool, int, bool]:
            said = self._objects_said.get(one.name, (nothing, ""))
            return not plays(one, actor.role), -said[0].quality, one.type not in GEOMETRY

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
        return tuple(self.objects[each] for each in self._tree(name, None))


# Hints


def _with_domain(one: Found, scene: Scene, cast: _Cast, found: Mapping[str, Found]) -> Found:
    """Adds the domain to a fluid: domains are often named after their box, while other objects have the fluid's name.

    If no object of the actor is a domain, and the scene has exactly one domain without an owner, it is the actor's.
    """
    role = one.actor.role
    if role != "fluid_domain" or any(plays(each, role) for unit in one.units for each in unit.objects):
        return one
    taken = {name for other in found.values() for unit in other.units for name in unit.names}
    free = [each for each in scene.objects if plays(each, role) and each.name not in taken]
    if len(free) != 1:
        return one
    first, *rest = one.units
    joined = Unit((*cast.tree(free[0].name), *first.objects), role)
    return replace(one, units=(joined, *rest), evidence={**one.evidence, "domain": free[0].name})


def _by_hints(actors: list[Actor], scene: Scene, cast: _Cast, found: Mapping[str, Found]) -> dict[str, Found]:
    """Resolves actors that no name fits: first those with one possibility, then the others with what is left."""
    taken = {name for one in found.values() for unit in one.units for name in unit.names}
    result: dict[str, Found] = {}
    waiting = list(actors)
    while waiting:
        options = {actor.name: _candidates(actor, scene, taken) for actor in waiting}
        chosen = next((actor for actor in waiting if 0 < len(options[actor.name]) <= actor.count), None)
        if chosen is None:
            break
        waiting.remove(chosen)
        result[chosen.name] = _hinted(chosen, options[chosen.name], cast, "resolved")
        taken |= {name for unit in result[chosen.name].units for name in unit.names}
    for actor in waiting:
        options = {actor.name: _candidates(actor, scene, taken)}
        several = options[actor.name]
        enough = actor.count > 1 and actor.role not in UNMARKED
        if several:
            result[actor.name] = _hinted(actor, several, cast, "resolved" if enough else "ambiguous")
        else:
            result[actor.name] = Found(actor, "missing", evidence={"hints": _wanted(actor)})
    return result


def _hinted(actor: Actor, objects: list[Object], cast: _Cast, outcome: Outcome) -> Found:
    units = tuple(Unit(cast.tree(one.name), actor.role) for one in objects)
    evidence: dict[str, Any] = {
        "objects": [one.name for one in objects][:_SHOWN],
        "found": len(objects),
        "wanted": actor.count,
        "hints": _wanted(actor),
        "diagonals": [round(one.diagonal, 3) for one in objects][:_SHOWN],
    }
    return Found(actor, outcome, units, "hints", evidence)


def _wanted(actor: Actor) -> dict[str, Any]:
    hints = actor.hints
    return {
        "role": actor.role,
        "size": list(hints.size) if hints.size else None,
        "topology": hints.topology,
    }


def _candidates(actor: Actor, scene: Scene, taken: set[str]) -> list[Object]:
    """The objects without an owner that fit the hints best; for an unmarked role, only those of its size."""
    free = [one for one in scene.objects if one.in_scene and one.name not in taken and one.type in _BODIES]
    if actor.role in UNMARKED:
        if actor.hints.size is None:
            return []
        fit = [one for one in free if _size_fits(one, actor) and _topology_fits(one, actor) and one.renders]
        return [one for one in fit if one.parent is None or one.parent not in {other.name for other in fit}]
    players = [one for one in free if plays(one, actor.role)]
    if actor.count > 1:
        return [one for one in players if _size_fits(one, actor)] or players
    objects = _of_object_collections(scene)
    ranks = [
        (_size_fits(one, actor), _topology_fits(one, actor), not objects or one.name in objects)
        for one in players
    ]
    best = max((sum(rank) for rank in ranks), default=0)
    return [one for one, rank in zip(players, ranks, strict=True) if sum(rank) == best]


def _size_fits(one: Object, actor: Actor) -> bool:
    size = actor.hints.size
    return size is None or size[0] <= one.diagonal <= size[1]


def _topology_fits(one: Object, actor: Actor) -> bool:
    return actor.hints.topology in ("any", one.topology)


def _of_object_collections(scene: Scene) -> frozenset[str]:
    """Names of the objects in collections that a custom property marks as one object's."""
    marked: list[Collection] = [
        each
        for each in scene.collections
        if any(value.casefold() == "object" for value in each.properties.values())
    ]
    return frozenset(name for each in marked for name in each.objects)
