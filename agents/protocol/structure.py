"""The protocol's own view of the facts: systems (L2), objects (L3), and whose a mesh is."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from agents.protocol.vocabulary import GROUND

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.facts import Box, CacheFacts, CollectionFacts, Facts, ObjectFacts

SCENE = ""  # how a collection names the scene's own as its parent
# Modifiers, and constraints, that move what they are on by themselves.
_MOVERS = frozenset(
    {
        "CLOTH", "SOFT_BODY", "FLUID_DOMAIN", "FLUID_FLOW", "PARTICLE_SYSTEM", "DYNAMIC_PAINT", "ARMATURE",
        "MESH_CACHE", "MESH_SEQUENCE_CACHE",
    }
)  # fmt: skip
_GEOMETRY = frozenset({"MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES", "POINTCLOUD", "VOLUME"})
_MOVING = frozenset({"FOLLOW_PATH", "TRANSFORM_CACHE", "FOLLOW_TRACK"})


@dataclass(frozen=True, slots=True)
class Thing:
    """A logical object: an L3 collection, the meshes in it, its root Empties."""

    collection: CollectionFacts
    meshes: tuple[ObjectFacts, ...]
    roots: tuple[ObjectFacts, ...]
    others: tuple[ObjectFacts, ...]

    @property
    def name(self) -> str:
        """The collection's name."""
        return self.collection.name

    @property
    def surfaces(self) -> tuple[str, ...]:
        """Names of its meshes that have a surface and are rendered; of all with a surface if none is."""
        shown = tuple(one.name for one in self.meshes if one.surface and one.rendered)
        return shown or tuple(one.name for one in self.meshes if one.surface)

    @property
    def box(self) -> Box | None:
        """Around all its evaluated geometry that has a surface."""
        wanted = set(self.surfaces)
        boxes = [one.box for one in self.meshes if one.box and one.name in wanted]
        if not boxes:
            return None
        whole = boxes[0]
        for box in boxes[1:]:
            whole = whole.joined(box)
        return whole


