"""The scene's facts in the protocol's terms: systems (L2), logical objects (L3), and the owners of meshes."""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from agents.plan.graph import reachable
from agents.protocol.vocabulary import GROUND

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.facts import CollectionFacts, ObjectFacts, SceneFacts

SCENE = ""  # the name of the scene's own collection, where it is a parent
_MOVING_MODIFIERS = frozenset(
    {
        "CLOTH", "SOFT_BODY", "FLUID_DOMAIN", "PARTICLE_SYSTEM", "DYNAMIC_PAINT", "ARMATURE", "MESH_CACHE",
        "MESH_SEQUENCE_CACHE",
    }
)  # fmt: skip
_MOVING_CONSTRAINTS = frozenset({"FOLLOW_PATH", "TRANSFORM_CACHE", "FOLLOW_TRACK"})
NUMBER = re.compile(r"\.\d{3,}$")  # that Blender puts behind a name that is taken
_GEOMETRY = frozenset({"MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES", "POINTCLOUD", "VOLUME"})


@dataclass(frozen=True, slots=True)
class LogicalObject:
    """An L3 collection with its meshes, its root Empties, and the other objects in it."""

    collection: CollectionFacts
    meshes: tuple[ObjectFacts, ...]
    roots: tuple[ObjectFacts, ...]
    others: tuple[ObjectFacts, ...]

    @property
    def name(self) -> str:
        """The collection's name."""
        return self.collection.name

    @property
    def members(self) -> tuple[ObjectFacts, ...]:
        """All objects in it."""
        return (*self.meshes, *self.others, *self.roots)

    @property
    def surfaces(self) -> tuple[str, ...]:
        """Names of its meshes with a surface that renders show; of all with a surface if renders show none.

        The box of a fluid's domain is none: a fluid that is not there yet, or has no surface, is where its flows are.
        Nor is what its own particles are copies of, where it has another mesh.
        """
        copied = {name for mesh in self.meshes for modifier in mesh.modifiers for name in modifier.copies}
        all_bodies = [mesh for mesh in self.meshes if mesh.surface and not mesh.is_only_a_box]
        bodies = [mesh for mesh in all_bodies if mesh.name not in copied] or all_bodies
        rendered = tuple(mesh.name for mesh in bodies if mesh.rendered)
        return rendered or tuple(mesh.name for mesh in bodies)