class Structure:
    """Answers about a scene's facts that several rules need."""

    def __init__(self, facts: Facts) -> None:
        self.facts = facts
        self.objects = {one.name: one for one in facts.objects}
        self.collections = {one.name: one for one in facts.collections}

    @cached_property
    def systems(self) -> tuple[CollectionFacts, ...]:
        """L2 collections."""
        return tuple(one for one in self.facts.collections if one.role == "system")

    @cached_property
    def things(self) -> tuple[Thing, ...]:
        """L3 collections, with what is in them and in the untagged collections below them."""
        return tuple(self._thing(one) for one in self.facts.collections if one.role == "object")

    @cached_property
    def by_name(self) -> dict[str, Thing]:
        """L3 by the collection's name."""
        return {thing.name: thing for thing in self.things}

    @cached_property
    def owners(self) -> dict[str, tuple[Thing, ...]]:
        """Object → the L3s that it is in."""
        found: dict[str, list[Thing]] = defaultdict(list)
        for thing in self.things:
            for one in (*thing.meshes, *thing.roots, *thing.others):
                found[one.name].append(thing)
        return {name: tuple(things) for name, things in found.items()}

    @cached_property
    def grounds(self) -> frozenset[str]:
        """Names of the L3s that belong to the system ``ground``."""
        return frozenset(thing.name for thing in self.things if GROUND in self.systems_of(thing.collection))

    @cached_property
    def meshes(self) -> tuple[ObjectFacts, ...]:
        """Everything with geometry of its own, tagged or not."""
        return tuple(one for one in self.facts.objects if is_mesh(one))

    def systems_of(self, collection: CollectionFacts) -> frozenset[str]:
        """Names of the L2 collections above a collection."""
        found: set[str] = set()
        seen: set[str] = set()
        waiting = list(collection.parents)
        while waiting:
            name = waiting.pop()
            above = self.collections.get(name)
            if above is None or name in seen:
                continue
            seen.add(name)
            if above.role == "system":
                found.add(name)
            waiting += above.parents
        return frozenset(found)

    def parents_of(self, name: str) -> Iterator[str]:
        """The chain of parents above an object, nearest first; it ends where a parent comes again."""
        seen = {name}
        one = self.objects.get(name)
        while one is not None and one.parent is not None and one.parent not in seen:
            yield one.parent
            seen.add(one.parent)
            one = self.objects.get(one.parent)

    def find(self, node: str) -> tuple[str, ...]:
        """The surfaces that a name stands for: an L3's, a root's, ``Object/Part``'s or one mesh's; () for nobody's."""
        owner, _, part = node.partition("/")
        if part:
            thing = self.by_name.get(owner)
            return (
                tuple(one.name for one in thing.meshes if one.surface and one.name == part) if thing else ()
            )
        if node in self.by_name:
            return self.by_name[node].surfaces
        one = self.objects.get(node)
        if one is None:
            return ()
        if one.is_root:
            return tuple(name for thing in self.owners.get(node, ()) for name in thing.surfaces)
        return (node,) if one.surface else ()

    def thing_of(self, node: str) -> Thing | None:
        """The L3 that a node belongs to: by its own name, a part's, a mesh's or a root's."""
        owner = node.partition("/")[0]
        if owner in self.by_name:
            return self.by_name[owner]
        things = self.owners.get(owner, ())
        return things[0] if len(things) == 1 else None

    def caches_of(self, thing: Thing) -> tuple[CacheFacts, ...]:
        """The caches of an L3's objects."""
        names = {one.name for one in (*thing.meshes, *thing.others, *thing.roots)}
        return tuple(cache for cache in self.facts.caches if cache.object in names)

    def moves(self, name: str) -> bool:
        """Whether something may move or deform an object: physics, keys, drivers, or something that it follows."""
        return any(_moves(one) for one in self.followed(name))

    def followed(self, name: str) -> Iterator[ObjectFacts]:
        """An object and all that it may follow: parents, targets of constraints and modifiers, over any steps."""
        waiting, seen = [name], set[str]()
        while waiting:
            one = self.objects.get(waiting.pop())
            if one is None or one.name in seen:
                continue
            seen.add(one.name)
            yield one
            links = [link.target for link in (*one.constraints, *one.modifiers) if link.on and link.target]
            waiting += [*links, *((one.parent,) if one.parent else ())]

    @cached_property
    def _below(self) -> dict[str, list[CollectionFacts]]:
        """Collection → those in it."""
        found: dict[str, list[CollectionFacts]] = defaultdict(list)
        for one in self.facts.collections:
            for above in one.parents:
                found[above].append(one)
        return found

    def _thing(self, collection: CollectionFacts) -> Thing:
        names: dict[str, None] = {}
        waiting, seen = [collection], {collection.name}
        while waiting:
            one = waiting.pop(0)
            names.update(dict.fromkeys(one.objects))
            for below in self._below.get(one.name, ()):
                if below.role is None and below.name not in seen:
                    seen.add(below.name)
                    waiting.append(below)
        inside = [self.objects[name] for name in names if name in self.objects]
        return Thing(
            collection,
            tuple(one for one in inside if is_mesh(one)),
            tuple(one for one in inside if one.is_root),
            tuple(one for one in inside if not is_mesh(one) and not one.is_root),
        )


def is_mesh(one: ObjectFacts) -> bool:
    """Whether there is geometry of an object's own: a mesh, what is drawn as one, and what makes instances of one."""
    return one.surface or one.type in _GEOMETRY


def is_animated(one: ObjectFacts) -> bool:
    """Whether keyframes, drivers, shape keys or something recorded move it by itself."""
    return bool(
        one.keys
        or one.drivers
        or one.animated_shape_keys
        or any(constraint.on and constraint.type in _MOVING for constraint in one.constraints)
    )


def _moves(one: ObjectFacts) -> bool:
    body = one.rigid_body
    return (
        is_animated(one)
        or (body is not None and body.active and body.enabled)
        or any(modifier.type in _MOVERS and modifier.on for modifier in one.modifiers)
    )