class SceneStructure:
    """Look-ups in a scene's facts that several rules need."""

    def __init__(self, facts: SceneFacts) -> None:
        self.facts = facts
        self.objects = {item.name: item for item in facts.objects}
        self.collections = {collection.name: collection for collection in facts.collections}

    @cached_property
    def systems(self) -> tuple[CollectionFacts, ...]:
        """L2 collections."""
        return tuple(collection for collection in self.facts.collections if collection.role == "system")

    @cached_property
    def logical_objects(self) -> tuple[LogicalObject, ...]:
        """L3 collections, with the objects in them and in the untagged collections below them."""
        return tuple(
            self._logical_object(collection)
            for collection in self.facts.collections
            if collection.role == "object"
        )

    @cached_property
    def by_name(self) -> dict[str, LogicalObject]:
        """Logical objects by the name of their collection."""
        return {obj.name: obj for obj in self.logical_objects}

    @cached_property
    def owners(self) -> dict[str, tuple[LogicalObject, ...]]:
        """Name of a Blender object → the logical objects that it is in."""
        owners: dict[str, list[LogicalObject]] = defaultdict(list)
        for obj in self.logical_objects:
            for item in obj.members:
                owners[item.name].append(obj)
        return {name: tuple(objects) for name, objects in owners.items()}

    @cached_property
    def grounds(self) -> frozenset[str]:
        """Names of the logical objects in the system ``ground``."""
        return frozenset(
            obj.name for obj in self.logical_objects if GROUND in self.systems_of(obj.collection)
        )

    @cached_property
    def meshes(self) -> tuple[ObjectFacts, ...]:
        """All objects with geometry of their own, tagged or not."""
        return tuple(item for item in self.facts.objects if is_mesh(item))

    def systems_of(self, collection: CollectionFacts) -> frozenset[str]:
        """Names of the L2 collections above a collection."""
        above = reachable(
            collection.parents,
            lambda name: self.collections[name].parents if name in self.collections else (),
        )
        return frozenset(system.name for system in self.systems if system.name in above)

    def parents_of(self, name: str) -> Iterator[str]:
        """The chain of parents above an object, nearest first; it ends where a parent repeats."""
        seen = {name}
        item = self.objects.get(name)
        while item is not None and item.parent is not None and item.parent not in seen:
            yield item.parent
            seen.add(item.parent)
            item = self.objects.get(item.parent)

    def surfaces_of(self, node: str) -> tuple[str, ...]:
        """The meshes with a surface that a name stands for: an L3's, a root's, ``Object/Part``'s or one mesh's.

        A part's mesh need not have the part's very name, which is another object's in many a scene: ``Object_Part`` and
        ``Part.001`` are taken for it.
        """
        owner, _, part = node.partition("/")
        if part:
            meshes = self.by_name[owner].meshes if owner in self.by_name else ()
            bodies = tuple(mesh.name for mesh in meshes if mesh.surface)
            return (
                (part,) if part in bodies else tuple(name for name in bodies if _is_part(name, owner, part))
            )
        if node in self.by_name:
            return self.by_name[node].surfaces
        item = self.objects.get(node)
        if item is None:
            return ()
        if item.is_root:
            return tuple(name for obj in self.owners.get(node, ()) for name in obj.surfaces)
        if item.is_only_a_box:
            return tuple(name for obj in self.owners.get(node, ()) for name in obj.surfaces)
        return (node,) if item.surface else ()

    def logical_object_of(self, node: str) -> LogicalObject | None:
        """The logical object that a name belongs to: its own, a part's, a mesh's or a root's."""
        owner = node.partition("/")[0]
        if owner in self.by_name:
            return self.by_name[owner]
        owners = self.owners.get(owner, ())
        return owners[0] if len(owners) == 1 else None

    def can_move(self, name: str) -> bool:
        """Whether physics, keys, drivers, or anything that it follows may move or deform an object."""
        return any(
            is_animated(item) or item.is_active_body or item.has_modifier(_MOVING_MODIFIERS)
            for item in self.dependencies(name)
        )

    def dependencies(self, name: str) -> Iterator[ObjectFacts]:
        """An object and all that it follows: parents, targets of constraints and modifiers, and theirs."""
        stack, seen = [name], set[str]()
        while stack:
            item = self.objects.get(stack.pop())
            if item is None or item.name in seen:
                continue
            seen.add(item.name)
            yield item
            links = [link.target for link in (*item.constraints, *item.modifiers) if link.on and link.target]
            stack += [*links, *((item.parent,) if item.parent else ())]

    @cached_property
    def _untagged_children(self) -> dict[str, list[str]]:
        """Collection → the untagged collections in it."""
        children: dict[str, list[str]] = defaultdict(list)
        for collection in self.facts.collections:
            for parent in collection.parents if collection.role is None else ():
                children[parent].append(collection.name)
        return children

    def _logical_object(self, collection: CollectionFacts) -> LogicalObject:
        below = reachable([collection.name], lambda name: self._untagged_children.get(name, ()))
        names = dict.fromkeys(name for part in below for name in self.collections[part].objects)
        items = [self.objects[name] for name in names if name in self.objects]
        return LogicalObject(
            collection,
            tuple(item for item in items if is_mesh(item)),
            tuple(item for item in items if item.is_root),
            tuple(item for item in items if not is_mesh(item) and not item.is_root),
        )


def is_mesh(item: ObjectFacts) -> bool:
    """Whether an object has geometry of its own: it is a mesh, renders as one, or makes instances of one."""
    return item.surface or item.type in _GEOMETRY


def is_animated(item: ObjectFacts) -> bool:
    """Whether keyframes, drivers, shape keys or a recorded motion move an object."""
    return bool(
        item.keys
        or item.drivers
        or item.animated_shape_keys
        or any(constraint.on and constraint.type in _MOVING_CONSTRAINTS for constraint in item.constraints)
    )


def _is_part(mesh: str, owner: str, part: str) -> bool:
    """Whether a mesh of ``owner`` is named as its ``part``, with the owner's name before it or a number behind it."""
    plain = NUMBER.sub("", mesh).casefold()
    return plain == part.casefold() or bool(
        re.fullmatch(rf"{re.escape(owner.casefold())}[ _./-]{re.escape(part.casefold())}", plain)
    )
